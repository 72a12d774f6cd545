"""From everything that `wsgen check` finds to what it reports: allowed, selected, new.

What a baseline has was there before and stays silent until it is gone. Lines are not compared, so
that other changes of a file do not make old diagnostics new.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.catalogue import (
    FAMILIES,
    all_rules,
    find_rule,
    suppress,
    unknown_rule_allowed,
    without_allowed,
)
from wsgen.checks.rules.consequences import fold_not_installed
from wsgen.diagnostics import has_errors, worst_of_each
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.packages.workspace.settings import find_comments, read_comments, read_settings
from wsgen.text.files import read_regular_text, real_path
from wsgen.text.suggestions import ask_for_nearest
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.settings import Allowance, Settings
    from wsgen.pipeline.check import CheckOutcome

    Key = tuple[str, str, str, str]


VERSION = 1
SIZE_LIMIT = 2**26  # bytes
LINES = lazy_pattern(r"\b(lines?) \d+")
FIELDS = ("code", "file", "element", "message")


def render_baseline(diagnostics: Iterable[Diagnostic], folder: Path) -> str:
    """The text of a baseline that is written into a folder."""
    counted = Counter(_key(found, folder) for found in diagnostics)
    document = {
        "version": VERSION,
        "diagnostics": [
            {**dict(zip(FIELDS, key, strict=True)), "count": counted[key]}
            for key in sorted(counted)
        ],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def load_baseline(file: Path) -> Counter[Key]:
    """Read the baseline in a file.

    Raises:
        NotFoundError: it does not exist.
        NotReadableError: it cannot be read.
        RequestError: it is no baseline.
    """
    try:
        text = read_regular_text(file, SIZE_LIMIT)
    except FileNotFoundError as error:
        raise NotFoundError(
            f"The baseline {file} does not exist.",
            hint=f"Write it first: wsgen check --write-baseline {file}",
        ) from error
    except OSError as error:
        raise NotReadableError(
            f"The baseline {file} cannot be read: {error.strerror}.", hint="Give another file."
        ) from error
    return read_baseline(text, file)


def read_baseline(text: str, file: Path) -> Counter[Key]:
    """How often each diagnostic was there.

    Raises:
        RequestError: The text is no baseline.
    """
    try:
        document = json.loads(text)
        counted: Counter[Key] = Counter()
        for one in {VERSION: document["diagnostics"]}[document["version"]]:
            code, name, element, message = (str(one[field]) for field in FIELDS)
            counted[code, name, element, message] += int(one["count"])
    except (ValueError, KeyError, TypeError) as error:
        raise RequestError(
            f"{file} is not a baseline of this version of wsgen.",
            hint=f"Write it again: wsgen check --write-baseline {file}",
        ) from error
    return counted


def divide_known(
    diagnostics: Iterable[Diagnostic], baseline: Counter[Key], folder: Path
) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """Those that are new, and those that are in the baseline of a folder."""
    left = Counter(baseline)
    new, known = [], []
    for found in diagnostics:
        key = _key(found, folder)
        if left[key] > 0:
            left[key] -= 1
            known.append(found)
        else:
            new.append(found)
    return tuple(new), tuple(known)


def without_lines(message: str) -> str:
    """A message without the lines that it names: other changes of the file move them."""
    return LINES.sub(r"\1 0", message)


def _key(found: Diagnostic, folder: Path) -> Key:
    base = os.path.realpath(folder)
    file = os.path.relpath(os.path.realpath(found.file), base) if found.file else ""
    # Messages may have paths, which differ from machine to machine.
    message = without_lines(found.message)
    message = message.replace(f"{base}{os.sep}", "").replace(f"{folder}{os.sep}", "")
    # A file cannot have the halves of characters that stand for other bytes of a name.
    name, element, message = (
        text.encode(errors="replace").decode()
        for text in (file.replace(os.sep, "/"), found.element or "", message)
    )
    return found.code, name, element, message


SECONDS = 60  # that git may take


def changed_since(reference: str, folder: Path) -> frozenset[Path]:
    """The files of the repository around a folder that differ from a commit, new ones included.

    Deleted files are among them.

    Raises:
        NotFoundError: git is not installed.
        RequestError: the folder is in no repository, or has no such commit.
    """
    program = shutil.which("git")
    if program is None:
        raise NotFoundError(
            "`--changed-since` needs git, which is not installed.",
            hint="Install git, or omit the option.",
        )
    top = run_git(program, folder, "rev-parse", "--show-toplevel")
    if top is None:
        raise RequestError(
            f"{folder} is not in a git repository: the changed files are not known.",
            hint="Omit `--changed-since`, or run the command in a git repository.",
        )
    root = Path(top.strip("\n"))
    commit = run_git(program, root, "rev-parse", "--verify", "--quiet", f"{reference}^{{commit}}")
    if reference.startswith("-") or commit is None:
        raise RequestError(
            f"The repository does not have the commit {reference!r}.",
            hint="Give a commit, branch or tag, for example: --changed-since origin/main "
            "(a shallow clone in CI lacks it: fetch-depth: 0).",
        )
    changed = run_git(
        program, root, "diff", "--name-only", "--no-renames", "-z", commit.strip(), "--"
    )
    new = run_git(program, root, "ls-files", "--others", "--exclude-standard", "-z")
    names = f"{changed or ''}{new or ''}".split("\0")
    return frozenset(root / name for name in names if name)


def run_git(program: str, folder: Path, *words: str) -> str | None:
    """The output of a git command in a folder; None where it fails."""
    try:
        run = subprocess.run(
            [program, "-C", folder, *words],
            capture_output=True,
            text=True,
            errors="surrogateescape",
            timeout=SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return run.stdout if run.returncode == 0 else None


def about_changes(
    diagnostics: Iterable[Diagnostic], changed: Iterable[Path], packages: Iterable[Path]
) -> tuple[Diagnostic, ...]:
    """What is reported about changed files, and each error in a package that has one.

    A change breaks other files of its package too: an `install()` of a file that was renamed.
    """
    files = {_real(file) for file in changed}
    touched = [
        real for real in map(_real, packages) if any(file.is_relative_to(real) for file in files)
    ]
    return tuple(
        found
        for found in diagnostics
        if found.file is not None
        and (
            (file := _real(found.file)) in files
            or (
                found.severity.value == "error"
                and any(file.is_relative_to(folder) for folder in touched)
            )
        )
    )


def _real(path: Path) -> Path:
    return path.parent.resolve() / path.name


ALL = "ALL"  # every family


@dataclass(frozen=True, kw_only=True)
class Reported:
    """What is reported, and how much is not."""

    diagnostics: tuple[Diagnostic, ...]
    allowed: tuple[Diagnostic, ...] = ()  # by the packages, with a reason
    known: tuple[Diagnostic, ...] = ()  # from the baseline

    @property
    def passed(self) -> bool:
        """Whether no error is reported."""
        return not has_errors(self.diagnostics)


class Permissions(NamedTuple):
    """What a package allows itself."""

    settings: Settings
    comments: tuple[Allowance, ...]  # of all its files


def read_permissions(folder: Path) -> Permissions:
    """What the package in a folder allows."""
    settings, _ = read_settings(folder)
    return Permissions(settings, tuple(find_comments(folder)))


@dataclass(frozen=True, kw_only=True)
class Filters:
    """What is left out of everything that is found."""

    select: Sequence[str] = ()  # names, codes and families of rules; none: all
    ignore: Sequence[str] = ()
    baseline: Path | None = None  # a file with what was there before
    changed_since: str | None = None  # a commit

    def check(self) -> None:
        """Refuse what cannot be used, before anything is read.

        Raises:
            NotFoundError: the file of the baseline does not exist.
            RequestError: it is no baseline, or no rule has a name.
        """
        find_codes((*self.select, *self.ignore))
        if self.baseline is not None:
            load_baseline(self.baseline)


def filter_outcome(outcome: CheckOutcome, filters: Filters) -> Reported:
    """What is reported of everything that was found.

    Raises:
        NotFoundError: git is not installed.
        RequestError: there is no such commit.
    """
    folders = tuple(outcome.folders.values())
    found, allowed = leave_out_allowed(
        outcome.diagnostics,
        {folder: outcome.permissions.get(folder) for folder in folders},
        outcome.files,
        only=outcome.only,
    )
    found = choose(found, select=filters.select, ignore=filters.ignore)
    found = fold_not_installed(worst_of_each(found), outcome.folders)  # into what is reported
    known: tuple[Diagnostic, ...] = ()
    if filters.baseline is not None:
        file = filters.baseline.absolute()
        found, known = divide_known(found, load_baseline(file), file.parent)
    if filters.changed_since is not None:
        places = {*folders, *(file.parent for file in outcome.files)}
        changed = [changed_since(filters.changed_since, place) for place in sorted(places)]
        found = about_changes(found, frozenset().union(*changed), folders)
    return Reported(diagnostics=found, allowed=allowed, known=known)


def leave_out_allowed(
    diagnostics: Iterable[Diagnostic],
    packages: Mapping[Path, Permissions | None],
    files: Sequence[Path],
    *,
    only: Collection[Path] = (),
) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """Divide diagnostics into those that count and those that packages and files allow.

    Args:
        diagnostics: of all files
        packages: the folders of the packages that were checked, and what these allow; None where
            that is not known yet
        files: that were checked and belong to no package
        only: the files and folders of packages that were asked for; none: all of them

    Returns:
        Those that count, with those about the allowances themselves; and the allowed ones.
    """
    allowances: list[Allowance] = [one for file in files for one in read_comments(file)]
    allowed_in: dict[Path, frozenset[str]] = {}
    kept = list(diagnostics)
    for folder, known in packages.items():
        settings, comments = known or read_permissions(folder)
        allowances += [*settings.allowances, *comments]
        if settings.allow:
            allowed_in[Path(real_path(folder))] = frozenset(settings.allow)
            kept += unknown_rule_allowed(settings.allow, settings.file, settings.allow_line)
    silent: list[Diagnostic] = []
    counted: dict[Diagnostic, None] = {}
    for found in kept:
        if allowed_in and _is_allowed(found, allowed_in):
            silent.append(found)
        else:
            counted[found] = None
    if not allowances:
        return tuple(counted), tuple(silent)
    suppressed = suppress(counted, allowances, read=[*only, *files] if only else None)
    return suppressed.reported, (*silent, *suppressed.allowed)


def _is_allowed(found: Diagnostic, allowed_in: Mapping[Path, frozenset[str]]) -> bool:
    """Whether the settings of its package allow it in `wsgen validate`; never an error."""
    return found.file is not None and any(
        not without_allowed([found], allowed_in[folder])
        for folder in Path(real_path(found.file)).parents
        if folder in allowed_in
    )


def find_codes(names: Iterable[str]) -> frozenset[str]:
    """The codes, and beginnings of codes, that rules and families are named by.

    Raises:
        RequestError: A name is neither a code nor a name nor a family.
    """
    codes = set()
    for name in (word.strip() for words in names for word in words.split(",")):
        if name.upper() in FAMILIES:
            codes.add(name.upper())
        elif name.upper() == ALL:
            codes |= FAMILIES.keys()
        elif name:
            rule = find_rule(name)
            if rule is None:
                known = [word for one in all_rules() for word in (one.code, one.name)]
                raise RequestError(
                    f"The rule or family {name!r} does not exist.",
                    hint=f"{ask_for_nearest(name, [*known, *FAMILIES])}"
                    "`wsgen rule` lists all rules; families are " + ", ".join(FAMILIES) + ".",
                )
            codes.add(rule.code)
    return frozenset(codes)


def choose(
    diagnostics: Iterable[Diagnostic], *, select: Sequence[str] = (), ignore: Sequence[str] = ()
) -> tuple[Diagnostic, ...]:
    """The diagnostics of selected rules, without the ignored ones.

    Raises:
        RequestError: A name is neither a code nor a name nor a family.
    """
    wanted, unwanted = tuple(find_codes(select)), tuple(find_codes(ignore))
    return tuple(
        found
        for found in diagnostics
        if (not wanted or found.code.startswith(wanted)) and not found.code.startswith(unwanted)
    )

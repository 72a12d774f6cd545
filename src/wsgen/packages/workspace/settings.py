"""Read the settings of a package, its `wsgen.toml`, and what comments in its files allow.

    <link name="tip"/>  <!-- wsgen: allow no-visual: a frame for the gripper -->
    # wsgen: allow unused-launch-argument, LCH034: read by a launch file of the customer

A comment alone on its line is about the line below it.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.text import tomlfile
from wsgen.text.files import read_regular, remembered
from wsgen.text.suggestions import suggest
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior
    from wsgen.packages.workspace.sweep_settings import SweepSettings


INVALID_SETTINGS = Rule(
    code="PKG060",
    name="invalid-settings",
    severity=Severity.ERROR,
    severity_varies="a warning for a mistake in `[validate]` or `[check]`",
    summary="`wsgen.toml` is not TOML, or a key or value in it is invalid.",
    why="`wsgen` ignores an entry that it cannot use: a rule is not allowed, or a behavior is not "
    "checked.",
    example="""[[behavior]]
name = "drives straight"
drive = { linear = "fast" }
seconds = 2.0
moved = { x = 1.0 }""",
    instead="""[[behavior]]
name = "drives straight"
drive = { linear = 0.5 }
seconds = 2.0
moved = { x = 1.0 }""",
)

FILE = "wsgen.toml"
ALLOW = ("validate", "allow")
ALLOW_IN_CHECK = ("check", "allow")
# What `wsgen new` records, and what a user may set.
TARGET_KEYS = ("distro", "simulator")
MOST_UNKNOWN = 20  # keys that are reported
KNOWN_KEYS = (
    "schema",
    "wsgen",
    "template",
    "state",
    "folder",
    "commit",
    "target",
    "package",
    "answers",
    "validate",
    "check",
    "behavior",
    "sweep",
)


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The part of the file that a user sets, and the distribution that `wsgen new` recorded."""

    file: Path
    allow: tuple[str, ...] = ()  # names of rules that the package breaks on purpose
    allow_line: int | None = None  # of `allow`, 1-based
    allowances: tuple[Allowance, ...] = ()  # of [check.allow], with reasons
    behaviors: tuple[Behavior, ...] = ()  # what its robot must do beyond standing
    distro: str | None = None  # target of the package, as `wsgen new` recorded it
    sweep: SweepSettings | None = None  # what `wsgen sweep` varies; None: the file does not say


def read_settings(package: Path) -> tuple[Settings, tuple[Diagnostic, ...]]:
    """Read the settings of the package in a folder; the defaults where it has none."""
    return remembered(_read_settings, package, package / FILE)


def _read_settings(package: Path) -> tuple[Settings, tuple[Diagnostic, ...]]:
    file = package / FILE
    try:
        document = tomlfile.load(file)
    except FileNotFoundError:
        return Settings(file=file), ()
    except OSError as error:
        return Settings(file=file), (
            INVALID_SETTINGS.at(
                file,
                message=f"{FILE} cannot be read: {error.strerror}.",
                hint="Check that it is a file of at most 1 MB that you may read (ls -l).",
            ),
        )
    except ValueError as error:
        at = re.search(r"at line (\d+)", str(error))
        return Settings(file=file), (
            INVALID_SETTINGS.at(
                file,
                int(at[1]) if at else None,
                message=f"{FILE} is not TOML: {error}. All of it is ignored: no behavior is "
                "checked, and no rule is allowed.",
                hint=_explain(file, error) or "Fix it, or remove the file.",
            ),
        )
    text = file.read_text(encoding="utf-8")
    behaviors, found = _read_behaviors(document, file, text)
    sweep, of_sweep = _read_sweep(document, file, text)
    settings = Settings(
        file=file,
        allow_line=tomlfile.find_line(text, ALLOW),
        behaviors=behaviors,
        distro=_distro(document),
        sweep=sweep,
    )
    allowances, of_check = _read_allowances(document, file, text)
    settings = replace(settings, allowances=allowances)
    found = (*_unknown_keys(document, file, text), *of_check, *of_sweep, *found)
    allow = _allow(document)
    if allow is None:
        return settings, (
            *found,
            INVALID_SETTINGS.at(
                file,
                settings.allow_line,
                message="`allow` in [validate] is not a list of names.",
                hint='Write for example: allow = ["massless-root"]',
                severity=Severity.WARNING,
            ),
        )
    return replace(settings, allow=allow), (
        *found,
        *(
            INVALID_SETTINGS.at(
                file,
                tomlfile.find_line(text, ("validate", key)),
                message=f"[validate] has no key `{key}`.",
                hint="Remove it: the only key is `allow`.",
                severity=Severity.WARNING,
            )
            for key in sorted(set(document.get("validate", {})) - {"allow"})
        ),
    )


def _explain(file: Path, error: ValueError) -> str | None:
    try:
        return tomlfile.explain(file.read_text(encoding="utf-8"), error)
    except (OSError, ValueError):  # it is not UTF-8
        return None


def _read_allowances(
    document: dict[str, Any], file: Path, text: str
) -> tuple[tuple[Allowance, ...], tuple[Diagnostic, ...]]:
    """The rules in [check.allow], each with its reason, and for all or some files."""
    section = document.get("check", {})
    allow = section.get("allow", {}) if isinstance(section, dict) else None
    found = [
        INVALID_SETTINGS.at(
            file,
            tomlfile.find_line(text, ("check", key)),
            message=f"[check] has no key `{key}`.",
            hint="Remove it: the only key is `allow`.",
            severity=Severity.WARNING,
        )
        for key in sorted(set(section if isinstance(section, dict) else ()) - {"allow"})
    ]
    if not isinstance(allow, dict):
        how = "[check.allow] is not a table of rules and reasons."
        found.append(_invalid_allowance(file, tomlfile.find_line(text, ALLOW_IN_CHECK), how))
        allow = {}
    allowances = []
    for name, value in allow.items():
        line = tomlfile.find_line(text, (*ALLOW_IN_CHECK, name))
        reason = find_reason(value)
        files = value.get("files", []) if isinstance(value, dict) else []
        if reason is None or not isinstance(files, list) or not all(map(_is_text, files)):
            how = f"The value of `{name}` in [check.allow] is not a reason."
            found.append(_invalid_allowance(file, line, how))
            continue
        allowances.append(
            Allowance(rule=name, reason=reason, file=file, line=line, patterns=tuple(files))
        )
    return tuple(allowances), tuple(found)


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _invalid_allowance(file: Path, line: int | None, message: str) -> Diagnostic:
    return INVALID_SETTINGS.at(
        file,
        line,
        message=message,
        hint='Write for example: no-visual = "the sensors are drawn by another node", or '
        'no-visual = { reason = "…", files = ["urdf/sensors.xacro"] }.',
        severity=Severity.WARNING,
    )


def _distro(document: dict[str, Any]) -> str | None:
    target = document.get("target")
    distro = target.get("distro") if isinstance(target, dict) else None
    return distro if isinstance(distro, str) else None


def _read_behaviors(
    document: dict[str, Any], file: Path, text: str
) -> tuple[tuple[Behavior, ...], tuple[Diagnostic, ...]]:
    if "behavior" not in document:
        return (), ()
    from wsgen.packages.workspace.behavior_settings import read_behaviors  # noqa: PLC0415  most packages have none

    return read_behaviors(document, file, text, INVALID_SETTINGS)


def _read_sweep(
    document: dict[str, Any], file: Path, text: str
) -> tuple[SweepSettings | None, tuple[Diagnostic, ...]]:
    if "sweep" not in document:
        return None, ()
    from wsgen.packages.workspace.sweep_settings import read_sweep  # noqa: PLC0415  as behaviors

    return read_sweep(document, file, text, INVALID_SETTINGS)


def _place_of(key: str) -> str | None:
    """The only table that has a key which stands above all tables."""
    from wsgen.packages.workspace.behavior_settings import KEYS  # noqa: PLC0415  only for a mistake

    if key in TARGET_KEYS:
        return "[target]"
    return "[[behavior]]" if key in KEYS and key != "name" else None  # packages have names, too


def _unknown_keys(document: dict[str, Any], file: Path, text: str) -> Iterator[Diagnostic]:
    """Report keys that nothing reads: wsgen would never run a misspelled behavior."""
    for key in [one for one in document if one not in KNOWN_KEYS][:MOST_UNKNOWN]:
        place = _place_of(key)
        yield INVALID_SETTINGS.at(
            file,
            tomlfile.find_line(text, (key,)),
            message=f"{FILE} has no key `{key}`.",
            hint=f"Write it below a line `{place}`."
            if place is not None
            else suggest(key.lower(), KNOWN_KEYS),
        )


def _allow(document: dict[str, Any]) -> tuple[str, ...] | None:
    section = document.get("validate", {})
    names = section.get("allow", []) if isinstance(section, dict) else None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return None
    return tuple(names)


SIZE_LIMIT = 2**20  # bytes; files in which people write comments are smaller
SUFFIXES = (
    *(".py", ".xml", ".yaml", ".yml", ".launch", ".urdf", ".xacro", ".gazebo", ".srdf"),
    *(".sdf", ".world", ".txt", ".cmake", ".cfg", ".toml", ".rviz"),
)
MARK = b"wsgen:"
COMMENT = lazy_pattern(
    r"(?:#|<!--)[ \t]*wsgen:[ \t]*allow[ \t]+(?P<rules>[\w-]+(?:[ \t]*,[ \t]*[\w-]+)*)"
    r"[ \t]*(?::[ \t]*(?P<reason>(?:(?!-->)[^\n])*))?",
)


@dataclass(frozen=True, kw_only=True)
class Allowance:
    """A rule that may be broken, with the reason."""

    rule: str  # name or code, as it is written
    reason: str  # empty: none is given
    file: Path  # where it is written
    line: int | None = None  # 1-based
    patterns: tuple[str, ...] = ()  # of the files in the package that it holds for; none: all
    lines: tuple[int, int] | None = None  # of `file`, first and last; None: it is no comment


def find_reason(value: Any) -> str | None:
    """The reason that a value of [check.allow] gives; None if it is neither a text nor a table."""
    if isinstance(value, dict):
        value = value.get("reason", "") if value.keys() <= {"reason", "files"} else None
    return value.strip() if isinstance(value, str) else None


def find_comments(folder: Path) -> Iterator[Allowance]:
    """The comments in all files of a package."""
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(one for one in folders if not one.startswith("."))
        for name in sorted(files):
            if name.endswith(SUFFIXES):
                yield from read_comments(Path(place, name))


def read_comments(file: Path) -> tuple[Allowance, ...]:
    """The comments of a file that allow something; none if it cannot be read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
    except (OSError, ValueError):
        return ()
    if MARK not in data or len(data) > SIZE_LIMIT:
        return ()
    return tuple(comments_in(data.decode("utf-8", "replace"), file))


def comments_in(text: str, file: Path) -> Iterable[Allowance]:
    """The comments of a text that allow something."""
    for found in COMMENT.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        for rule in found["rules"].split(","):
            yield Allowance(
                rule=rule.strip(),
                reason=(found["reason"] or "").strip(),
                file=file,
                line=line,
                lines=_lines_of(text, found, line),
            )


def _lines_of(text: str, comment: re.Match[str], line: int) -> tuple[int, int]:
    """The lines that a comment is about: a tag of XML has all of its lines."""
    begin = text.rfind("\n", 0, comment.start()) + 1
    before = text[begin : comment.start()].rstrip()
    if before:
        tag = text.rfind("<", 0, begin + len(before)) if before.endswith(">") else -1
        first = text.count("\n", 0, tag) + 1 if tag >= 0 else line
        return first, line
    stop = text.find("\n", comment.end())
    after = text[comment.end() : stop if stop >= 0 else len(text)].partition("-->")[2]
    if after.strip():
        return line, line
    rest = text[stop + 1 :] if stop >= 0 else ""
    following = re.match(r"(?:[ \t]*(?:#|<!--)[ \t]*wsgen:[^\n]*\n|[ \t\r]*\n)*", rest)
    skipped = following[0].count("\n") if following else 0
    rest = rest[following.end() :] if following else rest
    tag_lines = 0
    if rest.lstrip().startswith("<") and not rest.lstrip().startswith("<!--"):
        tag_lines = rest[: max(rest.find(">"), 0)].count("\n")
    first = line + 1 + skipped
    return first, first + tag_lines

"""The files that changed since a commit, as git lists them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, RequestError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.diagnostics import Diagnostic


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
    top = _run(program, folder, "rev-parse", "--show-toplevel")
    if top is None:
        raise RequestError(
            f"{folder} is not in a git repository: the changed files are not known.",
            hint="Omit `--changed-since`, or run the command in a git repository.",
        )
    root = Path(top.strip("\n"))
    commit = _run(program, root, "rev-parse", "--verify", "--quiet", f"{reference}^{{commit}}")
    if reference.startswith("-") or commit is None:
        raise RequestError(
            f"The repository does not have the commit {reference!r}.",
            hint="Give a commit, branch or tag, for example: --changed-since origin/main "
            "(a shallow clone in CI lacks it: fetch-depth: 0).",
        )
    changed = _run(program, root, "diff", "--name-only", "--no-renames", "-z", commit.strip(), "--")
    new = _run(program, root, "ls-files", "--others", "--exclude-standard", "-z")
    names = f"{changed or ''}{new or ''}".split("\0")
    return frozenset(root / name for name in names if name)


def _run(program: str, folder: Path, *words: str) -> str | None:
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

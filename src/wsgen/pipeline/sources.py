"""The source of an installed package: what a person edits, and what was not built since."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

NAMED = 5  # so many files are told in a message


def name_sources(
    diagnostics: Iterable[Diagnostic], share: Path, source: Path
) -> Iterator[Diagnostic]:
    """Name the file that a person edits instead of its installed copy, where the two are equal.

    A change of the copy would be lost in the next build.
    """
    for found in diagnostics:
        origin = None if found.file is None else _origin(found.file, share, source)
        if origin is not None and found.file is not None and _same(origin, found.file):
            yield replace(found, file=origin)
        else:
            yield found


def changed_since_build(share: Path, source: Path) -> Iterator[Diagnostic]:
    """Files of the source differ from what is installed.

    ## What it does
    Compares the installed files with those of the same name in the package's source.

    ## Why is this bad?
    `ros2 launch` and this trial read the installed files: the change has no effect yet.

    ## Use instead
    A build after every change, or one with --symlink-install.
    """
    changed = [
        origin.relative_to(source).as_posix()
        for file in sorted(share.rglob("*"))
        if (origin := _origin(file, share, source)) is not None and not _same(origin, file)
    ]
    if changed:
        others = f" and {len(changed) - NAMED} more" if len(changed) > NAMED else ""
        yield Diagnostic(
            code="PKG052",
            severity=Severity.WARNING,
            message=f"Changed since the last build: {', '.join(changed[:NAMED])}{others}. "
            "What is judged are the installed files.",
            file=source / changed[0],
            hint="Run `wsgen build`, then validate again.",
        )


def _origin(file: Path, share: Path, source: Path) -> Path | None:
    if not file.is_relative_to(share):
        return None
    origin = source / file.relative_to(share)
    return origin if origin.is_file() and file.is_file() else None


def _same(first: Path, second: Path) -> bool:
    try:
        one, other = first.stat(), second.stat()
        if one.st_size != other.st_size:
            return False
        # CMake gives the installed file the time of the other.
        return one.st_mtime_ns == other.st_mtime_ns or first.read_bytes() == second.read_bytes()
    except OSError:
        return False

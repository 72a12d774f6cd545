"""The source files of what is installed."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.packages.workspace.layout import BUILD_MARKERS
from wsgen.pipeline.changed_since_build import is_copy
from wsgen.text.files import list_files

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


def name_sources(
    diagnostics: Iterable[Diagnostic], sources: Mapping[Path, Path]
) -> Iterator[Diagnostic]:
    """Name the source file instead of its installed copy, where the two are equal.

    A change of the copy would be lost in the next build. `sources` are those of share folders.
    """
    for found in diagnostics:
        file = found.file
        yield found if file is None else replace(found, file=source_of(file, sources))


def source_of(file: Path, sources: Mapping[Path, Path]) -> Path:
    """The source of an installed file, or the file itself; see `name_sources`."""
    origins = (_origin_of(file, *one) for one in sources.items())
    return next((one for one in origins if one is not None), file)


def _origin(file: Path, share: Path, source: Path) -> Path | None:
    if not file.is_relative_to(share):
        return None
    origin = source / file.relative_to(share)
    return origin if origin.is_file() and file.is_file() else None


def _origin_of(file: Path, share: Path, source: Path) -> Path | None:
    """The source that equals an installed file: at its path, or the only one of its name."""
    if not file.is_relative_to(share) or share == source:
        return None
    at_its_path = _origin(file, share, source)
    if at_its_path is not None:
        return at_its_path if is_copy(at_its_path, file) else None
    named = [
        one
        for one in list_files(source, (os.path.normcase(file.name),), markers=BUILD_MARKERS)
        if one.name == file.name and file.is_file() and is_copy(one, file)
    ]
    return named[0] if len(named) == 1 else None

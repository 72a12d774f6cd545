"""The source of what has ended a Python node: its traceback names the installed file."""

from __future__ import annotations

import re
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.pipeline.changed_since_build import InstalledSource

# Of a traceback, and of a syntax error, whose line has no function.
FRAME = re.compile(rb'^  File "([^"\r\n]+)", line (\d{1,9})\b', re.MULTILINE)
MARK = b'  File "'  # which is in few outputs
MOST_FRAMES = 50  # that are kept, of the last tracebacks

Frame = tuple[Path, int]  # a file as it is executed, and a line


class Frames:
    """The frames of the last tracebacks that a process has printed, the innermost one last."""

    def __init__(self) -> None:
        self._frames: deque[Frame] = deque(maxlen=MOST_FRAMES)

    def take(self, printed: bytes) -> None:
        """Take whole lines that the process has printed."""
        if MARK in printed:
            self._frames.extend(
                (Path(file.decode(errors="replace")), int(line))
                for file, line in FRAME.findall(printed)
            )

    def innermost_first(self) -> Iterable[Frame]:
        """The frames, from where the exception was raised on."""
        return reversed(self._frames)


class SourceLine(NamedTuple):
    """Where the line of an installed file is to be corrected."""

    file: str  # the name of the installed one
    line: int
    source: Path  # as it is named from the current folder
    is_link: bool  # the installed one is a link to it
    is_same: bool  # it holds what is installed

    @property
    def place(self) -> str:
        """The line in the source; the source alone, where its lines are others by now."""
        return f"line {self.line} of {self.source}" if self.is_same else str(self.source)

    def told(self) -> str:
        """What to say of it to somebody who knows the line of the installed file."""
        if not self.is_same:
            return f"{self.file} is installed from {self.source}, which was changed after the build"
        build = "" if self.is_link else ", and run `wsgen build`"
        return f"line {self.line} of {self.file} is {self.place}: correct it there{build}"


def find_source(frames: Iterable[Frame], shares: Mapping[Path, Path]) -> SourceLine | None:
    """Find the line to be corrected that a traceback names, if it is in the workspace.

    Args:
        frames: The innermost one first.
        shares: Of the packages of the workspace: share folder -> source.
    """
    for file, line in dict.fromkeys(frames):
        found = _source(file, shares)
        if found is not None:
            source = _from_here(found.path)
            return SourceLine(file.name, line, source, found.is_link, found.is_same)
    return None


def tell_of_source(frames: Iterable[Frame], shares: Mapping[Path, Path]) -> str | None:
    """Say where the line is to be corrected that a traceback names; as `find_source` finds it."""
    found = find_source(frames, shares)
    return None if found is None else found.told()


def _source(file: Path, shares: Mapping[Path, Path]) -> InstalledSource | None:
    from wsgen.pipeline.changed_since_build import source_of  # noqa: PLC0415  few runs need it

    try:
        return source_of(file, shares)
    except (OSError, ValueError, RuntimeError):  # a program prints what it likes for a file
        return None


def _from_here(file: Path) -> Path:
    """A file as it is named from the current folder, if it is below that."""
    try:
        here = Path.cwd()
    except OSError:  # it was removed
        return file
    return file.relative_to(here) if file.is_relative_to(here) else file

"""What has ended a Python node: its traceback names the error, and the installed file."""

from __future__ import annotations

import re
import time
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.pipeline.changed_since_build import InstalledSource

# Of a traceback, and of a syntax error, whose line has no function.
FRAME = re.compile(rb'^  File "([^"\r\n]+)", line (\d{1,9})\b', re.MULTILINE)
MARK = b'  File "'  # which is in few outputs
HEADER = b"Traceback (most recent call last):"  # at the end of a line, also of one of a logger
CHAINED = (
    b"During handling of the above exception, another exception occurred:",
    b"The above exception was the direct cause of the following exception:",
)
MOST_FRAMES = 50  # that are kept, of the last traceback
MOST_LINES = 50  # that are kept, of what it says
# A program that has printed more after its traceback, or has run on for longer, has handled it.
# One that is ended by it may print some more: a message of several lines, what DDS says at its end.
MOST_LINES_AFTER = 10
MOST_SECONDS_AFTER = 10.0

Frame = tuple[Path, int]  # a file as it is executed, and a line


class LastTraceback:
    """The last traceback that a process has printed, if that may have ended it.

    Those of the exceptions that it was raised from belong to it.
    """

    def __init__(self) -> None:
        self._frames: deque[Frame] = deque(maxlen=MOST_FRAMES)
        self._lines: deque[bytes] = deque(maxlen=MOST_LINES)  # after frames and not indented
        self._is_chained = False  # the next traceback belongs to the last one
        self._lines_after = 0  # that have come since the last frame and are not indented
        self._time = 0.0  # of the last frame

    def take(self, printed: bytes) -> None:
        """Take whole lines that the process has printed."""
        if not self._frames and MARK not in printed:
            return
        for line in printed.splitlines():
            if line.startswith(MARK) and (found := FRAME.match(line)) is not None:
                if self._lines_after:  # a syntax error has no header
                    self._begin()
                self._time = time.monotonic()
                self._frames.append((Path(found[1].decode(errors="replace")), int(found[2])))
            elif line.endswith(HEADER):
                self._begin()
            elif line in CHAINED:
                self._is_chained = True
            elif line and not line.startswith(b" "):
                self._lines_after += 1
                self._lines.append(line)
                if self._lines_after > MOST_LINES_AFTER:
                    self._clear()

    def _begin(self) -> None:
        if not self._is_chained:
            self._clear()
        self._is_chained, self._lines_after = False, 0

    def _clear(self) -> None:
        self._frames.clear()
        self._lines.clear()

    def innermost_first(self) -> Iterable[Frame]:
        """The frames, from where the exception was raised on; asked when the process has ended."""
        return () if self._is_old() else reversed(self._frames)

    def said(self) -> bytes:
        """The lines that name its exceptions, and what came after them; likewise."""
        return b"" if self._is_old() else b"\n".join(self._lines)

    def _is_old(self) -> bool:
        return time.monotonic() - self._time > MOST_SECONDS_AFTER


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

    def reported(self) -> str:
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


def explain_source(frames: Iterable[Frame], shares: Mapping[Path, Path]) -> str | None:
    """Say where the line is to be corrected that a traceback names; as `find_source` finds it."""
    found = find_source(frames, shares)
    return None if found is None else found.reported()


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

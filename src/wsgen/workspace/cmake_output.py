"""The errors that CMake prints, as values."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_HEADING = re.compile(
    r"^CMake Error(?: at (?P<file>.+?):(?P<line>\d+)(?: \((?P<command>\w+)\))?)?:"
)
_FRAME = re.compile(r"^  (?P<file>\S.*):(?P<line>\d+) \(\w+\)$")


@dataclass(frozen=True, kw_only=True)
class CMakeError:
    """One error, with the calls that led to it."""

    message: str  # on one line
    command: str  # the command that failed; may be empty
    frames: tuple[tuple[str, int], ...]  # file and 1-based line, the innermost call first

    def locate(self, folder: Path) -> tuple[Path | None, int | None]:
        """Find the innermost call that lies in a file of the folder, which is CMake's source."""
        for name, line in self.frames:
            file = folder / name  # as it is where the name is absolute
            if file.is_relative_to(folder) and file.is_file():
                return file, line
        return None, None


def read_errors(text: str) -> tuple[CMakeError, ...]:
    """List the errors in what CMake wrote to standard error."""
    return tuple(_read_errors(text.splitlines()))


def _read_errors(lines: list[str]) -> Iterator[CMakeError]:
    for number, line in enumerate(lines):
        heading = _HEADING.match(line)
        if heading is None:
            continue
        frames = [(heading["file"], int(heading["line"]))] if heading["file"] else []
        words = [line[heading.end() :].strip()]
        for following in lines[number + 1 :]:
            if following and not following.startswith((" ", "Call Stack")):
                break
            frame = _FRAME.match(following)
            if frame is not None:
                frames.append((frame["file"], int(frame["line"])))
            elif not following.startswith("Call Stack"):
                words.append(following.strip())
        yield CMakeError(
            message=" ".join(" ".join(words).split()),
            command=heading["command"] or "",
            frames=tuple(frames),
        )

"""What CMake prints, as values: errors, and the versions that it deprecates."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_HEADING = re.compile(
    r"^CMake Error(?: at (?P<file>.+?):(?P<line>\d+)(?: \((?P<command>\w+)\))?)?:"
)
# As CMake 3.31 heads it, and as later ones do, whose last lines are not indented.
_DEPRECATION = re.compile(
    r"^CMake (?:Deprecation Warning|Warning \(deprecated\)) at (?P<file>.+?):(?P<line>\d+) "
    r"\(cmake_minimum_required\):$"
)
_DEPRECATION_TEXT = re.compile(
    r"^(?:  .*|This warning is for project developers\..*|to suppress it\.)?$"
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


def split_deprecations(
    lines: Sequence[str],
) -> tuple[tuple[str, ...], tuple[tuple[str, int], ...]]:
    """Take apart what CMake says about old versions in cmake_minimum_required().

    Returns:
        The other lines, and the file and 1-based line of each call, as CMake names them.
    """
    others: list[str] = []
    places: list[tuple[str, int]] = []
    is_inside = False
    for line in lines:
        heading = _DEPRECATION.match(line)
        is_inside = heading is not None or bool(is_inside and _DEPRECATION_TEXT.match(line))
        if heading is not None:
            places.append((heading["file"], int(heading["line"])))
        elif not is_inside:
            others.append(line)
    return tuple(others), tuple(places)

"""A package that failed to build, and what CMake printed about it, as values."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from wsgen.text.files import read_regular_text
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule


_HEADING = re.compile(
    r"^CMake Error(?: at (?P<file>.+?):(?P<line>\d+)(?: \((?P<command>\w+)\))?"
    r"|(?P<whole> in [^:]+))?:"
)
# As CMake 3.31 heads it, and as later ones do, whose last lines are not indented.
_DEPRECATION = re.compile(
    r"^CMake (?:Deprecation Warning|Warning \(deprecated\)) at (?P<file>.+?):(?P<line>\d+) "
    r"\(cmake_minimum_required\):$"
)
_DEPRECATION_TEXT = re.compile(
    r"^(?:  .*|This warning is for project developers\..*|to suppress it\.)?$"
)
_FRAME = re.compile(r"^  (?P<file>\S.*):(?P<line>\d+) \((?P<command>\w+)\)$")


@dataclass(frozen=True, kw_only=True)
class CMakeError:
    """One error, with the calls that led to it."""

    message: str  # on one line
    command: str  # the command that failed; may be empty
    # File, 1-based line and command of each call, the innermost first.
    frames: tuple[tuple[str, int, str], ...]
    names_file: bool  # with or without a line

    def locate(self, folder: Path) -> tuple[Path | None, int | None]:
        """Find the innermost call that lies in a file of the folder, which is CMake's source."""
        for name, line, command in self.frames:
            file = folder / name  # as it is where the name is absolute
            if file.is_relative_to(folder) and file.is_file() and _calls(file, line, command):
                return file, line
        return None, None


def _calls(file: Path, line: int, command: str) -> bool:
    """Whether a line has a call of the command: another project has a file of this name, too."""
    try:
        lines = read_regular_text(file, errors="replace").splitlines()
    except OSError:
        return False
    return not command or command.lower() in "".join(lines[line - 1 : line]).lower()


def read_errors(text: str) -> tuple[CMakeError, ...]:
    """List the errors in what CMake wrote to standard error."""
    return tuple(_read_errors(text.splitlines()))


def _read_errors(lines: list[str]) -> Iterator[CMakeError]:
    for number, line in enumerate(lines):
        heading = _HEADING.match(line)
        if heading is None:
            continue
        command = heading["command"] or ""
        frames = [(heading["file"], int(heading["line"]), command)] if heading["file"] else []
        words = [line[heading.end() :].strip()]
        for following in lines[number + 1 :]:
            if following and not following.startswith((" ", "Call Stack")):
                break
            frame = _FRAME.match(following)
            if frame is not None:
                frames.append((frame["file"], int(frame["line"]), frame["command"]))
            elif not following.startswith("Call Stack"):
                words.append(following.strip())
        yield CMakeError(
            message=" ".join(" ".join(words).split()),
            command=command,
            frames=tuple(frames),
            names_file=bool(heading["file"] or heading["whole"]),
        )


def fold_details(errors: Sequence[CMakeError]) -> tuple[CMakeError, ...]:
    """Keep of the errors around a failed command only that of the command, if there is one.

    The code of CMake that the command runs prints its own errors, which name no file. The first
    one before the error of the command says what is wrong, and is appended to it. The others
    follow from it.
    """
    if not any(error.frames for error in errors):
        return tuple(errors)
    folded: list[CMakeError] = []
    detail = ""
    for error in errors:
        if not error.names_file:
            detail = detail or error.message
            continue
        is_detailed = detail and error.frames
        folded.append(
            replace(error, message=f"{error.message} ({detail})") if is_detailed else error
        )
        detail = ""
    return tuple(folded)


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


LAST_LINES = 5  # of the output of a failure without a known cause


def last_words(output: str) -> str:
    """Put the end of an output on one line; of a traceback only its last line."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return " / ".join(
        lines[-1:] if "Traceback (most recent call" in output else lines[-LAST_LINES:]
    )


@dataclass(frozen=True)
class Failure:
    """A package that failed."""

    package: str
    folder: Path  # with package.xml and CMakeLists.txt or setup.py
    is_python: bool  # setuptools builds it, not CMake
    build_folder: Path  # with CMake's cache
    output: str  # what its programs wrote to standard error
    siblings: Collection[str]  # names of all packages of the workspace
    distro: str  # of the ROS that is sourced; empty without one
    log: Path | None  # the folder with everything that was printed
    failed: Collection[str] = ()  # names of those that it depends on and whose build failed

    @property
    def cmake_file(self) -> Path:
        """The CMakeLists.txt of the package."""
        return self.folder / "CMakeLists.txt"

    @property
    def setup_file(self) -> Path:
        """The setup.py of the package."""
        return self.folder / "setup.py"

    @cached_property
    def errors(self) -> tuple[CMakeError, ...]:
        """CMake's errors in the output."""
        return read_errors(self.output)

    def report(  # noqa: PLR0913  a rule, its words and its place
        self,
        rule: Rule,
        message: str,
        *,
        hint: str,
        error: CMakeError | None = None,
        file: Path | None = None,
        line: int | None = None,
    ) -> Diagnostic:
        """Report a rule at the error's call, at a line (of CMakeLists.txt), or for the package."""
        if line is not None and file is None:
            file = self.cmake_file
        if error is not None:
            file, line = error.locate(self.folder)
        return rule.at(
            file or self.folder, line, self.package, message=f"{self.package}: {message}", hint=hint
        )

    @property
    def clear_cache(self) -> str:
        """What to do where CMake's cache holds something wrong."""
        return f"Then remove {self.build_folder}, which holds CMake's cache, and build again."

    @property
    def where_to_look(self) -> str:
        """Where to find the whole output."""
        if self.log is None:
            return "Build again with --verbose to see the whole output."
        return f"The whole output is in {self.log / self.package / 'stdout_stderr.log'}"

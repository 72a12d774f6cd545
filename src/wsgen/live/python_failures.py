"""What has ended a Python program, or will, and what to do: modules that it lacks, its own lines.

A traceback names the error, and the installed file. What will end a program at once is read from
its file without running it: modules that are nowhere, and a file that is no Python.
"""

from __future__ import annotations

import ast
import importlib.util
import os
import re
import sys
import time
from collections import deque
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.imported_packages import misspelled_module
from wsgen.ros.environment.interfaces import buildable
from wsgen.ros.names import pypi_names, released_packages
from wsgen.text.files import read_whole
from wsgen.text.markup import read_text
from wsgen.text.pythontree import is_text, parse_anew
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.pipeline.changed_since_build import InstalledSource


# The last line of a traceback.
MISSING = re.compile(rb"^ModuleNotFoundError: No module named '([\w.]+)'", re.MULTILINE)
MARK = b"ModuleNotFoundError"  # which is in few outputs

# Likewise, of a name that a package of interfaces does not have; some versions of Python go on.
MISSING_NAME = re.compile(
    rb"^ImportError: cannot import name '(\w+)' from '(\w+)\.(msg|srv|action)' "
    rb"\(([^)\r\n]+)\)",
    re.MULTILINE,
)
NAME_MARK = b"ImportError: cannot import name"

# Errors of a NumPy that no longer does what the distributions of ROS have it do (NumPy 1.21 of
# Humble, 1.26 of Jazzy) -> the release that was the first to refuse it.
OF_NUMPY = {
    b"TypeError: only 0-dimensional arrays can be converted to Python scalars": "2.4",
    b"was removed in the NumPy 2.0 release": "2",
}

# Modules of Python that Linux distributions have in packages of their own.
OF_PYTHON = {"tkinter": "python3-tk", "curses": "libncurses-dev", "_tkinter": "python3-tk"}
# Packages of ROS 1 that nodes import.
OF_ROS_1 = frozenset(("actionlib", "dynamic_reconfigure", "roslib", "rospy", "tf"))


def missing_module(printed: bytes) -> str | None:
    """The module whose absence has ended a Python program, by the lines that it has printed."""
    found = MISSING.findall(printed) if MARK in printed else []
    return found[-1].decode() if found else None


def missing_name(printed: bytes) -> str | None:
    """What to say of a message, service or action that a Python program imports and nobody has."""
    found = MISSING_NAME.findall(printed) if NAME_MARK in printed else []
    if not found:
        return None
    name, package, kind, file = (part.decode(errors="replace") for part in found[-1])
    text = read_text(Path(file))
    if text is None:  # a program prints what it likes for a file
        return None
    meant = nearest(name, re.findall(r"^from \S+ import (\w+)", text, re.MULTILINE))
    question = f" {did_you_mean(f'{package}.{kind}.{meant}')}" if meant else ""
    return f"{package} has no {kind}/{name}.{question}"


def newer_numpy(printed: bytes) -> str | None:
    """The release of NumPy whose change has ended a Python program, by its last lines."""
    return next((release for words, release in OF_NUMPY.items() if words in printed), None)


def explain_numpy(release: str, python: Path | None) -> str:
    """Say that a node was written for an older NumPy, and what to do.

    Args:
        release: The first that refuses what the node does.
        python: The interpreter that has it; None: that which the program names itself.
    """
    return (
        f"NumPy {release} and later refuse what the node does, and that of ROS is older: correct "
        f"the line, or {python or 'python3'} -m pip install 'numpy<{release}'"
    )


def explain_module(
    module: str, python: Path | None, workspace: Collection[str], distro: str | None = None
) -> str:
    """Say that a module is missing, and what to do.

    Args:
        module: Its name; of one in a package with the names of that.
        python: The interpreter that lacks it; None: that which the program names itself.
        workspace: The names of its packages.
        distro: The ROS that is sourced; None: that of PyPI.
    """
    top = module.partition(".")[0]
    lacks = f"the Python module {module} is missing"
    if top not in workspace:
        if top in OF_PYTHON:
            return (
                f"{lacks}, a part of Python that this one was built without; for that of Debian "
                f"and Ubuntu: sudo apt install {OF_PYTHON[top]}"
            )
        if top in OF_ROS_1:
            return f"{lacks}: it is one of ROS 1; port the node to ROS 2"
        meant = None if top in pypi_names() else misspelled_module(top, workspace)
        if meant is not None:
            return f"{lacks}. {did_you_mean(meant)}"
    return f"{lacks}: {way_to_module(top, python, workspace, distro)}"


def way_to_module(
    top: str, python: Path | None, workspace: Collection[str], distro: str | None
) -> str:
    """What to do to have a module that is not in another one."""
    if top in workspace:
        return (
            f"{top} is a package of this workspace; let it install its modules, and run "
            "`wsgen build`"
        )
    if top not in pypi_names() and top in released_packages():
        return _way_to_package(top, distro)
    return f"{python or 'python3'} -m pip install {pypi_names().get(top, top)}"


def _way_to_package(name: str, distro: str | None) -> str:
    """What to do to have a package of ROS."""
    if distro is not None:
        return f"sudo apt install ros-{distro}-{name.replace('_', '-')}"
    if name in buildable():
        return (
            f"wsgen builds the messages of {name} where a package of the workspace names them; add "
            f"<exec_depend>{name}</exec_depend> to the package.xml of the node's package"
        )
    return (
        f"{name} is a package of ROS that PyPI does not have; put its sources into the workspace "
        "and run `wsgen build`, or source a ROS that has it"
    )


_ENTRY_POINTS = "lib/python*/site-packages/*/entry_points.txt"  # below a prefix


def lacking_modules(words: Sequence[str], variables: Mapping[str, str]) -> Iterator[str]:
    """The modules that a program imports at once, in its own file, and that are nowhere.

    The interpreter must be the one that asks. The imports at the top of the file count, up to the
    first statement of another kind: that may change where modules are looked for, or catch what
    they raise.

    Args:
        words: The command line of a Python program: the interpreter, the file, its arguments.
        variables: Its environment.
    """
    found = _first_file(words, variables)
    if found is None:
        return
    file, places = found
    for name in dict.fromkeys(_imported(file)):
        if name not in sys.stdlib_module_names and not _is_there(name, places):
            yield name


def syntax_error(words: Sequence[str], variables: Mapping[str, str]) -> tuple[Path, int] | None:
    """The file of a program that is no Python, and the line; None where it is.

    Args:
        words: As for `lacking_modules`.
        variables: Its environment.
    """
    found = _first_file(words, variables)
    if found is None:
        return None
    try:
        parse_anew(read_whole(found[0]))
    except SyntaxError as error:
        return found[0], error.lineno or 1
    except (OSError, ValueError, RecursionError, MemoryError):
        pass  # the program itself says it
    return None


def _first_file(
    words: Sequence[str], variables: Mapping[str, str]
) -> tuple[Path, list[str]] | None:
    """The file whose code a program executes first, and where it finds modules."""
    if len(words) < 2:  # noqa: PLR2004  the interpreter and the file
        return None
    script = Path(words[1])
    added = [one for one in variables.get("PYTHONPATH", "").split(os.pathsep) if one]
    places = [str(script.parent), *added, *sys.path]
    return _module_of(script, places) or script, places


def _is_there(name: str, places: Sequence[str]) -> bool:
    if PathFinder.find_spec(name, places) is not None:
        return True
    try:  # packages that are installed for editing have finders of their own
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return True  # nobody knows


def _module_of(script: Path, places: Sequence[str]) -> Path | None:
    """The file of the module that a console script of `lib/PACKAGE` starts."""
    line = re.compile(rf"^{re.escape(script.name)}\s*=\s*([\w.]+)\s*:", re.MULTILINE)
    for file in sorted(script.parents[2].glob(_ENTRY_POINTS)) if len(script.parents) > 2 else ():  # noqa: PLR2004  lib/PACKAGE
        found = line.search(read_text(file) or "")
        if found is not None:
            inside = Path(*found[1].split(".")).with_suffix(".py")
            return next((Path(one, inside) for one in places if Path(one, inside).is_file()), None)
    return None


def _imported(file: Path) -> Iterator[str]:
    """The outermost packages that a file imports before it does anything else."""
    try:
        tree = parse_anew(read_whole(file))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in tree.body:
        if isinstance(node, ast.Import):
            yield from (one.name.partition(".")[0] for one in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield node.module.partition(".")[0]
        elif not isinstance(node, ast.ImportFrom) and not is_text(node):
            return


# Of a traceback, and of a syntax error, whose line has no function.
FRAME = re.compile(rb'^  File "([^"\r\n]+)", line (\d{1,9})\b', re.MULTILINE)
TRACEBACK_MARK = b'  File "'  # which is in few outputs
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
        if not self._frames and TRACEBACK_MARK not in printed:
            return
        for line in printed.splitlines():
            if line.startswith(TRACEBACK_MARK) and (found := FRAME.match(line)) is not None:
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

"""Causes of a failed build of an ament_python package: setup.py, setup.cfg, and what they name."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from typing import TYPE_CHECKING

from wsgen.packages.build_files.cmake_checks import MISSING_BUILD_FILE, word_build_file
from wsgen.packages.build_files.python_checks import (
    MISSING_DATA_FILE,
    SETUP_FAILURE,
    word_data_file,
    word_module,
    word_package,
)
from wsgen.ros.names import released_packages
from wsgen.text.files import read_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from wsgen.building.failure import Failure
    from wsgen.diagnostics import Diagnostic


SECONDS_FOR_SETUP = 60.0  # wall-clock; colcon has just run the same file
# Names that setup.py uses and their import.
IMPORTS = {
    "find_packages": "from setuptools import find_packages",
    "glob": "from glob import glob",
    "os": "import os",
    "setup": "from setuptools import setup",
}
_FRAME = re.compile(r'^ +File "(.+?)", line (\d+)', re.MULTILINE)


def find_string(file: Path, *accepts: Callable[[str], bool]) -> int | None:
    """Find the 1-based line of a string in a Python file; None if it has none.

    It is the first one that the first condition accepts, or else the second one, and so on.
    """
    strings = sorted(
        (node.lineno, node.value)
        for node in _read_nodes(file)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    return next((line for accept in accepts for line, text in strings if accept(text)), None)


def find_keyword(file: Path, name: str) -> int | None:
    """Find the 1-based line of the first keyword argument of this name."""
    lines = [
        node.value.lineno
        for node in _read_nodes(file)
        if isinstance(node, ast.keyword) and node.arg == name
    ]
    return min(lines, default=None)


def _read_nodes(file: Path) -> Iterator[ast.AST]:
    try:
        tree = ast.parse(read_whole(file))
    except (OSError, SyntaxError, ValueError, RecursionError):
        return iter(())
    return ast.walk(tree)


def _missing_setup(failure: Failure) -> Iterator[Diagnostic]:
    if not failure.setup_file.exists():
        message, hint = word_build_file("ament_python", has_other=failure.cmake_file.exists())
        yield failure.report(MISSING_BUILD_FILE, message, hint=hint)


def _missing_data_file(failure: Failure) -> Iterator[Diagnostic]:
    absolute = re.search(r"'data_files' must be relative, '(.+?)' is absolute", failure.output)
    if absolute:
        yield failure.report(
            MISSING_DATA_FILE,
            f"data_files has the absolute path {absolute[1]}, which colcon refuses.",
            file=failure.setup_file,
            line=find_keyword(failure.setup_file, "data_files"),
            hint="Write paths relative to the folder of setup.py: glob('launch/*.launch.py')",
        )
    missing = re.search(
        r"^error: can't copy '(.+?)': doesn't exist or not a", failure.output, re.MULTILINE
    )
    if missing is None:
        return
    # With --symlink-install it is a link in the build folder.
    name = missing[1].removeprefix(f"{failure.build_folder}/")
    setup = failure.setup_file
    yield word_data_file(name, failure.folder, setup, _find_path(setup, name), failure.package)


def _find_path(setup: Path, name: str) -> int | None:
    """Find the string, pattern or beginning that yields the path."""
    from fnmatch import fnmatchcase  # noqa: PLC0415  only this error needs it

    folder = name.partition("/")[0]
    return find_string(
        setup,
        lambda text: text == name,
        lambda text: "*" in text and fnmatchcase(name, text.removeprefix("./")),
        lambda text: text.endswith("/") and name.startswith(text),
        lambda text: text == folder,
    ) or find_keyword(setup, "data_files")


def _missing_python_package(failure: Failure) -> Iterator[Diagnostic]:
    package = re.search(
        r"^error: package directory '(.+?)' does not exist", failure.output, re.MULTILINE
    )
    module = re.search(r"Provided py_modules '(.+?)' does not exist", failure.output)
    if package:
        name = package[1].removeprefix(f"{failure.build_folder}/")
        line = find_keyword(failure.setup_file, "packages")
        yield word_package(name, failure.folder, failure.setup_file, line, failure.package)
    elif module:
        line = find_keyword(failure.setup_file, "py_modules")
        yield word_module(module[1], failure.folder, failure.setup_file, line, failure.package)


def _setup_failure(failure: Failure) -> Iterator[Diagnostic]:
    # colcon runs it in processes of its own first, and keeps what they print.
    output = (
        failure.output if not re.search(r"colcon_\w+/", failure.output) else _run_setup(failure)
    )
    refused = re.search(r"(?m)^error in .+? setup command: (.+)", output)
    if refused:
        yield failure.report(
            SETUP_FAILURE,
            f"setuptools refuses an argument of setup(): {refused[1].rstrip('.')}.",
            file=failure.setup_file,
            line=find_keyword(failure.setup_file, refused[1].partition("'")[2].partition("'")[0]),
            hint="Fix the argument that the message names.",
        )
        return
    _, traceback, text = output.rpartition("Traceback (most recent call last):")
    raised = re.findall(r"^(?:\w+\.)*(\w+): (.*)$", text if traceback else output, re.MULTILINE)
    if not raised:
        return
    kind, what = raised[-1]
    if "configparser." in text:
        cfg = failure.folder / "setup.cfg"
        line = re.search(r"line:?\s+(\d+)\b", text[text.rindex("configparser.") :])
        yield failure.report(
            SETUP_FAILURE,
            f"setup.cfg cannot be read: {what}",
            file=cfg,
            line=int(line[1]) if line else None,
            hint="Write [section] or name=value; an indented line goes on with the value above.",
        )
        return
    places = [
        (failure.folder / name, int(line))
        for name, line in _FRAME.findall(output)
        if (failure.folder / name).is_relative_to(failure.folder)
    ]
    file, number = places[-1] if places else (failure.setup_file, None)
    yield failure.report(
        SETUP_FAILURE,
        f"{file.name} stops with {kind}: {what}",
        file=file,
        line=number,
        hint=_how_to_fix(kind, what),
    )


def _run_setup(failure: Failure) -> str:
    """Run setup.py as colcon does, and return what it writes to standard error."""
    try:
        return subprocess.run(
            [sys.executable, "-W", "ignore", "setup.py", "--version"],
            cwd=failure.folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
            timeout=SECONDS_FOR_SETUP,
        ).stderr
    except (OSError, subprocess.TimeoutExpired):
        return ""


def _how_to_fix(kind: str, what: str) -> str:
    name = what.partition("'")[2].partition("'")[0]
    if kind == "NameError" and name in IMPORTS:
        return f"Add at the top: {IMPORTS[name]}"
    if kind == "ModuleNotFoundError":
        top = name.partition(".")[0]
        if top in released_packages():
            return f"Source a ROS that has {top} (source /opt/ros/<distro>/setup.bash)."
        return f"Install it for the Python of wsgen: {sys.executable} -m pip install {top}"
    if kind.endswith(("SyntaxError", "IndentationError", "TabError")):
        return "Look there and in the line before for a missing comma, bracket or quotation mark."
    return "Fix the line, or what it reads."


PYTHON_CAUSES = (_missing_setup, _missing_data_file, _missing_python_package, _setup_failure)

"""Causes of a failed build of an ament_python package: setup.py, setup.cfg, and what they name."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from typing import TYPE_CHECKING

from wsgen.build.causes import MISSING_BUILD_FILE
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.ros_names import released_packages
from wsgen.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from wsgen.build.failure import Failure


SETUP_FAILURE = Rule(
    code="BLD040",
    name="setup-failure",
    severity=Severity.ERROR,
    summary="`setup.py` or `setup.cfg` of a Python package stops with an error.",
    what="Runs setup.py once more where `colcon` does not pass on what it printed.",
    why="`colcon` runs setup.py to learn what to install, and does not build the package.",
    example="""setup(
    name=package_name
    version='0.1.0',
)""",
    instead="""setup(
    name=package_name,
    version='0.1.0',
)""",
)
MISSING_DATA_FILE = Rule(
    code="BLD041",
    name="missing-data-file",
    severity=Severity.ERROR,
    summary="`data_files` in setup.py names a file that cannot be installed.",
    why="The build stops where a file does not exist or is a folder, which `glob('urdf/*')` also "
    "returns, and where its path is absolute. Git does not keep empty folders, but "
    "it keeps the empty file `resource/PACKAGE`, if it was added.",
    example="('share/' + package_name + '/urdf', glob('urdf/*')),  # urdf/parts is a folder",
    instead="('share/' + package_name + '/urdf', glob('urdf/*.*')),",
)
MISSING_PYTHON_PACKAGE = Rule(
    code="BLD042",
    name="missing-python-package",
    severity=Severity.ERROR,
    summary="`setup.py` names a Python package or module that does not exist.",
    why="The build stops where the folder of `packages` or the file of `py_modules` is missing.",
    example="packages=['my_robot'],  # without my_robot/__init__.py",
    instead="mkdir my_robot; touch my_robot/__init__.py",
)

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
        tree = ast.parse(file.read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError):
        return iter(())
    return ast.walk(tree)


def _missing_setup(failure: Failure) -> Iterator[Diagnostic]:
    if not failure.setup_file.exists():
        yield failure.report(
            MISSING_BUILD_FILE,
            "setup.py is missing; setuptools builds and installs the package with it.",
            hint="Write <build_type>ament_cmake</build_type> in package.xml: CMakeLists.txt exists."
            if failure.cmake_file.exists()
            else "Restore it (git checkout setup.py), or write one.",
        )


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
    path = failure.folder / name
    folder, _, base = name.rpartition("/")
    beside = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else []
    if path.is_dir():
        message = f"data_files names {name}, which is a folder; it takes files."
        hint = f"Give it a pattern that files alone match, and {name} an entry of its own."
    else:
        message = f"data_files names {name}, which does not exist."
        hint = f"{ask_for_nearest(base, beside)}Create it, or remove it from data_files."
        if folder == "resource":
            hint = (
                f"Create the empty file: mkdir -p {folder}; touch {name}"
                if base == failure.package
                else f"Use the name in package.xml, {failure.package}."
            )
    yield failure.report(
        MISSING_DATA_FILE,
        message,
        file=failure.setup_file,
        line=_find_path(failure.setup_file, name),
        hint=hint,
    )


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
        known = [entry.parent.name for entry in failure.folder.glob("*/__init__.py")]
        yield failure.report(
            MISSING_PYTHON_PACKAGE,
            f"packages names {name}, but the package has no folder of that name.",
            file=failure.setup_file,
            line=find_keyword(failure.setup_file, "packages"),
            hint=f"{ask_for_nearest(name, known)}Create it with an empty file __init__.py, or "
            "write packages=[] if the package has no Python modules.",
        )
    elif module:
        known = [entry.name for entry in failure.folder.glob("*.py")]
        yield failure.report(
            MISSING_PYTHON_PACKAGE,
            f"py_modules names a module without a file: {module[1]}.",
            file=failure.setup_file,
            line=find_keyword(failure.setup_file, "py_modules"),
            hint=f"{ask_for_nearest(module[1], known)}Create it, or remove it from py_modules.",
        )


def _setup_failure(failure: Failure) -> Iterator[Diagnostic]:
    # colcon runs it in processes of its own first, and keeps what they print.
    output = (
        failure.output if not re.search(r"colcon_\w+/", failure.output) else _run_setup(failure)
    )
    refused = re.search(r"(?m)^error in .+? setup command: (.+)", output)
    if refused:
        yield failure.report(
            SETUP_FAILURE,
            f"setuptools refuses an argument of setup(): {refused[1]}.",
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

"""Build packages of ROS where no ROS is sourced: what can be built is, and the rest is left out.

`cmake/without_ros.cmake` does the work inside CMake. It counts a missing package as found if its
name is known, leaves out the targets that need it, and writes what it left out into the build
folder of the package.
"""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.building.source_packages import is_installed
from wsgen.diagnostics import Rule, Severity
from wsgen.ros.names import CMAKE_NAMES, ROS_NAMES
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.building.colcon import PackageResult
    from wsgen.diagnostics import Diagnostic


NOT_COMPILED = Rule(
    code="BLD032",
    name="not-compiled",
    severity=Severity.INFO,
    severity_varies="an error with `wsgen build --strict`",
    summary="Without ROS, a package is installed without what cannot be compiled.",
    what="Without a sourced ROS, counts a package that find_package() asks for and that is not "
    "installed as found, if ROS or CMake knows its name, or its own build failed. Targets that "
    "need it, by name or by a header, are left out, with what installs and exports them, and so "
    "are messages without their generators.",
    why="Models, worlds, launch files and Python need no compiler, and `wsgen validate` starts no "
    "compiled node. On a machine with ROS, everything is compiled.",
    example="find_package(rclcpp REQUIRED)  # without a sourced ROS",
    instead="source /opt/ros/humble/setup.bash; wsgen build",
)

FILE = Path(__file__).with_name("cmake") / "without_ros.cmake"
OPTION = "CMAKE_PROJECT_TOP_LEVEL_INCLUDES"  # of CMake 3.24; older ones do not read it
MESSAGES = "messages"  # as what is left out is named
LEFT_OUT = "wsgen_left_out.txt"  # in the build folder of a package; wsgen.launching looks for it
LAST_ARGUMENTS = "cmake_args.last"  # colcon configures again without this file
COMPILERS = ("c++", "CC", "g++", "clang++")  # the names CMake looks for
# For CMake 4, which refuses cmake_minimum_required(VERSION 2.8); that of Ubuntu 24.04 does not.
OLD_PACKAGES = {"CMAKE_POLICY_VERSION_MINIMUM": "3.5"}
# What a sourced ROS sets and CMakeLists.txt asks for; the distribution is that of launch files.
SOURCED_VARIABLES = {"ROS_DISTRO": "iron", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}


def without_ros_variables(failed: Iterable[str] = ()) -> dict[str, str]:
    """The variables of environment that FILE reads; `failed` are packages of the workspace.

    A package of the workspace that did not fail is built before those that depend on it.
    """
    return {
        "WSGEN_NAMES": f"{ROS_NAMES};{CMAKE_NAMES}",
        "WSGEN_FAILED": ";".join(failed),
        "WSGEN_PYTHON": sys.executable,
    }


def without_ros_arguments(
    environment: Mapping[str, str], colcon_arguments: Sequence[str]
) -> tuple[str, ...]:
    """The arguments for CMake; none if the user includes a file in this way."""
    if any(OPTION in word for word in colcon_arguments):
        return ()
    has_compiler = (
        bool(environment.get("CXX"))
        or any("CMAKE_CXX_COMPILER" in word for word in colcon_arguments)
        or any(shutil.which(name, path=environment.get("PATH", os.defpath)) for name in COMPILERS)
    )
    return (f"-D{OPTION}={FILE}", f"-DWSGEN_HAS_COMPILER={'ON' if has_compiler else 'OFF'}")


def configure_again(
    build_folders: Iterable[Path], prefixes: Collection[Path], siblings: Collection[str]
) -> None:
    """Make colcon configure the packages again whose missing packages are installed by now."""
    for folder in build_folders:
        for name in _read(folder).get("missing", ()):
            is_whole = name in siblings and not (folder.parent / name / LEFT_OUT).exists()
            if is_whole or is_installed(name, prefixes):
                (folder / LAST_ARGUMENTS).unlink(missing_ok=True)


def add_left_out(package: PackageResult, build: Path) -> PackageResult:
    """Add what the build of a package left out; `build` is the folder of the workspace."""
    found = _read(build / package.name) if package.outcome == "built" else {}
    if not found:
        return package
    missing = found.get("missing", [])
    needs = [name for name in missing if not name.startswith("ament_")] or missing
    left_out = [*found.get("target", ()), *found.get("call", ())]
    if "interfaces" in found:
        left_out.append(MESSAGES)
    return replace(package, left_out=tuple(left_out), needs=tuple(needs))


def report_left_out(
    packages: Iterable[PackageResult],
    *,
    folders: Mapping[str, Path],
    strict: bool,
    no_messages: str = "",
) -> Iterator[Diagnostic]:
    """Report, for each package that was built in part, what is left out and why.

    `folders` has the folder of each package by its name; `no_messages` says what to do to have
    messages.
    """
    for package in packages:
        if package.left_out:
            yield NOT_COMPILED.at(
                folders[package.name] / "CMakeLists.txt",
                element=package.name,
                severity=Severity.ERROR if strict else Severity.INFO,
                message=f"{package.name} is built without {some_of(package.left_out)} "
                f"(not compiled: needs {some_of(package.needs)}).",
                hint=no_messages
                if no_messages and MESSAGES in package.left_out
                else "Source a ROS that has what is missing (source /opt/ros/<distro>/setup.bash) "
                "to compile it; everything else is installed.",
            )


def _read(folder: Path) -> dict[str, list[str]]:
    """The names in the report of a build folder by their kind; empty without a report."""
    try:
        lines = read_regular_text(folder / LEFT_OUT).splitlines()
    except OSError:
        return {}
    found: dict[str, list[str]] = {}
    for line in lines:
        kind, _, name = line.partition(" ")
        found.setdefault(kind, []).append(name)
    return found

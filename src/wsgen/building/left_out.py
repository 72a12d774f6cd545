"""What a build leaves out: packages that colcon skips, tests whose tools are not installed.

Packages of ROS are also built where no ROS is sourced: what can be built is, and the rest is left
out. `cmake/without_ros.cmake` does the work inside CMake. It counts a missing package as found if
its name is known, leaves out the targets that need it, and writes what it left out into the build
folder of the package.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.packages.workspace.manifest import DEFAULT_BUILD_TYPE, read_manifest
from wsgen.packages.workspace.package_xml import missing_build_type, unknown_build_type
from wsgen.ros.names import CMAKE_NAMES, ROS_NAMES
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.building.colcon import PackageResult
    from wsgen.packages.workspace.layout import PackageFolder


# `ros2 pkg create` writes `find_package(ament_lint_auto REQUIRED)` into every package.
TESTS_LEFT_OUT = Rule(
    code="BLD001",
    name="tests-left-out",
    severity=Severity.INFO,
    summary="The tests of a package need a package that is not installed, so it is built without.",
    what="Looks inside `if(BUILD_TESTING)`, which is on by default, for a required package that "
    "only tests need.",
    why="`colcon` builds the package with `-DBUILD_TESTING=OFF`, because it would fail otherwise. "
    "`colcon test` then runs no tests.",
    example="""if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
endif()""",
    instead="sudo apt install ros-humble-ament-lint-auto",
)
SKIPPED_PACKAGE = Rule(
    code="BLD023",
    name="skipped-package",
    severity=Severity.ERROR,
    summary="`colcon` does not build a package that was named.",
    why="An option such as --packages-skip, or a file of default options, excludes the package; "
    "colcon does not report that.",
    example="build: {packages-skip: [my_robot]}  # colcon_defaults.yaml",
    instead="build: {packages-skip: []}  # colcon_defaults.yaml",
)

WITHOUT_TESTS = "-DBUILD_TESTING=OFF"
LINTER = "ament_lint_auto"  # needed by tests alone, listed as test_depend or not
BUILD_TASKS = "colcon_core.task.build"  # colcon's extensions, one for each build type
ROS_PREFIX = "ros."  # of the names of those for packages with package.xml


def missing_test_dependencies(
    packages: Iterable[PackageFolder], *, prefixes: Collection[Path], built_here: Collection[str]
) -> dict[str, list[tuple[Path, int, str]]]:
    """Find the test packages that are required and neither installed nor built here.

    Args:
        packages: those that will be built.
        prefixes: where CMake looks for packages.
        built_here: names of all packages of the workspace.

    Returns:
        By the name of the package: the file, 1-based line and name of each call.
    """
    found: dict[str, list[tuple[Path, int, str]]] = {}
    for package in packages:
        if package.build_type != "ament_cmake":
            continue  # the option that leaves tests out does not reach it
        file = package.path / "CMakeLists.txt"
        calls = read_calls(file)
        if not any(call.command == "if" and "BUILD_TESTING" in call.arguments for call in calls):
            continue
        for call in calls:
            if call.command != "find_package" or "REQUIRED" not in call.arguments[1:]:
                continue
            name = call.arguments[0]
            if name != LINTER and name not in package.test_dependencies:
                continue
            if name not in built_here and not is_installed(name, prefixes):
                found.setdefault(package.name, []).append((file, call.line, name))
    return found


def tests_left_out(missing: Mapping[str, list[tuple[Path, int, str]]]) -> Iterator[Diagnostic]:
    """Report once which packages are built without tests, and what their tests require."""
    if missing:
        places = [place for calls in missing.values() for place in calls]
        names = some_of([*dict.fromkeys(name for _, _, name in places)])
        several = len(missing) > 1
        yield TESTS_LEFT_OUT.at(
            *places[0][:2],
            None if several else next(iter(missing)),
            message=f"{some_of([*missing])} {'are' if several else 'is'} built without tests "
            f"(BUILD_TESTING=OFF), because they require what is not installed: {names}.",
            hint="Install it to run the tests.",
        )


def is_installed(name: str, prefixes: Iterable[Path]) -> bool:
    """Whether CMake's find_package would find the package, by the usual folders and names."""
    return any(
        (prefix / folder / file).is_file()
        for prefix in prefixes
        for folder in (f"share/{name}/cmake", f"lib/cmake/{name}", f"lib/{name}/cmake")
        for file in (f"{name}Config.cmake", f"{name.lower()}-config.cmake")
    )


def unknown_build_types(packages: Iterable[PackageFolder], output: str) -> Iterator[Diagnostic]:
    """Report packages of an unknown build type, which colcon does not name.

    Args:
        packages: all packages of the workspace.
        output: what colcon itself printed.
    """
    refused = set(re.findall(rf"No task extension to 'build' a '{ROS_PREFIX}(.+?)' pack", output))
    for package in packages:
        if not package.diagnostics and package.build_type in refused:
            manifest = read_manifest(package.path / "package.xml")
            if not isinstance(manifest, Diagnostic):
                yield unknown_build_type(manifest, _known_build_types())


def missing_build_types(packages: Iterable[PackageFolder]) -> Iterator[Diagnostic]:
    """Report packages of ament that colcon takes for packages of ROS 1."""
    for package in packages:
        if package.diagnostics or package.build_type != DEFAULT_BUILD_TYPE:
            continue
        manifest = read_manifest(package.path / "package.xml")
        if isinstance(manifest, Diagnostic) or manifest.line_of("export", "build_type"):
            continue
        if any(
            call.command == "ament_package" for call in read_calls(package.path / "CMakeLists.txt")
        ):
            yield missing_build_type(manifest, "ament_cmake")


def skipped_packages(
    packages: Iterable[PackageFolder], *, wanted: Collection[str], built: Collection[str]
) -> Iterator[Diagnostic]:
    """Report packages that were selected by name and not built, for whatever reason."""
    for package in packages:
        if package.name in wanted and package.name not in built and not package.diagnostics:
            yield _report(
                SKIPPED_PACKAGE,
                package,
                f"colcon did not build {package.name}.",
                element="name",
                hint="Look for what excludes it: colcon's arguments (--packages-...), or a "
                "colcon_defaults.yaml.",
            )


def _known_build_types() -> set[str]:
    from importlib.metadata import entry_points  # noqa: PLC0415  20 ms that only this error pays

    names = {extension.name for extension in entry_points(group=BUILD_TASKS)}
    return {name.removeprefix(ROS_PREFIX) for name in names if name.startswith(ROS_PREFIX)}


def _report(
    rule: Rule, package: PackageFolder, message: str, *, element: str, hint: str
) -> Diagnostic:
    file = package.path / "package.xml"
    manifest = read_manifest(file)
    line = None
    if not isinstance(manifest, Diagnostic):
        line = manifest.line_of("export", element) or manifest.line_of(element)
    return rule.at(file, line, package.name, message=message, hint=hint)


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

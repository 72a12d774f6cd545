"""Packages that colcon skips or builds as another kind, and tests whose tools are not installed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.packages.workspace.manifest import DEFAULT_BUILD_TYPE, read_manifest
from wsgen.packages.workspace.package_xml import missing_build_type, unknown_build_type
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping
    from pathlib import Path

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

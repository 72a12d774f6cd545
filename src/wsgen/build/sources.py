"""Packages that only tests need, and that this machine may not have.

`ros2 pkg create` writes `find_package(ament_lint_auto REQUIRED)` into every package, inside
`if(BUILD_TESTING)`, which is on. Where the linters are not installed, a package that is in order
then does not build; without its tests it does.

What colcon passes over in silence: packages that it does not build, or builds as other ones.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.build.cmake_text import read_calls
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.suggestions import suggest
from wsgen.workspace.manifest import DEFAULT_BUILD_TYPE, read_manifest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from wsgen.workspace.layout import PackageFolder
    from wsgen.workspace.manifest import Manifest


TESTS_LEFT_OUT = "BLD001"
WITHOUT_TESTS = "-DBUILD_TESTING=OFF"
LINTER = "ament_lint_auto"  # needed by tests alone, listed as test_depend or not


def missing_test_dependencies(
    packages: Iterable[PackageFolder], *, prefixes: Collection[Path], built_here: Collection[str]
) -> tuple[Diagnostic, ...]:
    """Say which packages require a test package that is neither installed nor built here.

    Args:
        packages: those that will be built.
        prefixes: where CMake looks for packages.
        built_here: names of all packages of the workspace.
    """
    found: list[Diagnostic] = []
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
            if name in built_here or is_installed(name, prefixes):
                continue
            found.append(
                Diagnostic(
                    code=TESTS_LEFT_OUT,
                    severity=Severity.INFO,
                    message=f"Built without tests (BUILD_TESTING=OFF): {package.name} requires "
                    f"{name} for them, which is not installed.",
                    file=file,
                    line=call.line,
                    element=package.name,
                    hint=f"Nothing to do, or install {name}.",
                )
            )
    return tuple(found)


def is_installed(name: str, prefixes: Iterable[Path]) -> bool:
    """Whether CMake's find_package would find the package, by the usual folders and names."""
    return any(
        (prefix / folder / file).is_file()
        for prefix in prefixes
        for folder in (f"share/{name}/cmake", f"lib/cmake/{name}", f"lib/{name}/cmake")
        for file in (f"{name}Config.cmake", f"{name.lower()}-config.cmake")
    )


UNKNOWN_BUILD_TYPE = "PKG008"
MISSING_BUILD_TYPE = "PKG009"
PASSED_OVER = "BLD023"

BUILD_TASKS = "colcon_core.task.build"  # colcon's extensions, one for each build type
ROS_PREFIX = "ros."  # of the names of those for packages with package.xml


def unknown_build_types(packages: Iterable[PackageFolder], output: str) -> Iterator[Diagnostic]:
    """Say which packages colcon knows no way to build, which it says without naming them.

    Args:
        packages: all packages of the workspace.
        output: what colcon itself had to say.
    """
    refused = set(re.findall(rf"No task extension to 'build' a '{ROS_PREFIX}(.+?)' pack", output))
    for package in packages:
        if not package.diagnostics and package.build_type in refused:
            yield _diagnose(
                package,
                UNKNOWN_BUILD_TYPE,
                f"colcon did not build {package.name}: it knows no build type "
                f"{package.build_type}.",
                element="build_type",
                hint=suggest(package.build_type, _known_build_types()),
            )


def missing_build_types(packages: Iterable[PackageFolder]) -> Iterator[Diagnostic]:
    """Say which packages of ament are taken for such of ROS 1, as package.xml does not tell.

    They are built and installed, but what colcon writes for them does not bring them into the
    environment of ROS 2.
    """
    for package in packages:
        if package.diagnostics or package.build_type != DEFAULT_BUILD_TYPE:
            continue
        manifest = read_manifest(package.path / "package.xml")
        if isinstance(manifest, Diagnostic) or manifest.line_of("export", "build_type"):
            continue
        if any(
            call.command == "ament_package" for call in read_calls(package.path / "CMakeLists.txt")
        ):
            yield _diagnose(
                package,
                MISSING_BUILD_TYPE,
                f"package.xml of {package.name} gives no build type, so colcon takes it for a "
                f"{DEFAULT_BUILD_TYPE} package of ROS 1, and ROS 2 will not find it.",
                element="export",
                hint=f"{_where_to_add(manifest)}<build_type>ament_cmake</build_type>"
                f"{'' if manifest.line_of('export') else '</export>'}",
            )


def passed_over(
    packages: Iterable[PackageFolder], *, wanted: Collection[str], built: Collection[str]
) -> Iterator[Diagnostic]:
    """Say which packages were asked for by name and not built, for whatever reason."""
    for package in packages:
        if package.name in wanted and package.name not in built and not package.diagnostics:
            yield _diagnose(
                package,
                PASSED_OVER,
                f"colcon did not build {package.name}.",
                element="name",
                hint="Look for what makes it skip the package: its arguments (--packages-...), or "
                "a colcon_defaults.yaml.",
            )


def _known_build_types() -> set[str]:
    from importlib.metadata import entry_points  # noqa: PLC0415  20 ms that only this error pays

    names = {extension.name for extension in entry_points(group=BUILD_TASKS)}
    return {name.removeprefix(ROS_PREFIX) for name in names if name.startswith(ROS_PREFIX)}


def _where_to_add(manifest: Manifest) -> str:
    return "Add below <export>: " if manifest.line_of("export") else "Add: <export>"


def _diagnose(
    package: PackageFolder, code: str, message: str, *, element: str, hint: str
) -> Diagnostic:
    file = package.path / "package.xml"
    manifest = read_manifest(file)
    line = None
    if not isinstance(manifest, Diagnostic):
        line = manifest.line_of("export", element) or manifest.line_of(element)
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=line,
        element=package.name,
        hint=hint,
    )

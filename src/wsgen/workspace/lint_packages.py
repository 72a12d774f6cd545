"""Packages that only tests need, and that this machine may not have.

`ros2 pkg create` writes `find_package(ament_lint_auto REQUIRED)` into every package, inside
`if(BUILD_TESTING)`, which is on. Where the linters are not installed, a package that is in order
then does not build; without its tests it does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.workspace.cmake_text import read_calls

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from pathlib import Path

    from wsgen.workspace.layout import PackageFolder

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

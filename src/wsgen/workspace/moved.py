"""Build folders that were made elsewhere: of a workspace or package that was moved or copied.

CMake keeps absolute paths. In the copy of a workspace it says so on standard error, and then
builds the original.
"""

from __future__ import annotations

import os
import re
import shlex
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.workspace.layout import PackageFolder, Workspace

MOVED_WORKSPACE = "BLD025"
MOVED_PACKAGE = "BLD026"

ENTRY = re.compile(r"^CMAKE_(CACHEFILE_DIR|HOME_DIRECTORY):INTERNAL=(.*)$", re.MULTILINE)
# With these, the build folders are others, or what CMake remembers is forgotten first.
EXCUSES = ("--build-base", "--cmake-clean-cache")


def find_moved(
    workspace: Workspace, packages: Iterable[PackageFolder], colcon_arguments: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """Say what CMake remembers of another place; once where it is the whole workspace."""
    if any(argument.startswith(EXCUSES) for argument in colcon_arguments):
        return ()
    found: list[Diagnostic] = []
    for package in packages:
        folder = workspace.build / package.name
        try:
            text = (folder / "CMakeCache.txt").read_text(encoding="utf-8")
        except (OSError, ValueError):
            continue
        remembered = dict(ENTRY.findall(text))
        built_in = remembered.get("CACHEFILE_DIR", str(folder))
        source = remembered.get("HOME_DIRECTORY", str(package.path))
        if os.path.realpath(built_in) != os.path.realpath(folder):
            return (_moved_workspace(workspace, built_in),)
        if os.path.realpath(source) != os.path.realpath(package.path):
            found.append(_moved_package(workspace, package, source))
    return tuple(found)


def _moved_workspace(workspace: Workspace, built_in: str) -> Diagnostic:
    spaces = (workspace.build, workspace.install, workspace.log)
    return Diagnostic(
        code=MOVED_WORKSPACE,
        severity=Severity.ERROR,
        message=f"The workspace was moved or copied: it was built in {built_in}, and CMake would "
        "go on there.",
        file=workspace.build,
        hint=f"Remove build, install and log, then build again: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )


def _moved_package(workspace: Workspace, package: PackageFolder, source: str) -> Diagnostic:
    spaces = (workspace.build / package.name, workspace.install / package.name)
    return Diagnostic(
        code=MOVED_PACKAGE,
        severity=Severity.ERROR,
        message=f"{package.name} was moved: it was built from {source}, where CMake looks for it.",
        file=package.path,
        element=package.name,
        hint="Remove what was built of it, then build again: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )

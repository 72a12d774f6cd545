"""Check what a build left: the files in the install space, and build folders made elsewhere.

CMake keeps absolute paths. In a copy of a workspace it only warns on standard error, and then
builds the original.
"""

from __future__ import annotations

import os
import re
import shlex
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.building.toolchain import INDEX
from wsgen.diagnostics import Rule, Severity
from wsgen.packages.build_files.cmake_checks import missing_ament_package
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.text.files import read_regular_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.layout import PackageFolder, Workspace


STALE_FILES = Rule(
    code="BLD024",
    name="stale-files",
    severity=Severity.WARNING,
    summary="The install space has files that the package no longer installs.",
    what="Compares the share folder of the package with the list of files that CMake or setuptools "
    "installed, unless install() runs a script.",
    why="Neither removes files that an earlier build installed. A launch file still finds "
    "them here, but not after a build in a clone of the workspace.",
    example="git mv model/robot.xacro model/arm.xacro; wsgen build",
    instead="rm -r install/my_robot build/my_robot; wsgen build",
)
RELOCATED_WORKSPACE = Rule(
    code="BLD025",
    name="relocated-workspace",
    severity=Severity.WARNING,
    summary="The workspace was moved, copied or cloned after it was built.",
    what="Compares the folder in CMakeCache.txt with the build folder. `wsgen build` has CMake "
    "make its caches anew.",
    why="CMake keeps absolute paths: `colcon build` fails, or goes on building in the first place. "
    "The install space may hold files of the first build.",
    example="cp -r ws ws_2; cd ws_2; wsgen build",
    instead="cp -r ws ws_2; cd ws_2; rm -r build install log; wsgen build",
)
RELOCATED_PACKAGE = Rule(
    code="BLD026",
    name="relocated-package",
    severity=Severity.WARNING,
    summary="A package was moved to another folder after it was built.",
    what="Compares the source folder in CMakeCache.txt with the folder of the package. `wsgen "
    "build` has CMake make its caches anew.",
    why="CMake keeps absolute paths: `colcon build` looks for the sources in the first folder.",
    example="mv src/my_robot src/robots/my_robot; wsgen build",
    instead="mv src/my_robot src/robots/my_robot; rm -r build/my_robot; wsgen build",
)

# What lists the installed files, in the build folder.
MANIFESTS = {
    "ament_cmake": "install_manifest.txt",
    "ament_python": "install.log",
    "cmake": "install_manifest.txt",
}
COLCON_FILES = (
    *("package.sh", "package.bash", "package.zsh", "package.ps1", "package.dsv"),
    "package.xml",  # of a Python package that does not install it
)
COLCON_FOLDERS = frozenset({"hook"})
NAMED = 5  # files in a message


def check_installed(
    packages: Iterable[PackageFolder], workspace: Workspace
) -> Iterator[Diagnostic]:
    """Check the files that packages installed, where colcon puts them by default.

    With --install-base, --merge-install or --symlink-install nothing is checked.
    """
    for package in packages:
        prefix = workspace.install / package.name
        # colcon writes it in every build.
        if package.diagnostics or not (prefix / "share" / package.name / "package.sh").is_file():
            continue
        if package.build_type in MANIFESTS:
            if (prefix / INDEX / package.name).is_symlink():
                continue  # colcon build --symlink-install: CMake does not list links
            manifest = workspace.build / package.name / MANIFESTS[package.build_type]
            written = _read_install_manifest(manifest, prefix)
            if package.build_type == "ament_cmake" and not _is_registered(package, prefix, written):
                file = package.path / "CMakeLists.txt"
                line = max((call.line for call in read_calls(file)), default=None)
                yield missing_ament_package(package.name, file, line)
            elif written:
                yield from _stale_files(package, workspace, prefix, written)


def _read_install_manifest(manifest: Path, prefix: Path) -> frozenset[str]:
    """List what was installed into the prefix, as paths relative to it; empty if unknown.

    A DESTINATION that ends in a slash gives two slashes in a row.
    """
    try:
        text = read_regular_text(manifest)
    except (OSError, ValueError):
        return frozenset()
    roots = {f"{prefix}/", f"{prefix.resolve()}/"}
    paths = [os.path.normpath(line) for line in text.splitlines()]
    return frozenset(
        path.removeprefix(root) for path in paths for root in roots if path.startswith(root)
    )


def _is_registered(package: PackageFolder, prefix: Path, written: frozenset[str]) -> bool:
    """Whether ROS finds the package, and not only by a marker of an earlier build."""
    marker = f"{INDEX}/{package.name}"
    return marker in written if written else (prefix / marker).exists()


def _stale_files(
    package: PackageFolder, workspace: Workspace, prefix: Path, written: frozenset[str]
) -> Iterator[Diagnostic]:
    calls = read_calls(package.path / "CMakeLists.txt")
    if any(call.command == "install" and {"CODE", "SCRIPT"} & {*call.arguments} for call in calls):
        return  # CMake does not list what a script installs
    share = prefix / "share" / package.name
    stale = [
        name
        for name in _list_files(share)
        if f"share/{package.name}/{name}" not in written and name not in COLCON_FILES
    ]
    if stale:
        is_python = package.build_type == "ament_python"
        where = "data_files in setup.py" if is_python else "install() in CMakeLists.txt"
        others = f" and {len(stale) - NAMED} more" if len(stale) > NAMED else ""
        folders = shlex.join(
            str(space / package.name) for space in (workspace.install, workspace.build)
        )
        yield STALE_FILES.at(
            share,
            element=package.name,
            message=f"The install space of {package.name} has files that the package no longer "
            f"installs: {', '.join(stale[:NAMED])}{others}. A fresh build will not have them.",
            hint=f"If that is intended, remove them (rm -rf {folders}) and build again. Otherwise "
            f"add them to {where}.",
        )


def _list_files(share: Path) -> Iterator[str]:
    for folder, folders, files in os.walk(share):
        below = Path(folder).relative_to(share)
        folders[:] = sorted(
            name
            for name in folders
            if name != "__pycache__" and (below.parts or name not in COLCON_FOLDERS)
        )
        yield from ((below / name).as_posix() for name in sorted(files))


ENTRY = re.compile(r"^CMAKE_(CACHEFILE_DIR|HOME_DIRECTORY):INTERNAL=(.*)$", re.MULTILINE)
# With these options CMake uses other build folders, or a new cache.
NEW_CACHE = "--cmake-clean-cache"
OTHER_CACHE = ("--build-base", NEW_CACHE)


def find_relocated(
    workspace: Workspace, packages: Iterable[PackageFolder], colcon_arguments: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """Report packages whose CMake cache is of another place; once for a whole workspace."""
    if any(argument.startswith(OTHER_CACHE) for argument in colcon_arguments):
        return ()
    found: list[Diagnostic] = []
    packages = tuple(packages)
    counts = Counter(package.name for package in packages)
    for package in packages:
        if counts[package.name] > 1:
            continue  # that is the error: the cache is of one of them
        folder = workspace.build / package.name
        try:
            text = read_regular_text(folder / "CMakeCache.txt")
        except (OSError, ValueError):
            continue
        remembered = dict(ENTRY.findall(text))
        built_in = remembered.get("CACHEFILE_DIR", str(folder))
        source = remembered.get("HOME_DIRECTORY", str(package.path))
        if os.path.realpath(built_in) != os.path.realpath(folder):
            return (_relocated_workspace(workspace, built_in),)
        if os.path.realpath(source) != os.path.realpath(package.path):
            found.append(_relocated_package(workspace, package, source))
    return tuple(found)


def _relocated_workspace(workspace: Workspace, built_in: str) -> Diagnostic:
    spaces = (workspace.build, workspace.install, workspace.log)
    return RELOCATED_WORKSPACE.at(
        workspace.build,
        message=f"The workspace was moved, copied or cloned after a build in {built_in}: CMake's "
        "caches are made anew.",
        hint="To be rid of all files of that build, build again after: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )


def _relocated_package(workspace: Workspace, package: PackageFolder, source: str) -> Diagnostic:
    spaces = (workspace.build / package.name, workspace.install / package.name)
    return RELOCATED_PACKAGE.at(
        package.path,
        element=package.name,
        message=f"{package.name} was moved: it was built from {source} before. CMake's caches are "
        "made anew.",
        hint="To be rid of all files of that build, build again after: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )

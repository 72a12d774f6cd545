"""What a package has in the install space after it was built, and should not have, or should.

Build folders that were made elsewhere: of a workspace or package that was moved or copied.

CMake keeps absolute paths. In the copy of a workspace it says so on standard error, and then
builds the original.
"""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build.cmake_text import read_calls
from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.workspace.layout import PackageFolder, Workspace


MISSING_AMENT_PACKAGE = "BLD010"
STALE_FILES = "BLD024"

CMAKE_TYPES = frozenset({"ament_cmake", "cmake"})
INDEX = "share/ament_index/resource_index/packages"
COLCONS = ("package.sh", "package.bash", "package.zsh", "package.ps1", "package.dsv")
COLCONS_FOLDERS = frozenset({"hook"})
NAMED = 5  # so many files are told in a message


def check_installed(
    packages: Iterable[PackageFolder], workspace: Workspace
) -> Iterator[Diagnostic]:
    """Look at what packages of CMake have installed, where colcon puts it by default.

    Elsewhere (--install-base, --merge-install, --symlink-install) nothing is found.
    """
    for package in packages:
        prefix = workspace.install / package.name
        # Written by colcon in every build: it is not only there from another build.
        if package.diagnostics or not (prefix / "share" / package.name / "package.sh").is_file():
            continue
        if package.build_type in CMAKE_TYPES:
            written = _read_install_manifest(workspace.build / package.name, prefix)
            if package.build_type == "ament_cmake" and not _is_registered(package, prefix, written):
                yield _missing_ament_package(package)
            elif written:
                yield from _stale_files(package, workspace, prefix, written)


def _read_install_manifest(build_folder: Path, prefix: Path) -> frozenset[str]:
    """List what CMake installed into the prefix, as paths relative to it; empty if unknown."""
    try:
        text = (build_folder / "install_manifest.txt").read_text(encoding="utf-8")
    except (OSError, ValueError):
        return frozenset()
    roots = {f"{prefix}/", f"{prefix.resolve()}/"}
    return frozenset(
        line.removeprefix(root) for line in text.splitlines() for root in roots if root in line
    )


def _is_registered(package: PackageFolder, prefix: Path, written: frozenset[str]) -> bool:
    """Whether ROS finds the package, and not only by a marker of an earlier build."""
    marker = f"{INDEX}/{package.name}"
    return marker in written if written else (prefix / marker).exists()


def _missing_ament_package(package: PackageFolder) -> Diagnostic:
    file = package.path / "CMakeLists.txt"
    return Diagnostic(
        code=MISSING_AMENT_PACKAGE,
        severity=Severity.ERROR,
        message=f"{package.name} was built, but ROS will not find it: its CMakeLists.txt "
        "does not call ament_package().",
        file=file,
        line=max((call.line for call in read_calls(file)), default=None),
        element=package.name,
        hint="Call ament_package() at the end of CMakeLists.txt.",
    )


def _stale_files(
    package: PackageFolder, workspace: Workspace, prefix: Path, written: frozenset[str]
) -> Iterator[Diagnostic]:
    calls = read_calls(package.path / "CMakeLists.txt")
    if any(call.command == "install" and {"CODE", "SCRIPT"} & {*call.arguments} for call in calls):
        return  # what a script installs is written down nowhere
    share = prefix / "share" / package.name
    stale = [
        name
        for name in _list_files(share)
        if f"share/{package.name}/{name}" not in written and name not in COLCONS
    ]
    if stale:
        others = f" and {len(stale) - NAMED} more" if len(stale) > NAMED else ""
        folders = shlex.join(
            str(space / package.name) for space in (workspace.install, workspace.build)
        )
        yield Diagnostic(
            code=STALE_FILES,
            severity=Severity.WARNING,
            message=f"Still in the install space of {package.name}, and not installed any more: "
            f"{', '.join(stale[:NAMED])}{others}. Whoever builds afresh will not have them.",
            file=share,
            element=package.name,
            hint=f"If that is meant, remove them: rm -rf {folders}; then build again. Otherwise "
            "look at what install() in CMakeLists.txt names.",
        )


def _list_files(share: Path) -> Iterator[str]:
    for folder, folders, files in os.walk(share):
        below = Path(folder).relative_to(share)
        folders[:] = sorted(
            name
            for name in folders
            if name != "__pycache__" and (below.parts or name not in COLCONS_FOLDERS)
        )
        yield from ((below / name).as_posix() for name in sorted(files))


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

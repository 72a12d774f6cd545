"""The package to which something is added, and the distribution and simulator that it is for."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, RequestError
from wsgen.model.target import CLASSIC, DISTROS_WITH_CLASSIC, SIM, choose_target
from wsgen.packages.workspace.layout import (
    BUILD_MARKERS,
    Workspace,
    current_folder,
    find_packages,
    open_workspace,
    read_package,
    workspace_around,
)
from wsgen.packages.workspace.settings import FILE as SETTINGS
from wsgen.packages.workspace.settings import read_settings
from wsgen.porting.adding.addition import Addition
from wsgen.text.files import list_files, read_or_empty
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import PackageFolder

_OF_SIMULATORS = {
    CLASSIC: re.compile(r">\s*(?:gazebo_ros\w*|gazebo_plugins|gazebo_ros2_control)\s*<"),
    SIM: re.compile(r">\s*(?:ros_(?:gz|ign)\w*|(?:gz|ign)_ros2_control)\s*<"),
}
OF_FILES = {
    CLASSIC: re.compile(r"\blibgazebo_ros|['\"]gazebo_ros['\"]|spawn_entity\.py"),
    SIM: re.compile(
        r"\b(?:gz|ign)(?:-sim|ition-gazebo|_ros2_control)-\w|['\"]ros_(?:gz|ign)_\w+['\"]"
    ),
}
_SIMULATED = (".py", ".xml", ".xacro", ".urdf", ".gazebo", ".sdf", ".world")
NEWEST_LASTING = "jazzy"  # where nothing says the distribution
_BUILT = ("ament_cmake", "ament_python")


def open_addition(
    to: str | None,
    workspace: str | None,
    distro: str | None,
    simulator: str | None,
    environment: Mapping[str, str],
) -> Addition:
    """Find the package, by default that around the current folder or the only one.

    Raises:
        NotFoundError: It does not exist.
        RequestError: Several may be meant, or it is of another kind.
    """
    package, packages = _find(to, workspace)
    if package.diagnostics:
        first = package.diagnostics[0]
        raise RequestError(first.message, hint=first.hint or "Fix package.xml first.")
    if package.build_type not in _BUILT:
        raise RequestError(
            f"{package.name} has the build type {package.build_type}; files are added to packages "
            f"of {' and '.join(_BUILT)}.",
            hint="Choose another package with --to.",
        )
    known = {one.name: one for one in (*packages, package)}
    target = _target(package, known.values(), distro, simulator, environment)
    return Addition(package, target, known)


def _find(to: str | None, workspace: str | None) -> tuple[PackageFolder, tuple[PackageFolder, ...]]:
    if to is not None and (os.sep in to or to == "." or (Path(to) / "package.xml").is_file()):
        folder = Path(os.path.normpath(Path(to).absolute()))
        package = read_package(folder) if (folder / "package.xml").is_file() else None
        if package is None:
            raise NotFoundError(
                f"{folder} is not a package: it has no package.xml.",
                hint="Give the name of a package, or its folder.",
            )
        place = workspace_around(folder)
        return package, () if place is None else find_packages(place)
    here = current_folder()
    around = next((one for one in (here, *here.parents) if (one / "package.xml").is_file()), None)
    if to is None and workspace is None and around is not None:
        package = read_package(around)
        if package is not None:
            place = workspace_around(around) or Workspace(root=around)
            return package, find_packages(place)
    packages = find_packages(open_workspace(workspace))
    names = sorted(one.name for one in packages)
    if to is not None:
        found = next((one for one in packages if one.name == to), None)
        if found is None:
            raise NotFoundError(
                f"The workspace has no package {to}.",
                hint=f"{ask_for_nearest(to, names)}Its packages: {some_of(names, 8) or '-'}.",
            )
        return found, packages
    if len(packages) != 1:
        raise RequestError(
            f"The workspace has {len(packages)} packages.",
            hint=f"Choose one with --to: {some_of(names, 8) or 'PACKAGE'}.",
        )
    return packages[0], packages


def _target(
    package: PackageFolder,
    packages: Iterable[PackageFolder],
    distro: str | None,
    simulator: str | None,
    environment: Mapping[str, str],
) -> Target:
    """What a package is for: as it is given, recorded, sourced, or shown by what it depends on."""
    settings, _ = read_settings(package.path)
    if simulator is None:
        simulator = _simulator(package, packages)
    found = distro or settings.distro or environment.get("ROS_DISTRO")
    if found is None:
        found = DISTROS_WITH_CLASSIC[0] if simulator == CLASSIC else NEWEST_LASTING
    if simulator == CLASSIC and distro is None and found not in DISTROS_WITH_CLASSIC:
        simulator = SIM
    return choose_target(found, simulator or SIM, is_from_environment=distro is None)


def _simulator(package: PackageFolder, packages: Iterable[PackageFolder]) -> str | None:
    """The simulator that a package, or else one of the others, is for."""
    recorded = re.search(
        r"(?m)^\s*simulator\s*=\s*[\"'](\w+)", read_or_empty(package.path / SETTINGS)
    )
    if recorded is not None and recorded[1] in _OF_SIMULATORS:
        return recorded[1]
    files = list_files(package.path, _SIMULATED, markers=BUILD_MARKERS)
    places = [
        ([package.path / "package.xml"], _OF_SIMULATORS),
        (files, OF_FILES),
        *(([one.path / "package.xml"], _OF_SIMULATORS) for one in packages),
    ]
    for paths, patterns in places:
        texts = [*map(read_or_empty, paths)]
        found = [name for name, one in patterns.items() if any(map(one.search, texts))]
        if found:
            return found[-1]  # a package of both has been ported
    return None

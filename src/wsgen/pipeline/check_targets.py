"""What the paths of `wsgen check` mean: packages, install spaces, files."""

from __future__ import annotations

import os
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotFoundError
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.layout import (
    INSTALL_LAYOUT,
    PackageFolder,
    Workspace,
    find_packages,
    ignored_below,
    open_workspace,
    read_package,
    refuse_missing_manifest,
    with_surroundings,
    workspace_around,
)
from wsgen.packages.workspace.robot_files import find_descriptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


class Targets(NamedTuple):
    """What is checked, and what may be looked up."""

    packages: tuple[PackageFolder, ...] = ()  # with source
    installed: tuple[PackageFolder, ...] = ()  # of install spaces: their share folders
    prefixes: tuple[Path, ...] = ()  # of these
    files: tuple[Path, ...] = ()  # outside of any package
    # Of packages only what is reported about these files and folders is wanted; none: everything.
    only: tuple[Path, ...] = ()
    workspaces: tuple[Workspace, ...] = ()  # the packages of all of them can be looked up
    # The packages of those that were listed.
    inventories: Mapping[Workspace, tuple[PackageFolder, ...]] = MappingProxyType({})


def find_targets(paths: Sequence[Path], workspace: str | None = None) -> Targets:
    """Find what the paths mean; without any, it is the workspace around the current folder.

    A file or a folder in a package means that package, as far as it is about the file or folder.

    Raises:
        NotFoundError: a path does not exist, or a folder has no package.
        RequestError: the current folder has several workspaces.
    """
    if not paths:
        place = open_workspace(workspace)
        found = _require_packages(place)
        around = with_surroundings(place)
        return Targets(packages=found, workspaces=around, inventories={place: found})
    packages: dict[Path, PackageFolder] = {}
    installed: dict[Path, PackageFolder] = {}
    prefixes: dict[Path, None] = {}
    places: dict[Path, Workspace] = {}
    inventories: dict[Workspace, tuple[PackageFolder, ...]] = {}
    files: list[Path] = []
    only: list[Path] = []
    is_partial = False
    if workspace is not None:
        place = open_workspace(workspace)
        places[place.root] = place
    for path in (one.absolute() for one in paths):
        if not path.exists():
            raise NotFoundError(
                f"{path} does not exist.",
                hint="Give a package, a workspace, an install space or a file; without a path, the "
                "workspace around the current folder is checked.",
            )
        path = Path(os.path.normpath(path))  # noqa: PLW2901
        place_around = workspace_around(path if path.is_dir() else path.parent)
        if place_around is not None:
            places[place_around.root] = place_around
        package = _package_around(path)
        if path.is_dir() and _is_install_space(path):
            prefixes.update(dict.fromkeys(_prefixes(path)))
            installed.update((one.path, one) for one in _installed_packages(path))
        elif package is not None:
            packages[package.path] = package
            only.append(path)
            is_partial = is_partial or path != package.path
        elif path.is_dir():
            place = Workspace(root=path)
            found = find_packages(place)
            if found:
                places.setdefault(path, place)
                inventories[place] = found
                packages.update((one.path, one) for one in found)
                only.append(path)
            else:
                files += _require_files(path)
        else:
            files.append(path)
    return Targets(
        packages=tuple(packages.values()),
        installed=tuple(installed.values()),
        prefixes=tuple(prefixes),
        files=tuple(files),
        only=tuple(only) if is_partial else (),
        workspaces=tuple(places.values()),
        inventories=inventories,
    )


def _require_packages(place: Workspace) -> tuple[PackageFolder, ...]:
    packages = find_packages(place)
    if not packages:
        _refuse_ignored(place.root)
        refuse_missing_manifest([place.root])
        raise NotFoundError(
            f"{place.root} does not contain a ROS package.",
            hint="Give a folder with packages, or a file: wsgen check robot.urdf",
        )
    return packages


def _refuse_ignored(root: Path) -> None:
    """Stop if a folder has packages, and colcon ignores them.

    Raises:
        NotFoundError: It does.
    """
    ignored = next(ignored_below(root), None)
    if ignored is not None:
        folder, marker = ignored
        raise NotFoundError(
            f"{root} does not contain a ROS package: colcon ignores {folder}, because {marker} "
            "exists.",
            hint=f"Remove {marker}, or give the package: wsgen check {folder}",
        )


def _require_files(folder: Path) -> tuple[Path, ...]:
    """The robots and worlds below a folder that has no package."""
    files = tuple(find_descriptions(folder))
    if not files:
        _refuse_ignored(folder)
        raise NotFoundError(
            f"{folder} does not contain a ROS package, robot or world.",
            hint="Give a folder with packages, or a file: wsgen check robot.urdf",
        )
    return files


def _package_around(path: Path) -> PackageFolder | None:
    """The package that a path is or lies in."""
    for folder in (path, *path.parents):
        if (folder / "package.xml").is_file() and folder.parent.name != "share":
            return read_package(folder)
    return None


def _is_install_space(folder: Path) -> bool:
    return (folder / INSTALL_LAYOUT).is_file() or (folder / INDEX).is_dir()


def _prefixes(install: Path) -> Iterator[Path]:
    """The prefixes of an install space: itself if merged, else one for each package."""
    if (install / INDEX).is_dir():
        yield install
        return
    yield from sorted(place for place in install.iterdir() if (place / INDEX).is_dir())


def _installed_packages(install: Path) -> Iterator[PackageFolder]:
    for prefix in _prefixes(install):
        for marker in sorted((prefix / INDEX).iterdir()):
            share = prefix / "share" / marker.name
            package = read_package(share) if (share / "package.xml").is_file() else None
            if package is not None:
                yield package

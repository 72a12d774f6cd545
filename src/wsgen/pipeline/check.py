"""The stages of `wsgen check`: packages and files are read, evaluated and checked; nothing moves.

Launch files see the packages as they would be installed: a scratch folder is laid out as the
install space would be after a build, with links to the sources.
"""

from __future__ import annotations

import gc
import os
import time
from contextlib import ExitStack, contextmanager
from dataclasses import field, replace
from functools import partial
from itertools import zip_longest
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import has_errors
from wsgen.errors import NotFoundError, RequestError
from wsgen.events import OneAtATime
from wsgen.isolation.parent import make_scratch
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
from wsgen.packages.workspace.package_xml import duplicate_names
from wsgen.packages.workspace.robot_files import find_descriptions
from wsgen.pipeline.check_package import FileCheck, PackageCheck
from wsgen.pipeline.failed_builds import with_submodules
from wsgen.pipeline.installed_as_built import lay_out
from wsgen.pipeline.parallel import run_parallel
from wsgen.pipeline.reported import read_permissions
from wsgen.ros.names import released_packages
from wsgen.text.files import remembering
from wsgen.text.suggestions import advice
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.pipeline.reported import Permissions


@dataclass(frozen=True, kw_only=True)
class CheckRequest:
    """What to check, and how."""

    paths: Sequence[Path] = ()  # none: the workspace around the current folder
    workspace: str | None = None  # as `-w` gives it
    distro: str | None = None  # the target, where packages do not say it
    jobs: int = 1  # number of packages or files to check in parallel


@dataclass(frozen=True, kw_only=True)
class CheckOutcome:
    """What was checked, and what is reported about it."""

    diagnostics: tuple[Diagnostic, ...] = ()  # by file and line
    packages: tuple[str, ...] = ()  # names
    folders: Mapping[str, Path] = field(default_factory=dict)  # of the packages
    files: tuple[Path, ...] = ()  # that belong to no package
    only: tuple[Path, ...] = ()  # files and folders in packages that were asked for; none: all
    # What packages allow themselves, by their folders; of others it is read when it is asked for.
    permissions: Mapping[Path, Permissions] = field(default_factory=dict)
    seconds: float = 0.0  # wall-clock

    @property
    def passed(self) -> bool:
        """Whether no error is reported."""
        return not has_errors(self.diagnostics)


_WITHOUT_DATA = ("dashing", "eloquent", "galactic")  # they are older than what is known of them


def _refuse_unknown_distro(distro: str) -> None:
    known = released_packages()["ament_cmake"]
    if distro not in known and distro not in _WITHOUT_DATA:
        raise RequestError(
            f"'{distro}' is not a ROS 2 distribution that wsgen knows: {', '.join(known)}.",
            hint=advice(distro.lower(), known, "Use one of these, for example --distro jazzy"),
        )


def check(
    request: CheckRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> CheckOutcome:
    """Check packages and files without building or simulating them.

    Raises:
        NotFoundError: a path does not exist, or a folder has no package.
        RequestError: the current folder has several workspaces, or the target does not exist.
    """
    with remembering():
        return _check(request, environment, listener)


def _check(
    request: CheckRequest,
    environment: Mapping[str, str],
    listener: Listener | None,
) -> CheckOutcome:
    before = time.perf_counter()
    if request.distro is not None:
        _refuse_unknown_distro(request.distro)
    targets = find_targets(request.paths, request.workspace)
    serial = OneAtATime(listener)
    ended: list[_Checked] = []
    with ExitStack() as stack:
        scratch = stack.enter_context(make_scratch(in_memory=True))
        # Meshes may be written into this one, which may be more than the memory has room for.
        work = stack.enter_context(make_scratch())

        installed = lay_out(targets, scratch, environment, jobs=request.jobs)
        folders = [one.path for one in (*targets.packages, *targets.installed)]

        def calls(run: Run) -> list[Callable[[], _Checked]]:
            checks = [
                *(
                    partial(_check_package, package, installed, request.distro, serial, run, work)
                    for package in (*targets.packages, *targets.installed)
                ),
                *(
                    partial(_check_file, file, installed, serial, run, work)
                    for file in targets.files
                ),
            ]
            return [
                partial(_with_permissions, check, folder)
                for check, folder in zip_longest(checks, folders)
            ]

        with _collecting_little():
            run_parallel(calls, request.jobs, serial, ended, in_workers=True)
        once = _once(found for each in ended for found in each.diagnostics)
        reported = [*with_submodules(once, (one.path for one in targets.packages))]
    for place, packages in targets.inventories.items():
        if (place.root / "src").is_dir():  # elsewhere somebody keeps several workspaces
            reported += duplicate_names(place.root, packages)
    return CheckOutcome(
        diagnostics=_in_order(_wanted(reported, targets)),
        packages=tuple(one.name for one in (*targets.packages, *targets.installed)),
        folders={one.name: one.path for one in (*targets.packages, *targets.installed)},
        files=targets.files,
        only=targets.only,
        permissions={
            one.folder: one.permissions for one in ended if one.folder and one.permissions
        },
        seconds=time.perf_counter() - before,
    )


class _Checked(NamedTuple):
    """What is found in a package, or in a file without one."""

    diagnostics: tuple[Diagnostic, ...]
    folder: Path | None = None  # of the package
    permissions: Permissions | None = None


def _with_permissions(check: Callable[[], tuple[Diagnostic, ...]], folder: Path | None) -> _Checked:
    """What a check finds, and what the package allows: read here, several jobs do it at a time."""
    gc.collect(1)  # what the package before it has left: the collector runs seldom by itself
    return _Checked(check(), folder, None if folder is None else read_permissions(folder))


@contextmanager
def _collecting_little() -> Iterator[None]:
    """Let the garbage collector pass over what is there already, which takes most of its time."""
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def _check_package(*arguments: Any) -> tuple[Diagnostic, ...]:
    return PackageCheck(*arguments).run()


def _check_file(*arguments: Any) -> tuple[Diagnostic, ...]:
    return FileCheck(*arguments).run()


_SCOPE = lazy_pattern(r"(?<=`)(?:[\w.-]+::)+")  # the models that a link is in


def _once(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Each diagnostic once: what is in the file of a model is found in the worlds with it, too.

    Of those, the one that names no other model stays.
    """
    unique: dict[Diagnostic, Diagnostic] = {}
    for found in diagnostics:
        key = found
        if found.line is not None and found.element is not None:
            key = replace(found, message=_SCOPE.sub("", found.message), element=None)
        if len(found.message) < len(unique.setdefault(key, found).message):
            unique[key] = found
    return list(unique.values())


def _wanted(diagnostics: Sequence[Diagnostic], targets: Targets) -> tuple[Diagnostic, ...]:
    """What is reported about the files and folders that were named."""
    if not targets.only:
        return tuple(dict.fromkeys(diagnostics))
    places = (*targets.only, *targets.files, *(one.path for one in targets.installed))
    return tuple(
        found
        for found in dict.fromkeys(diagnostics)
        if found.file is not None and any(found.file.is_relative_to(place) for place in places)
    )


def _in_order(diagnostics: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """By file and line, errors first where these are the same."""
    severities = ["error", "warning", "info"]
    return tuple(
        sorted(
            diagnostics,
            key=lambda found: (
                os.fspath(found.file or ""),
                found.line or 0,
                severities.index(found.severity.value),
                found.code,
            ),
        )
    )


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

"""The install space that a build would leave, laid out with links to the sources.

Launch files and robots are read from it, so that what no rule installs is missing, as it would be
after `colcon build`; what is reported names the sources. Only packages that are checked are in it,
and those that their files may look up: reading the build files of a hundred packages to check one
takes longer than everything else.
"""

from __future__ import annotations

import os
import re
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.events import OneAtATime
from wsgen.isolation import system
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.source_shares import INSTALLED, may_have_sources, serve_installed, serve_source
from wsgen.packages.workspace.layout import find_packages
from wsgen.packages.workspace.overlay import Overlay, overlay_of
from wsgen.pipeline.parallel import run_parallel
from wsgen.text.files import bytes_or_empty, real_path
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.check import Targets


SIZE_LIMIT = 2**20  # bytes; larger files are data
WORDS = lazy_pattern(rb"[A-Za-z0-9_-]+")
_HOOKS = b"ament_environment_hooks"  # sets what others find files by, without a name
# Of meshes and pictures, which name no package.
_BINARY = frozenset(
    (
        *(".bin", ".bmp", ".dae", ".gif", ".glb", ".jpeg", ".jpg", ".mp4", ".obj", ".pcd", ".pdf"),
        *(".pgm", ".ply", ".png", ".so", ".stl", ".tga", ".tif", ".zip"),
    )
)


def find_reached(checked: Iterable[str], packages: Mapping[str, PackageFolder]) -> frozenset[str]:
    """The names of packages that are checked, that their files name, and so on.

    Those that set the environment of all others are reached, too.

    Args:
        checked: names of packages.
        packages: all packages of the workspaces, by name.
    """
    checked = [*checked]
    if packages.keys() <= set(checked):
        return frozenset(packages)
    names = {name.encode(): name for name in packages}
    reached: set[str] = set()
    waiting = [*checked, *(name for name, one in packages.items() if _sets_environment(one))]
    while waiting:
        name = waiting.pop()
        if name in reached:
            continue
        reached.add(name)
        if len(reached) == len(packages):
            break
        words = {
            word for _, text in texts_below(packages[name].path) for word in WORDS.findall(text)
        }
        waiting += [names[word] for word in words & names.keys()]
    return frozenset(reached)


def _sets_environment(package: PackageFolder) -> bool:
    return _HOOKS in bytes_or_empty(package.path / "CMakeLists.txt", SIZE_LIMIT)


def texts_below(folder: Path) -> Iterator[tuple[Path, bytes]]:
    """The files of a package that may name another one, and what they hold."""
    for here, folders, files in os.walk(folder):
        folders[:] = filter(may_have_sources, folders)
        for name in files:
            if os.path.splitext(name)[1].lower() not in _BINARY:  # noqa: PTH122  of many files
                file = Path(here, name)
                yield file, bytes_or_empty(file, SIZE_LIMIT)


@dataclass(frozen=True, kw_only=True)
class InstalledAsBuilt:
    """The overlay of that install space, and the way back to the sources."""

    overlay: Overlay
    folder: Path  # of the install space, scratch
    shown_as: Path  # the install space that it stands for
    sources: Mapping[str, PackageFolder]  # by name, all packages of the workspaces
    facts: Mapping[str, BuildFacts]  # by name, of packages that the checked ones may look up
    problems: Mapping[str, tuple[Diagnostic, ...]]  # of the build files, by name of the package
    made: frozenset[str] = frozenset()  # paths in `folder` that only a build makes
    # By folder: packages whose name another one has, each with its own files in front.
    copies: Mapping[Path, InstalledAsBuilt] = field(default_factory=dict)

    def of(self, package: PackageFolder) -> InstalledAsBuilt:
        """The install space in which a package finds itself, and not another one of its name."""
        return self.copies.get(package.path, self)

    def is_known(self, package: str) -> bool:
        """Whether all that a package of the workspaces installs is known."""
        facts = self.facts.get(package)
        return facts is not None and facts.is_whole

    def named(self, diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
        """The diagnostics with the files and paths of the user."""
        for found in diagnostics:
            if any(path in found.message for path in self.made):
                continue  # it is there after a build
            file = found.file
            if file is not None and file.is_relative_to(self.folder):
                file = Path(real_path(file))
            yield replace(
                found,
                file=file,
                message=self.text(found.message),
                element=found.element and self.text(found.element),
                hint=found.hint and self.text(found.hint),
            )

    def text(self, text: str) -> str:
        """A text with the user's install space in place of the scratch folder.

        Where a package is not built, its share folder is named by `share/PACKAGE`.
        """
        if str(self.folder) not in text:
            return text
        place = rf"{re.escape(str(self.folder))}(?:/{COPIES}/\d+)?/((?:share|lib)/([\w-]+))"
        return re.sub(place, self._shown, text).replace(str(self.folder), str(self.shown_as))

    def _shown(self, found: re.Match[str]) -> str:
        folder, package = found.groups()
        # colcon gives each package a prefix of its own, unless an option says otherwise.
        prefixes = (self.shown_as / package, self.shown_as)
        built = (prefix / folder for prefix in prefixes if (prefix / folder).is_dir())
        return str(next(built, folder))


def lay_out(
    targets: Targets, scratch: Path, environment: Mapping[str, str], *, jobs: int = 1
) -> InstalledAsBuilt:
    """Lay out the packages of all workspaces, in front of what the environment sources.

    So many jobs do it at a time.
    """
    packages: dict[str, PackageFolder] = {}
    for package in targets.packages:
        packages.setdefault(package.name, package)
    for workspace in targets.workspaces:
        for package in targets.inventories.get(workspace) or find_packages(workspace):
            if not package.diagnostics:
                packages.setdefault(package.name, package)
    # Merged: where each package has a prefix, what looks one up passes over all others.
    folder = Path(os.path.realpath(scratch)) / FOLDER
    if targets.files or targets.installed:
        reached = frozenset(packages)  # what they look up is known when they are evaluated
    else:
        reached = find_reached((one.name for one in targets.packages), packages)
    for name in packages.keys() - reached:
        serve_source(folder, name, packages[name].path)
    read = _install([one for name, one in packages.items() if name in reached], folder, jobs)
    facts = {name: found for name, (found, _) in read.items()}
    variables = _with_paths(environment, (folder, *targets.prefixes), facts.values())
    overlay = overlay_of({**variables, INSTALLED: str(folder)})
    root = targets.workspaces[0].root if targets.workspaces else Path.cwd()
    installed = InstalledAsBuilt(
        overlay=replace(overlay, install=folder, workspaces=tuple(targets.workspaces)),
        folder=folder,
        shown_as=root / "install",
        sources=packages,
        facts=facts,
        problems={name: problems for name, (_, problems) in read.items()},
        made=frozenset(
            f"{folder}/{one.destination}"
            for found in facts.values()
            for one in found.installed
            if one.source is None and one.destination.startswith("share/")
        ),
    )
    copies = [one for one in targets.packages if packages[one.name].path != one.path]
    return replace(
        installed,
        copies={one.path: _with_copy(installed, one, n) for n, one in enumerate(copies)},
    )


def _with_copy(
    installed: InstalledAsBuilt, package: PackageFolder, number: int
) -> InstalledAsBuilt:
    """The install space with another package of a name that a package has there already."""
    prefix = installed.folder / COPIES / str(number)
    facts, problems = _install_package(package, prefix)
    overlay = installed.overlay
    path = os.pathsep.join((str(prefix), overlay.environment["AMENT_PREFIX_PATH"]))
    return replace(
        installed,
        overlay=replace(
            overlay,
            environment={**overlay.environment, "AMENT_PREFIX_PATH": path},
            prefixes=(prefix, *overlay.prefixes),
        ),
        sources={**installed.sources, package.name: package},
        facts={**installed.facts, package.name: facts},
        problems={**installed.problems, package.name: problems},
    )


COPIES = "copies"  # folder of such packages, below the prefix
FOLDER = "install"  # of the install space, in a scratch folder
_Installed = tuple["BuildFacts", "tuple[Diagnostic, ...]"]  # with what is wrong in build files
FEW = 8  # packages; workers for them cost more than they save


def _install(packages: Sequence[PackageFolder], folder: Path, jobs: int) -> dict[str, _Installed]:
    """Read the build files of packages, and lay them out; by name."""
    calls = [partial(_install_package, one, folder) for one in packages]
    ended: list[_Installed] = []
    if jobs > 1 and len(packages) > FEW and system.can_fork():
        run_parallel(lambda _run: calls, jobs, OneAtATime(None), ended, in_workers=True)
    else:
        ended = [call() for call in calls]
    return {package.name: found for package, found in zip(packages, ended, strict=True)}


def _install_package(package: PackageFolder, folder: Path) -> _Installed:
    found, problems = read_build_facts(package.path, package.name, package.build_type)
    serve_installed(
        folder,
        package.name,
        package.path,
        files=((one.destination, one.source) for one in found.installed),
        programs=((one.name, one.source) for one in found.executables),
        modules=_modules(found),
        # The space in which catkin builds has the folder of the source.
        is_whole=found.is_whole and package.build_type != "catkin",
    )
    return found, problems


MODULES = "python"  # folder for the Python modules of all packages, below the prefix


def _modules(facts: BuildFacts) -> Iterator[tuple[str, Path]]:
    for package in facts.python_packages:
        if "." not in package.name:
            yield f"{MODULES}/{package.name}{package.source.suffix}", package.source


def _with_paths(
    environment: Mapping[str, str], prefixes: Sequence[Path], facts: Iterable[BuildFacts]
) -> dict[str, str]:
    """The environment with the prefixes in front, and what setup files would add."""
    folder = prefixes[0]
    paths = {
        "AMENT_PREFIX_PATH": [*map(str, (*prefixes[1:], folder))],
        "PYTHONPATH": [f"{folder}/{MODULES}"],
    }
    for one in facts:
        for variable, path in one.environment:
            paths.setdefault(variable, []).append(f"{folder}/{path}" if path else str(folder))
    return {
        **environment,
        **{
            variable: os.pathsep.join(filter(None, (*added, environment.get(variable, ""))))
            for variable, added in paths.items()
        },
    }

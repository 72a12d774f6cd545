"""The install space that a build would leave, laid out with links to the sources.

Launch files and robots are read from it, so that what no rule installs is missing, as it would be
after `colcon build`; what is reported names the sources.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build_files.facts import read_build_facts
from wsgen.source_shares import INDEX
from wsgen.values import dataclass
from wsgen.workspace.layout import find_packages
from wsgen.workspace.overlay import Overlay, overlay_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.pipeline.check_targets import Targets
    from wsgen.workspace.layout import PackageFolder

OF_BUILDS = frozenset({"__pycache__", "build", "install", "log"})  # folders
PYTHON = Path("lib", "python3", "site-packages")  # below the prefix


@dataclass(frozen=True, kw_only=True)
class InstalledAsBuilt:
    """The overlay of that install space, and the way back to the sources."""

    overlay: Overlay
    folder: Path  # of the install space, scratch
    shown_as: Path  # the install space that it stands for
    sources: Mapping[str, PackageFolder]  # by name, all packages of the workspaces
    facts: Mapping[str, BuildFacts]  # of them, by name
    reported: Mapping[str, tuple[Diagnostic, ...]]  # about their build files, by name

    def named(self, diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
        """The diagnostics with the files and paths of the user."""
        for found in diagnostics:
            file = found.file
            if file is not None and file.is_relative_to(self.folder):
                file = Path(os.path.realpath(file))
                if file.is_relative_to(self.folder):
                    continue  # the build makes it
            yield replace(
                found,
                file=file,
                message=self.text(found.message),
                element=found.element and self.text(found.element),
                hint=found.hint and self.text(found.hint),
            )

    def text(self, text: str) -> str:
        """A text with the user's install space in place of the scratch folder."""
        if str(self.folder) not in text:
            return text
        # colcon gives each package a prefix of its own.
        place = rf"{re.escape(str(self.folder))}/(share|lib)/([\w-]+)"
        return re.sub(place, rf"{self.shown_as}/\2/\1/\2", text).replace(
            str(self.folder), str(self.shown_as)
        )


def lay_out(targets: Targets, scratch: Path, environment: Mapping[str, str]) -> InstalledAsBuilt:
    """Lay out the packages of all workspaces, in front of what the environment sources."""
    packages: dict[str, PackageFolder] = {}
    for package in targets.packages:
        packages.setdefault(package.name, package)
    for workspace in targets.workspaces:
        for package in find_packages(workspace):
            if not package.diagnostics:
                packages.setdefault(package.name, package)
    # Merged: where each package has a prefix, what looks one up passes over all others.
    folder = Path(os.path.realpath(scratch)) / "install"
    (folder / INDEX).mkdir(parents=True)
    facts, reported = {}, {}
    for package in packages.values():
        facts[package.name], reported[package.name] = read_build_facts(
            package.path, package.name, package.build_type
        )
        _lay_out_package(package, facts[package.name], folder)
    variables = {
        **environment,
        "AMENT_PREFIX_PATH": _joined((*targets.prefixes, folder), environment, "AMENT_PREFIX_PATH"),
        "PYTHONPATH": _joined((folder / PYTHON,), environment, "PYTHONPATH"),
    }
    root = targets.workspaces[0].root if targets.workspaces else Path.cwd()
    return InstalledAsBuilt(
        overlay=replace(overlay_of(variables), install=folder),
        folder=folder,
        shown_as=root / "install",
        sources=packages,
        facts=facts,
        reported=reported,
    )


def _joined(places: Iterable[Path], environment: Mapping[str, str], name: str) -> str:
    """A search path with the places before those of the environment."""
    return os.pathsep.join(filter(None, (*map(str, places), environment.get(name, ""))))


def _lay_out_package(package: PackageFolder, facts: BuildFacts, folder: Path) -> None:
    """Link what the package installs; where that is not known, its whole source folder, too."""
    (folder / INDEX / package.name).touch()
    share = folder / "share" / package.name
    share.mkdir(parents=True)
    for file in facts.installed:
        _link(folder / file.destination, file.source)
    for module in facts.python_packages:
        _link(folder / PYTHON / module.source.name, module.source)
    _link(share / "package.xml", package.path / "package.xml")
    for executable in facts.executables:
        _link(folder / "lib" / package.name / executable.name, executable.source)
    if not facts.is_whole:
        _link_below(share, package.path)


def _link(place: Path, source: Path | None) -> None:
    """Link a place to what is installed there; what the build makes is an empty file."""
    if os.path.lexists(place):
        return
    place.parent.mkdir(parents=True, exist_ok=True)
    if source is None:
        place.touch(mode=0o755)
    else:
        place.symlink_to(source, target_is_directory=source.is_dir())


def _link_below(place: Path, source: Path) -> None:
    """Link the files in a folder that are not in the place; hidden ones are not looked up."""
    for folder, names, files in os.walk(source):
        names[:] = [name for name in names if not name.startswith(".") and name not in OF_BUILDS]
        beside = place / os.path.relpath(folder, source)
        for file in files:
            _link(beside / file, Path(folder, file))

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

from wsgen.source_shares import INDEX
from wsgen.values import dataclass
from wsgen.workspace.layout import find_packages
from wsgen.workspace.overlay import Overlay, overlay_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.check_targets import Targets
    from wsgen.workspace.layout import PackageFolder


@dataclass(frozen=True, kw_only=True)
class InstalledAsBuilt:
    """The overlay of that install space, and the way back to the sources."""

    overlay: Overlay
    folder: Path  # of the install space, scratch
    shown_as: Path  # the install space that it stands for
    sources: Mapping[str, PackageFolder]  # by name, all packages of the workspaces

    def named(self, diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
        """The diagnostics with the files and paths of the user."""
        for found in diagnostics:
            file = found.file
            if file is not None and file.is_relative_to(self.folder):
                file = Path(os.path.realpath(file))
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
    for package in packages.values():
        (folder / INDEX / package.name).touch()
        (folder / "share" / package.name).symlink_to(package.path, target_is_directory=True)
    path = os.pathsep.join(map(str, (*targets.prefixes, folder)))
    before = environment.get("AMENT_PREFIX_PATH", "")
    overlay = overlay_of(
        {**environment, "AMENT_PREFIX_PATH": os.pathsep.join(filter(None, (path, before)))}
    )
    root = targets.workspaces[0].root if targets.workspaces else Path.cwd()
    return InstalledAsBuilt(
        overlay=replace(overlay, install=folder),
        folder=folder,
        shown_as=root / "install",
        sources=packages,
    )

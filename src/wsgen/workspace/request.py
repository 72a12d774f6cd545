"""Whether what is asked for can be built at all, before colcon is started."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from wsgen.errors import NotFoundError, RequestError
from wsgen.suggestions import suggest
from wsgen.workspace.arguments import discovers_elsewhere
from wsgen.workspace.layout import IGNORE_MARKERS, crawl, read_package
from wsgen.workspace.opening import refuse_missing_manifest

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.workspace.layout import Inventory, PackageFolder, Workspace


def choose_packages(
    workspace: Workspace,
    inventory: Inventory,
    names: Sequence[str],
    colcon_arguments: Sequence[str],
) -> tuple[PackageFolder, ...]:
    """Return the ROS packages that are asked for by name; all where no name is given.

    Raises:
        RequestError: a name is that of no package, or of one that colcon is told to ignore.
        NotFoundError: there is no package at all.
    """
    if discovers_elsewhere(colcon_arguments):
        return inventory.packages  # colcon knows better
    if not inventory.packages and not inventory.others:
        refuse_empty(workspace)
    known = {package.name: package for package in inventory.packages}
    for name in names:
        # A package without package.xml may have any name; colcon will say.
        if name not in known and not inventory.others:
            raise unknown_package(workspace, inventory, name)
    return tuple(package for package in inventory.packages if not names or package.name in names)


def unknown_package(workspace: Workspace, inventory: Inventory, name: str) -> RequestError:
    """Make the error for a name that colcon finds no package of."""
    for folder, marker in _ignored_packages(workspace):
        package = read_package(folder)
        if package is not None and package.name == name:
            return RequestError(
                f"The package {name} in {folder} is ignored: {marker} says so.",
                hint=f"Remove {marker} to build the package.",
            )
    return RequestError(
        f"There is no package {name} in {workspace.root}.",
        hint=suggest(name, {package.name for package in inventory.packages}),
    )


def refuse_empty(workspace: Workspace) -> NoReturn:
    """Stop in a workspace without packages, and say why it has none.

    Raises:
        NotFoundError: always.
    """
    ignored = next(_ignored_packages(workspace), None)
    if ignored is not None:
        folder, marker = ignored
        raise NotFoundError(
            f"There is nothing to build in {workspace.root}: {folder} is ignored.",
            hint=f"{marker} says so; remove it to build the package.",
        )
    refuse_missing_manifest([workspace.root])
    raise NotFoundError(
        f"There is no package in {workspace.root}.",
        hint="Make one with: wsgen new PACKAGE",
    )


def _ignored_packages(workspace: Workspace) -> Iterator[tuple[Path, Path]]:
    """Yield the packages that colcon leaves out, each with the file that makes it do so."""
    for folder, names in crawl(workspace.source, with_ignored=True):
        if "package.xml" not in names:
            continue
        for parent in (folder, *folder.parents):
            for marker in IGNORE_MARKERS:
                if (parent / marker).exists():
                    yield folder, parent / marker
            if parent == workspace.source:
                break

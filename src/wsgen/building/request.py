"""Check a request before colcon starts, and make the command line and variables for colcon."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.layout import (
    ignored_package,
    ignored_packages,
    refuse_missing_manifest,
)
from wsgen.text.suggestions import suggest

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from wsgen.packages.workspace.layout import Inventory, PackageFolder, Workspace


EVENT_HANDLERS = "colcon_core.event_handler"
SILENCED = ("console_start_end", "console_stderr", "summary")  # our events replace them
DISCOVERY_OPTIONS = ("--base-paths", "--paths", "--metas")
SELECTION_OPTION = "--packages-"
OUTPUT_OPTION = "--event-handlers"

# These take a quarter of colcon's own time; without a Python package in the workspace they do
# nothing, and a build does not run tests.
PYTHON_EXTENSIONS = (
    "colcon_core.package_identification.python_setup_py",
    "colcon_core.package_augmentation.python_setup_py",
    "colcon_core.package_augmentation.python",
    "colcon_core.package_augmentation.ros_ament_python",
    "colcon_core.verb.test",
)
BLOCKLIST = "COLCON_EXTENSION_BLOCKLIST"
TOOLCHAIN_EXTENSION = "colcon_core.argument_parser.wsgen"


def build_arguments(
    packages: Sequence[str],
    colcon_arguments: Sequence[str],
    *,
    cmake_arguments: Sequence[str] = (),
    blocked: Collection[str] = (),
) -> list[str]:
    """Make the command line.

    Packages are built with their dependencies in the workspace. Of a repeated option colcon takes
    the last, so no option of the user is repeated. `cmake_arguments` are for CMake, of packages
    for ament_cmake. `blocked` are the extensions that the user has
    blocked; colcon refuses options for them.
    """
    arguments = ["build", *colcon_arguments]
    if cmake_arguments:
        # Not --cmake-args: this option adds to them, also to those of a colcon_defaults.yaml.
        option = "--ament-cmake-args"
        position = arguments.index(option) + 1 if option in arguments else None
        if position is None:
            arguments += [option, *cmake_arguments]
        else:
            arguments[position:position] = cmake_arguments
    if packages:
        arguments += ["--packages-up-to", *packages]
    silenced = [name for name in SILENCED if f"{EVENT_HANDLERS}.{name}" not in blocked]
    if silenced and EVENT_HANDLERS not in blocked and not _uses(colcon_arguments, OUTPUT_OPTION):
        arguments += [OUTPUT_OPTION, *(f"{name}-" for name in silenced)]
    return arguments


def discovers_elsewhere(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments make colcon search packages outside the workspace's folders."""
    return _uses(colcon_arguments, *DISCOVERY_OPTIONS)


def selects_packages(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments select packages."""
    return _uses(colcon_arguments, SELECTION_OPTION)


def blocked_extensions(environment: Mapping[str, str]) -> list[str]:
    """List the extensions of colcon, and groups of them, that the user has blocked."""
    return [entry for entry in environment.get(BLOCKLIST, "").split(os.pathsep) if entry]


def block_extensions(
    environment: dict[str, str],
    *,
    workspace: Workspace,
    inventory: Inventory,
    colcon_arguments: Sequence[str],
) -> None:
    """Block extensions that colcon does not need: our own, whose work is done.

    Also, in a workspace without Python packages, those for Python; but not if colcon may search
    further than the inventory, because of its arguments or a file of default arguments.
    """
    blocked = [*blocked_extensions(environment), TOOLCHAIN_EXTENSION]
    if not (
        inventory.has_python
        or discovers_elsewhere(colcon_arguments)
        or any(file.exists() for file in _defaults_files(workspace, environment))
    ):
        blocked += PYTHON_EXTENSIONS
    environment[BLOCKLIST] = os.pathsep.join(dict.fromkeys(blocked))


def _defaults_files(workspace: Workspace, environment: Mapping[str, str]) -> tuple[Path, ...]:
    home = Path(environment.get("COLCON_HOME") or Path("~/.colcon").expanduser())
    return (
        workspace.root / "colcon_defaults.yaml",
        Path(environment.get("COLCON_DEFAULTS_FILE") or home / "defaults.yaml"),
    )


def _uses(arguments: Sequence[str], *options: str) -> bool:
    return any(argument.startswith(options) for argument in arguments)


def choose_packages(
    workspace: Workspace,
    inventory: Inventory,
    names: Sequence[str],
    colcon_arguments: Sequence[str],
) -> tuple[PackageFolder, ...]:
    """Return the ROS packages with these names; all if no name is given.

    Raises:
        RequestError: a package is unknown or ignored.
        NotFoundError: the workspace has no package.
    """
    if discovers_elsewhere(colcon_arguments):
        return inventory.packages  # colcon searches elsewhere, too
    if not inventory.packages and not inventory.others:
        refuse_empty(workspace)
    known = {package.name: package for package in inventory.packages}
    for name in names:
        # A package without package.xml may have any name; colcon knows it.
        if name not in known and not inventory.others:
            raise unknown_package(workspace, inventory, name)
    return tuple(package for package in inventory.packages if not names or package.name in names)


def unknown_package(workspace: Workspace, inventory: Inventory, name: str) -> RequestError:
    """Make the error for the name of a package that colcon does not find."""
    ignored = ignored_package(workspace, name)
    if ignored is not None:
        return ignored
    hint = suggest(name, {package.name for package in inventory.packages})
    if os.path.isdir(name):  # noqa: PTH112  a name may hold what no path can
        hint = f"Select packages by name, not by folder; without a name, all are built. {hint}"
    return RequestError(f"{workspace.root} has no package {name}.", hint=hint)


def refuse_empty(workspace: Workspace) -> NoReturn:
    """Stop in a workspace without packages, and explain why it has none.

    Raises:
        NotFoundError: always.
    """
    ignored = next(ignored_packages(workspace), None)
    if ignored is not None:
        folder, marker = ignored
        raise NotFoundError(
            f"{workspace.root} has no package to build: colcon ignores {folder}.",
            hint=f"Remove {marker} to build the package.",
        )
    refuse_missing_manifest([workspace.root])
    raise NotFoundError(
        f"{workspace.root} has no package.",
        hint="Create one: wsgen new PACKAGE",
    )

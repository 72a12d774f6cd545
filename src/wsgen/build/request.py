"""Whether what is asked for can be built at all, before colcon is started.

The command line and the variables with which colcon is run.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from wsgen.build.sources import WITHOUT_TESTS
from wsgen.errors import NotFoundError, RequestError
from wsgen.suggestions import suggest
from wsgen.workspace.layout import IGNORE_MARKERS, crawl, read_package, refuse_missing_manifest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from wsgen.workspace.layout import Inventory, PackageFolder, Workspace


EVENT_HANDLERS = "colcon_core.event_handler"
SILENCED = ("console_start_end", "console_stderr", "summary")  # our events say it already
DISCOVERY_OPTIONS = ("--base-paths", "--paths", "--metas")
SELECTION_OPTION = "--packages-"
OUTPUT_OPTION = "--event-handlers"

# A quarter of colcon's own time goes into these, and without a Python package in the workspace
# they do nothing; the tests of packages have no part in a build.
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
    without_tests: bool,
    blocked: Collection[str] = (),
) -> list[str]:
    """Put the command line together.

    Packages come with the packages of the workspace that they depend on. Of an option that is
    given twice colcon takes the last, so nothing of the user's is repeated. `blocked` are the
    extensions that the user has blocked, which colcon would not let itself be told about.
    """
    arguments = ["build", *colcon_arguments]
    if without_tests:
        # Not --cmake-args: this option adds to those, also where a colcon_defaults.yaml gives
        # them.
        option = "--ament-cmake-args"
        position = arguments.index(option) + 1 if option in arguments else None
        if position is None:
            arguments += [option, WITHOUT_TESTS]
        else:
            arguments.insert(position, WITHOUT_TESTS)
    if packages:
        arguments += ["--packages-up-to", *packages]
    silenced = [name for name in SILENCED if f"{EVENT_HANDLERS}.{name}" not in blocked]
    if silenced and EVENT_HANDLERS not in blocked and not _uses(colcon_arguments, OUTPUT_OPTION):
        arguments += [OUTPUT_OPTION, *(f"{name}-" for name in silenced)]
    return arguments


def discovers_elsewhere(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments let colcon look for packages outside the workspace's folders."""
    return _uses(colcon_arguments, *DISCOVERY_OPTIONS)


def selects_packages(colcon_arguments: Sequence[str]) -> bool:
    """Whether the arguments choose among the packages."""
    return _uses(colcon_arguments, SELECTION_OPTION)


def blocked_extensions(environment: Mapping[str, str]) -> list[str]:
    """List the extensions of colcon, and groups of them, that are not to be used."""
    return [entry for entry in environment.get(BLOCKLIST, "").split(os.pathsep) if entry]


def block_extensions(
    environment: dict[str, str],
    *,
    workspace: Workspace,
    inventory: Inventory,
    colcon_arguments: Sequence[str],
) -> None:
    """Let colcon leave out what it has no use for: our own extension, whose work is done.

    And, in a workspace without Python packages, what is there for those; but not where colcon
    looks further than the inventory did, be it by its arguments or by a file of default arguments.
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

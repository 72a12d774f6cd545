"""The command line and the variables with which colcon is run."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.workspace.lint_packages import WITHOUT_TESTS

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from wsgen.workspace.layout import Inventory, Workspace

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

"""Evaluate a launch file in this process; only ever called in a child process.

The launch file is a program and is run as one. The recording modules stand in the place of the
real `launch`, `launch_ros` and `ament_index_python`, so that it starts nothing.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any

from wsgen.launch import known_packages
from wsgen.launch.missing_modules import AbsentModules
from wsgen.launch.record import RECORD, ForkError, caller

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.launch.record import CommandRunner


if TYPE_CHECKING:
    FaultFinder = Callable[[BaseException], "dict[str, Any] | None"]

_SHIM = os.path.join(os.path.dirname(os.path.dirname(__file__)), "launch_shim")
_ROS_PACKAGES = os.path.join(os.path.dirname(__file__), "ros_packages")
_DESCRIPTIONS = (".urdf", ".xacro", ".sdf", ".xml")
_STOOD_IN = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python")


def evaluate(  # noqa: PLR0913  what only the parent knows
    launch_file: str,
    package: str | None,
    arguments: Mapping[str, str],
    *,
    run_xacro: CommandRunner,
    find_xacro_fault: FaultFinder,
    only_arguments: bool = False,
) -> dict[str, Any]:
    """What the launch file would start, as JSON; what is wrong with it is part of that.

    With `only_arguments` it is loaded and asked for its arguments, as `ros2 launch --show-args`
    does, and not played: their defaults are told in words. `run_xacro` gives the outcome of a
    command line that begins with `xacro`; `find_xacro_fault` says whether an exception is xacro's,
    and what it is about.
    """
    RECORD.package = package
    RECORD.run_xacro = run_xacro
    _install()
    RECORD.environment = dict(os.environ)
    sys.addaudithook(_watch)
    try:
        if only_arguments:
            _ask_for_arguments(launch_file)
        else:
            _play(launch_file, arguments)
            _report_unused_arguments(launch_file, arguments)
    except BaseException as error:  # noqa: BLE001  foreign code
        from wsgen.launch.explain import explain

        RECORD.diagnostics.append(explain(error, launch_file, find_xacro_fault(error)))
    RECORD.find_description_files()
    return {
        "arguments": list(RECORD.arguments.values()),
        "processes": RECORD.processes,
        "includes": RECORD.includes,
        "environment": RECORD.changed_environment(),
        "unresolved": RECORD.unresolved,
        "diagnostics": RECORD.diagnostics,
    }


def _install() -> None:
    """Put the recording modules before all others, here and in what the launch file starts."""
    for name in [name for name in sys.modules if name.partition(".")[0] in _STOOD_IN]:
        del sys.modules[name]
    sys.path.insert(0, _SHIM)
    sys.path.append(_ROS_PACKAGES)
    sys.meta_path.append(AbsentModules(_is_declared))
    inherited = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([inherited, _SHIM] if inherited else [_SHIM])
    # Where wsgen is installed there is an xacro, for launch files that start it themselves.
    beside = os.path.dirname(sys.executable)
    os.environ["PATH"] = os.pathsep.join([os.environ.get("PATH", os.defpath), beside])
    from ament_index_python import packages

    packages.stand_in_prefix = _stand_in_prefix


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    """Remember the descriptions that the launch file reads without xacro; let it not fork.

    Two processes would evaluate it, and which of them answered would be chance. What `subprocess`
    starts is none of this.
    """
    if event in ("os.fork", "os.forkpty"):
        raise ForkError
    if event == "open" and str(arguments[0]).endswith(_DESCRIPTIONS):
        RECORD.opened.append(os.path.abspath(str(arguments[0])))


def _stand_in_prefix(package: str) -> str | None:
    """The prefix to name for a package that is not here: a known one, or one that is declared."""
    if not known_packages.is_known(package) and _is_declared(package):
        known_packages.declare(package)
        RECORD.note_unresolved(
            package, "the package is declared in package.xml and not installed here", caller()
        )
    return known_packages.stand_in_prefix(package)


def _is_declared(package: str) -> bool:
    """Whether the package whose launch file this is says that it needs another one."""
    if RECORD.package is None:
        return False
    from wsgen.launch.manifest import declares

    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return declares(prefixes, RECORD.package, package)


def _ask_for_arguments(launch_file: str) -> None:
    from launch.launch_context import LaunchContext
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    description = AnyLaunchDescriptionSource(launch_file).get_launch_description(LaunchContext())
    for argument in description.get_launch_arguments():
        default = argument.default_value
        RECORD.arguments[argument.name] = {
            "name": argument.name,
            "default": None
            if default is None
            else " + ".join(substitution.describe() for substitution in default),
            "value": None,
            "description": argument.description,
            "is_conditional": argument.conditionally_included,
        }


def _report_unused_arguments(launch_file: str, arguments: Mapping[str, str]) -> None:
    """Warn of launch arguments that have no effect; a real launch does not mention them."""
    use = RECORD.argument_use
    given = [name for name in arguments if use.is_unused(name)]
    of_includes = [entry for entry in use.given if use.is_unused(entry[0])]
    if given or of_includes:
        from wsgen.launch.explain_missing import report_unused_arguments

        report_unused_arguments(launch_file, given, of_includes)


def _play(launch_file: str, arguments: Mapping[str, str]) -> None:
    """What `ros2 launch` does with a launch file and arguments."""
    from launch.actions import IncludeLaunchDescription
    from launch.launch_context import LaunchContext
    from launch.launch_description import play
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    source = AnyLaunchDescriptionSource(launch_file)
    root = IncludeLaunchDescription(source, launch_arguments=tuple(arguments.items()))
    play(root, LaunchContext(argv=[f"{name}:={value}" for name, value in arguments.items()]))

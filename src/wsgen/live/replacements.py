"""Which program stands in the place of which one of ROS and Gazebo, and what cannot run here.

The packages and their programs are those of gazebo_ros_pkgs, ros_gz, robot_state_publisher,
joint_state_publisher, geometry2 and ros2_control.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotFoundError
from wsgen.ros.environment.processes import module_command
from wsgen.text.suggestions import advice, suggest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.ros.environment import RosEnvironment


NODES = "wsgen.live.nodes"
SIMULATOR = f"{NODES}.simulator"
SPAWNERS = (f"{NODES}.create", f"{NODES}.controller_spawner")  # they bring something, and end
GZ_COMMANDS = ("gz", "ign")
GZ_SERVERS = ("sim", "gazebo")  # `gz sim`, `ign gazebo`
GZ_RUN = frozenset(("-r", "--run"))
CLASSIC_PAUSE = frozenset(("-u", "--pause"))


@dataclass(frozen=True, kw_only=True)
class BuiltIn:
    """A program of wsgen."""

    module: str
    arguments: tuple[str, ...] = ()  # before those of the launch file
    keeps_arguments: bool = True
    with_sourced_ros: bool = False  # also where the real one is there: it would ask for Gazebo
    note: str = ""  # what is different from the real one, which is reported


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """A program that does not run here."""

    why: str
    with_sourced_ros: bool = False  # likewise
    is_missed: bool = True  # what it does is not done in another way
    is_mistake: bool = False  # of the user, with which ros2 launch would not begin either


Replacement = BuiltIn | LeftOut

_GAZEBO = BuiltIn(module=SIMULATOR, keeps_arguments=False, with_sourced_ros=True)
_GAZEBO_PAUSED = replace(_GAZEBO, arguments=("--paused",))
_GAZEBO_THAT_WAITS = replace(_GAZEBO, arguments=("--waits-for-play",))
_BRIDGE = BuiltIn(module=f"{NODES}.bridge", with_sourced_ros=True)
_IMAGE_BRIDGE = BuiltIn(module=f"{NODES}.bridge", arguments=("--images",), with_sourced_ros=True)
_WINDOW = LeftOut(
    why="wsgen simulates in the place of Gazebo and shows no window of it",
    with_sourced_ros=True,
    is_missed=False,
)
_SPAWNER = BuiltIn(module=f"{NODES}.controller_spawner", with_sourced_ros=True)
_STATIC = BuiltIn(module=f"{NODES}.static_transform_publisher")
_DRAWS = "it draws with libraries that PyPI does not have; with ROS 2 installed and sourced it runs"


def _create(program: str) -> BuiltIn:
    return BuiltIn(module=f"{NODES}.create", arguments=("--as", program), with_sourced_ros=True)


# (package, executable) -> what stands in its place.
PROGRAMS: dict[tuple[str, str], Replacement] = {
    ("gazebo_ros", "spawn_entity.py"): _create("spawn_entity.py"),
    ("gazebo_ros", "gzserver"): _GAZEBO,
    ("ros_gz_sim", "create"): _create("create"),
    ("ros_ign_gazebo", "create"): _create("create"),
    ("ros_gz_sim", "gzserver"): _GAZEBO,
    ("ros_gz_bridge", "parameter_bridge"): _BRIDGE,
    ("ros_gz_bridge", "bridge_node"): _BRIDGE,
    ("ros_ign_bridge", "parameter_bridge"): _BRIDGE,
    ("ros_gz_image", "image_bridge"): _IMAGE_BRIDGE,
    ("ros_ign_image", "image_bridge"): _IMAGE_BRIDGE,
    ("robot_state_publisher", "robot_state_publisher"): BuiltIn(
        module=f"{NODES}.robot_state_publisher"
    ),
    ("joint_state_publisher", "joint_state_publisher"): BuiltIn(
        module=f"{NODES}.joint_state_publisher"
    ),
    ("joint_state_publisher_gui", "joint_state_publisher_gui"): BuiltIn(
        module=f"{NODES}.joint_state_publisher",
        note="joint_state_publisher runs in its place, without a window of sliders; "
        "`wsgen view PACKAGE` moves joints in the browser",
    ),
    ("tf2_ros", "static_transform_publisher"): _STATIC,
    ("controller_manager", "spawner"): _SPAWNER,
    ("controller_manager", "spawner.py"): _SPAWNER,
    ("controller_manager", "unspawner"): BuiltIn(
        module=f"{NODES}.controller_spawner", arguments=("--unspawn",), with_sourced_ros=True
    ),
    ("controller_manager", "ros2_control_node"): LeftOut(
        why="the controller manager runs in the simulator, by the plugin of the robot",
        with_sourced_ros=True,
        is_missed=False,
    ),
    ("rviz2", "rviz2"): LeftOut(why=_DRAWS),
    ("rqt_gui", "rqt_gui"): LeftOut(why=_DRAWS),
}

# Programs that a command line starts by their name -> what stands in their place.
COMMANDS: dict[str, Replacement] = {
    "gzserver": _GAZEBO,
    "gazebo": _GAZEBO,
    "gzclient": _WINDOW,
    "rviz2": LeftOut(why=_DRAWS),
    "rqt": LeftOut(why=_DRAWS),
}

_CONTAINER = LeftOut(
    why="containers load C++ nodes, which PyPI does not have; with ROS 2 installed and sourced "
    "it runs",
    is_missed=False,  # what it would load is named, or started alone
)
for _name in ("component_container", "component_container_mt", "component_container_isolated"):
    PROGRAMS["rclcpp_components", _name] = _CONTAINER

# Plugins that a container loads -> the program that does the same alone: package and executable.
PLUGINS: dict[str, tuple[str, str]] = {
    "ros_gz_sim::GzServer": ("ros_gz_sim", "gzserver"),
    "ros_gz_bridge::RosGzBridge": ("ros_gz_bridge", "bridge_node"),
    "robot_state_publisher::RobotStatePublisher": (
        "robot_state_publisher",
        "robot_state_publisher",
    ),
    "tf2_ros::StaticTransformBroadcasterNode": ("tf2_ros", "static_transform_publisher"),
}

_COMPONENT = LeftOut(
    why="it is a C++ node for a container, which PyPI does not have; with ROS 2 installed and "
    "sourced it runs"
)


def find_component(plugin: str, *, is_sourced: bool) -> tuple[str, str] | LeftOut | None:
    """The program, by its package, that stands in the place of a node for a container.

    None where the container of a ROS that is sourced loads the node itself.
    """
    alone = PLUGINS.get(plugin)
    if is_sourced:
        replaced = alone and PROGRAMS.get(alone)
        return alone if replaced and replaced.with_sourced_ros else None
    return alone or _COMPONENT


# What `ros2 COMMAND` is here.
ROS2_COMMANDS = frozenset(("topic", "node"))


class Replaced(NamedTuple):
    """What stands in the place of a program, with the arguments that it gets."""

    replacement: Replacement
    arguments: tuple[str, ...]


def find_replacement(
    package: str | None, program: str, arguments: tuple[str, ...], *, is_sourced: bool
) -> Replaced | None:
    """What stands in the place of a program; None where the program itself runs.

    Args:
        package: That it belongs to; None: it is started by its name alone.
        program: Its name.
        arguments: Its arguments.
        is_sourced: Whether a ROS is there whose own programs run.
    """
    if package is not None:
        replacement = PROGRAMS.get((package, program))
    elif program in GZ_COMMANDS:
        replacement, arguments = _gz(arguments)
    elif program == "ros2":
        replacement, arguments = _ros2(arguments)
    else:
        replacement = COMMANDS.get(program)
        if replacement is _GAZEBO and CLASSIC_PAUSE.intersection(arguments):
            replacement = _GAZEBO_PAUSED
    if replacement is None or (is_sourced and not replacement.with_sourced_ros):
        return None
    return Replaced(replacement=replacement, arguments=arguments)


def _gz(arguments: tuple[str, ...]) -> tuple[Replacement, tuple[str, ...]]:
    words = [part for word in arguments for part in word.split()]
    if words[:1] and words[0] in GZ_SERVERS:
        if "-g" in words:
            return _WINDOW, arguments
        return (_GAZEBO if GZ_RUN.intersection(words) else _GAZEBO_THAT_WAITS), arguments
    why = "wsgen simulates in the place of Gazebo, and has none of its other commands"
    return LeftOut(why=why, with_sourced_ros=True), arguments


def _ros2(arguments: tuple[str, ...]) -> tuple[Replacement, tuple[str, ...]]:
    command = arguments[0] if arguments else ""
    if command == "control":
        found = _ros2_control(arguments[1:])
        if found is not None:
            return found
    if command in ROS2_COMMANDS:
        return BuiltIn(module="wsgen"), arguments
    why = f"ros2 {command} is not installed; with ROS 2 installed and sourced it runs"
    return LeftOut(why=why), arguments


_STATE = "--set-state"


def _ros2_control(words: tuple[str, ...]) -> tuple[Replacement, tuple[str, ...]] | None:
    """What `ros2 control load_controller [--set-state active] NAME` is."""
    if words[:1] != ("load_controller",):
        return None
    state, given = "", []
    rest = list(words[1:])
    while rest:
        word = rest.pop(0)
        if word == _STATE and rest:
            state = rest.pop(0)
        elif word.startswith(f"{_STATE}="):
            state = word.partition("=")[2]
        else:
            given.append(word)
    options = {"": ["--load-only"], "inactive": ["--inactive"], "configure": ["--inactive"]}
    return _SPAWNER, (*given, *options.get(state, []))


PYTHON = b"python"
BUILD = "Build the workspace (wsgen build), and name the one that has it with --workspace."


def find_command(
    package: str,
    executable: str,
    arguments: tuple[str, ...],
    *,
    ros: RosEnvironment,
    variables: Mapping[str, str],
) -> tuple[str, ...]:
    """The command line of a program.

    Args:
        package: That it belongs to.
        executable: Its name in `lib/PACKAGE`.
        arguments: Its arguments.
        ros: What it runs with.
        variables: Its environment.

    Raises:
        NotFoundError: No package has it, or it cannot run here.
    """
    replaced = find_replacement(package, executable, arguments, is_sourced=ros.is_sourced)
    if replaced is not None:
        program = replaced.replacement
        if isinstance(program, LeftOut):
            raise NotFoundError(
                f"{executable} of {package} does not run here: {program.why}.",
                hint="Source a ROS that has it, or do without it.",
            )
        return module_command(ros.python, program.module, *program.arguments, *replaced.arguments)
    folders = [folder / package for folder in _libraries(variables)]
    for folder in folders:
        path = folder / executable
        if path.is_file() and os.access(path, os.X_OK):
            command = (str(path), *arguments)
            return command if ros.is_sourced or not is_python(path) else (str(ros.python), *command)
    known = sorted({one for folder in folders for one in executables(folder)})
    if known:
        raise NotFoundError(
            f"The package {package} has no program `{executable}`.",
            hint=suggest(executable, known),
        )
    packages = {one.name for folder in _libraries(variables) for one in _folders(folder)}
    raise NotFoundError(
        f"No package {package} with programs is installed.", hint=advice(package, packages, BUILD)
    )


def executables(folder: Path) -> Iterator[str]:
    """The programs of a package, of its folder in `lib`."""
    if folder.is_dir():
        for one in folder.iterdir():
            if one.is_file() and os.access(one, os.X_OK):
                yield one.name


def _libraries(variables: Mapping[str, str]) -> list[Path]:
    prefixes = variables.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(prefix, "lib") for prefix in prefixes if prefix]


def _folders(folder: Path) -> Iterator[Path]:
    for one in folder.iterdir() if folder.is_dir() else ():
        if any(executables(one)):
            yield one


def is_python(path: Path) -> bool:
    """Whether the first line of a program names Python as its interpreter."""
    with path.open("rb") as file:
        first = file.readline(200)
    return first.startswith(b"#!") and PYTHON in first

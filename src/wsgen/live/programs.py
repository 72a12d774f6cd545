"""Which program stands in the place of which one of ROS and Gazebo, and what cannot run here.

The packages and their programs are those of gazebo_ros_pkgs, ros_gz, robot_state_publisher,
joint_state_publisher, geometry2 and ros2_control.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from wsgen.values import dataclass

NODES = "wsgen.ros_nodes"
SIMULATOR = f"{NODES}.simulator"
GZ_COMMANDS = ("gz", "ign")
GZ_SERVERS = ("sim", "gazebo")  # `gz sim`, `ign gazebo`
GZ_RUN = frozenset(("-r", "--run"))
CLASSIC_PAUSE = frozenset(("-u", "--pause"))


@dataclass(frozen=True, kw_only=True)
class Ours:
    """A program of wsgen."""

    module: str
    arguments: tuple[str, ...] = ()  # before those of the launch file
    keeps_arguments: bool = True
    with_sourced_ros: bool = False  # also where the real one is there: it would ask for Gazebo


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """A program that does not run here."""

    why: str
    with_sourced_ros: bool = False  # likewise
    is_missed: bool = True  # what it does is not done in another way


Stand = Ours | LeftOut

_GAZEBO = Ours(module=SIMULATOR, keeps_arguments=False, with_sourced_ros=True)
_GAZEBO_PAUSED = replace(_GAZEBO, arguments=("--paused",))
_GAZEBO_THAT_WAITS = replace(_GAZEBO, arguments=("--waits-for-play",))
_BRIDGE = Ours(module=f"{NODES}.bridge", with_sourced_ros=True)
_IMAGE_BRIDGE = Ours(module=f"{NODES}.bridge", arguments=("--images",), with_sourced_ros=True)
_WINDOW = LeftOut(
    why="wsgen simulates in the place of Gazebo and shows no window of it",
    with_sourced_ros=True,
    is_missed=False,
)
_SPAWNER = Ours(module=f"{NODES}.controller_spawner", with_sourced_ros=True)
_STATIC = Ours(module=f"{NODES}.static_transform_publisher")
_NOT_ON_PYPI = "it is C++ that PyPI does not have; with ROS 2 installed and sourced it runs"
_DRAWS = "it draws with libraries that PyPI does not have; with ROS 2 installed and sourced it runs"


def _create(program: str) -> Ours:
    return Ours(module=f"{NODES}.create", arguments=("--as", program), with_sourced_ros=True)


# (package, executable) -> what stands in its place.
PROGRAMS: dict[tuple[str, str], Stand] = {
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
    ("robot_state_publisher", "robot_state_publisher"): Ours(
        module=f"{NODES}.robot_state_publisher"
    ),
    ("joint_state_publisher", "joint_state_publisher"): Ours(
        module=f"{NODES}.joint_state_publisher"
    ),
    ("joint_state_publisher_gui", "joint_state_publisher_gui"): LeftOut(
        why="it is a window with sliders; `wsgen view PACKAGE` moves joints in the browser"
    ),
    ("tf2_ros", "static_transform_publisher"): _STATIC,
    ("controller_manager", "spawner"): _SPAWNER,
    ("controller_manager", "spawner.py"): _SPAWNER,
    ("controller_manager", "unspawner"): Ours(
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
COMMANDS: dict[str, Stand] = {
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

# What `ros2 COMMAND` is here.
ROS2_COMMANDS = frozenset(("topic", "node"))


class Replaced(NamedTuple):
    """What stands in the place of a program, with the arguments that it gets."""

    stand: Stand
    arguments: tuple[str, ...]


def find_stand(
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
        stand = PROGRAMS.get((package, program))
    elif program in GZ_COMMANDS:
        stand, arguments = _gz(arguments)
    elif program == "ros2":
        stand, arguments = _ros2(arguments)
    else:
        stand = COMMANDS.get(program)
        if stand is _GAZEBO and CLASSIC_PAUSE.intersection(arguments):
            stand = _GAZEBO_PAUSED
    if stand is None or (is_sourced and not stand.with_sourced_ros):
        return None
    return Replaced(stand=stand, arguments=arguments)


def _gz(arguments: tuple[str, ...]) -> tuple[Stand, tuple[str, ...]]:
    words = [part for word in arguments for part in word.split()]
    if words[:1] and words[0] in GZ_SERVERS:
        if "-g" in words:
            return _WINDOW, arguments
        return (_GAZEBO if GZ_RUN.intersection(words) else _GAZEBO_THAT_WAITS), arguments
    why = "wsgen simulates in the place of Gazebo, and has none of its other commands"
    return LeftOut(why=why, with_sourced_ros=True), arguments


def _ros2(arguments: tuple[str, ...]) -> tuple[Stand, tuple[str, ...]]:
    command = arguments[0] if arguments else ""
    if command == "control":
        found = _ros2_control(arguments[1:])
        if found is not None:
            return found
    if command in ROS2_COMMANDS:
        return Ours(module="wsgen"), arguments
    why = f"ros2 {command} is not installed; with ROS 2 installed and sourced it runs"
    return LeftOut(why=why), arguments


_STATE = "--set-state"


def _ros2_control(words: tuple[str, ...]) -> tuple[Stand, tuple[str, ...]] | None:
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

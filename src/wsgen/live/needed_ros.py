"""Which ROS the nodes of a live run need: its distribution, and packages of messages.

ROS_DISTRO is the distribution that they were written for, not that of the wheels: nodes and launch
files choose message types by it. Those of the TurtleBot3 publish a Twist on Humble and a
TwistStamped on any other, as the plugins of their robot read them there. Messages are those of the
workspace, its robots and its bridges.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.manifests import target_of
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.sensors import SENSORS
from wsgen.launching import commands
from wsgen.launching.spawner_options import CONTROLLER_SPAWNERS
from wsgen.model.facts import DISTROS
from wsgen.model.target import DISTROS_WITH_CLASSIC, Target
from wsgen.pipeline.installed_as_built import WORDS, texts_below

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from wsgen.model.devices import Devices
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.manifest import Manifest
    from wsgen.ros.environment import RosEnvironment


VARIABLE = "ROS_DISTRO"


def distro_of_nodes(  # noqa: PLR0913  all that says it
    manifest: Manifest | None,
    *,
    simulator: str | None,
    installed: str,
    set_by_user: str | None = None,
    recorded: str | None = None,
    workspace: Collection[str] = (),
) -> str:
    """The distribution that nodes see.

    Args:
        manifest: Of the package that is launched; None where it has none.
        simulator: What the launch file starts, a key of `SIMULATORS`.
        installed: The distribution of the ROS that runs; the answer where it is a possible one.
        set_by_user: ROS_DISTRO of the shell.
        recorded: What wsgen.toml says.
        workspace: The names of all packages of the workspace.
    """
    target = target_of(manifest, recorded=recorded, sourced=set_by_user, workspace=workspace)
    if set_by_user or target.distro is not None:
        return set_by_user or target.distros[0]
    possible = [one for one in target.distros if one in DISTROS]
    if simulator == "classic":
        possible = [one for one in possible if one in DISTROS_WITH_CLASSIC] or [
            *DISTROS_WITH_CLASSIC
        ]
    if installed in possible or not possible:
        return installed
    # The newest with long-term support: the one that most people have.
    lasting = [one for one in possible if _is_lasting(one)]
    return (lasting or possible)[-1]


def with_distro(ros: RosEnvironment, distro: str) -> RosEnvironment:
    """That ROS, with another ROS_DISTRO for its processes; a sourced one keeps its own."""
    if ros.is_sourced:
        return ros
    return replace(ros, variables={**ros.variables, VARIABLE: distro})


def _is_lasting(distro: str) -> bool:
    return Target(distro=distro, simulator="gz").fact("support") == "long-term"


ENDINGS = (b"_msgs", b"_interfaces", b"_srvs")
# Of files that name messages for processes which are not compiled: Python, package.xml, YAML.
SUFFIXES = frozenset((".py", ".xml", ".yaml", ".yml", ""))
OF_CONTROL = ("control_msgs", "controller_manager_msgs")
ACTUATORS = "use_actuator_msg"  # of plugins
TRICYCLE = "publish_ackermann_command"  # a parameter of a controller
CONTROL = "ros2_control"  # in the file names of plugins
CONTROL_PROGRAMS = CONTROLLER_SPAWNERS | {"unspawner", "ros2_control_node"}
# Kinds of sensors whose messages only a package of Gazebo has.
OF_GAZEBO = sorted(
    kind
    for kind, sensor in SENSORS.items()
    if any(PAIRS[type_][0].startswith("ros_gz_interfaces/") for _, type_ in sensor.topics)
)
GAZEBO = {"classic": "gazebo_msgs", "gz": "ros_gz_interfaces"}
# Of files that describe robots, or are included by those.
DESCRIPTIONS = frozenset((".gazebo", ".sdf", ".urdf", ".xacro", ".xml"))
_SENSOR_OF_GAZEBO = re.compile(
    rf"<sensor[^>]*\btype\s*=\s*[\"'](?:{'|'.join(OF_GAZEBO)})[\"']".encode()
)
_TYPE = re.compile(r"\b([a-z]\w*)/(?:msg|srv|action)/\w+")
LARGEST = 1 << 20  # bytes of the file of a bridge


def messages_of_packages(packages: Iterable[PackageFolder]) -> frozenset[str]:
    """Those that packages of the workspace name in files for Python nodes, declared or not."""
    return frozenset(
        name
        for package in packages
        for file, text in texts_below(package.path)
        if file.suffix in SUFFIXES
        for name in messages_of_text(text)
    )


def messages_of_text(text: bytes) -> frozenset[str]:
    """Those that a file names."""
    return frozenset(word.decode() for word in set(WORDS.findall(text)) if word.endswith(ENDINGS))


def messages_of_robots_to_come(packages: Iterable[PackageFolder], simulator: str) -> frozenset[str]:
    """Those that robots of the workspace need, if a second launch or a node spawns one.

    They are needed when the simulator starts, because a process cannot load libraries from folders
    that it did not know then.
    """
    texts = [
        text
        for package in packages
        for file, text in texts_below(package.path)
        if file.suffix.lower() in DESCRIPTIONS
    ]
    names: set[str] = set()
    if any(CONTROL.encode() in text for text in texts):
        names.update(OF_CONTROL)
    if any(_SENSOR_OF_GAZEBO.search(text) for text in texts):
        names.add(GAZEBO[simulator])
    if any(ACTUATORS.encode() in text for text in texts):
        names.add("actuator_msgs")
    return frozenset(names)


def messages_of_devices(devices: Iterable[Devices], simulator: str) -> frozenset[str]:
    """Those that sensors and plugins publish or take."""
    return frozenset(name for one in devices for name in _of_devices(one, simulator))


def _of_devices(devices: Devices, simulator: str) -> Iterator[str]:
    files = (plugin.attributes.get("filename", "") for plugin in devices.plugins)
    if devices.ros2_control or any(CONTROL in file for file in files):
        yield from OF_CONTROL
    if any(plugin.get(ACTUATORS) for plugin in devices.plugins):
        yield "actuator_msgs"
    for plugin in devices.plugins:
        for parameters in plugin.find_all("parameters"):
            if TRICYCLE in _text_of(parameters.text):
                yield "ackermann_msgs"
    if any(sensor.kind in OF_GAZEBO for sensor in devices.sensors):
        yield GAZEBO[simulator]


def messages_of_plan(plan: LaunchPlan) -> frozenset[str]:
    """Those that controllers are managed with, and that processes name on their command lines."""
    return frozenset(name for process in plan.processes for name in _of_process(process))


def _of_process(process: Process) -> Iterator[str]:
    for program in commands.programs(process):
        is_of_ros2 = program.executable == "ros2" and program.arguments[:1] == ("control",)
        if program.executable in CONTROL_PROGRAMS or is_of_ros2:
            yield from OF_CONTROL
        for word in program.arguments:
            yield from _TYPE.findall(word)
        file = program.parameters.get("config_file")
        if isinstance(file, str):
            yield from _TYPE.findall(_text_of(file))


def _text_of(file: str) -> str:
    """What is in a file; nothing of one that is not there, or no text, or too large."""
    with suppress(OSError, ValueError):
        if Path(file).stat().st_size < LARGEST:
            return Path(file).read_text(encoding="utf-8")
    return ""

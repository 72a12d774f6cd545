"""Rules about topics: of nodes of the workspace, of Gazebo, of drives and bridges."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.bridges import FROM_GZ, TO_GZ, absolute
from wsgen.checks.rules.controllers import managed_controllers
from wsgen.checks.rules.simulators import BRIDGES
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.plugins import PLUGINS, REMAPPINGS, GazeboPlugin, simulator_of, stem
from wsgen.gazebo.sensors import SENSORS
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.model.target import SIM
from wsgen.text.suggestions import LONG, LONG_ENOUGH, did_you_mean, mistakes_between
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.checks.rules.bridges import Bridge
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.text import yamlfile
    from wsgen.text.xmltree import Element


UNHEARD_COMMAND = Rule(
    code="LCH097",
    name="unheard-command",
    severity=Severity.WARNING,
    summary="A node publishes commands on a topic that no drive of the robot subscribes to.",
    what="Compares the topics on which Python nodes of the workspace publish `Twist` and "
    "`TwistStamped` with those that plugins, controllers and bridges subscribe to, including "
    "remappings. Not checked where the launch file starts other nodes, which may subscribe to the "
    "topic.",
    why="The robot does not move, and no error is printed.",
    example="self.create_publisher(TwistStamped, '/cmd_vel', 10)\n"
    "# but the controller subscribes to /diff_drive_controller/cmd_vel",
    instead="self.create_publisher(TwistStamped, '/diff_drive_controller/cmd_vel', 10)",
)
UNPUBLISHED_TOPIC = Rule(
    code="LCH098",
    name="unpublished-topic",
    severity=Severity.WARNING,
    summary="A node subscribes to a misspelled topic.",
    what="Compares the subscriptions of Python nodes of the workspace with the topics that "
    "bridges, controllers and these nodes publish with the same type.",
    why="The node waits forever, and no error is printed.",
    example="self.create_subscription(LaserScan, '/scna', self.on_scan, 10)",
    instead="self.create_subscription(LaserScan, '/scan', self.on_scan, 10)",
)

TWIST, STAMPED = "geometry_msgs/Twist", "geometry_msgs/TwistStamped"
COMMANDS = frozenset((TWIST, STAMPED))
COMMAND_WORDS = frozenset(("cmd", "command", "commands", "drive"))
# Programs that read and publish nothing of what is compared here.
_SILENT = frozenset(
    (
        *("robot_state_publisher", "joint_state_publisher", "joint_state_publisher_gui"),
        *("controller_manager", "ros_gz_sim", "ros_ign_gazebo", "gazebo_ros", "rviz2", "xacro"),
        *("rqt_robot_steering", "teleop_twist_keyboard", "teleop_twist_joy", "joy", *BRIDGES),
    )
)
# Drives of Gazebo Classic that read Twist on `cmd_vel`.
_CLASSIC = frozenset(
    f"lib{name}.so"
    for name, plugin in PLUGINS.items()
    if any(topic.is_read and topic.type == TWIST for topic in plugin.topics.values())
)


class Endpoint(NamedTuple):
    """A topic that something reads or publishes."""

    topic: str  # absolute
    type: str  # "geometry_msgs/Twist"
    owner: str  # "the controller `drive`"
    is_published: bool
    file: Path | None = None
    line: int | None = None


class Graph(NamedTuple):
    """The topics of what a launch file starts, without nodes of Python."""

    endpoints: tuple[Endpoint, ...]
    is_whole: bool  # False: others may read and publish what is not known


def graph_of(
    plan: LaunchPlan,
    bridges: Iterable[Bridge],
    robots: Iterable[Element],
    files: Mapping[Path, yamlfile.Value | None],
    nodes: Collection[tuple[str | None, str | None]],
) -> Graph:
    """The topics of what a launch file starts.

    Args:
        plan: What it starts.
        bridges: The topics that its bridges connect.
        robots: The robots that it spawns.
        files: The files of parameters of their controllers.
        nodes: Packages and names of programs whose topics are read elsewhere.
    """
    endpoints = [*_of_bridges(bridges)]
    is_whole = plan.is_complete and not plan.unresolved
    for robot in robots:
        for plugin in robot.iter("plugin"):
            filename = (plugin.get("filename") or "").rpartition("/")[2]
            if filename in _CLASSIC:
                endpoints.append(_of_classic(plugin))
            elif "ros2_control" in filename:
                is_whole &= not any(child_text(ros, "namespace") for ros in children(plugin, "ros"))
                endpoints += _of_controllers(plugin, plan, files)
    is_whole &= all(
        program.package in _SILENT or (program.package, program.executable) in nodes
        for program in started_programs(plan)
    ) and all(
        include.evaluated or (include.package or "") in _SILENT
        for include in started_launch_files(plan)
    )
    return Graph(tuple(endpoints), is_whole)


def _of_bridges(bridges: Iterable[Bridge]) -> Iterator[Endpoint]:
    for one in bridges:
        type_ = one.ros_type.replace("/msg/", "/")
        topic, owner = absolute(one.ros_topic), "the bridge"
        if one.direction != FROM_GZ:
            yield Endpoint(topic, type_, owner, is_published=False, file=one.file, line=one.line)
        if one.direction != TO_GZ:
            yield Endpoint(topic, type_, owner, is_published=True, file=one.file, line=one.line)


def _remappings(plugin: Element) -> list[tuple[str, str]]:
    return [
        (old, new)
        for ros in children(plugin, "ros")
        for kind in REMAPPINGS
        for one in children(ros, kind)
        for old, sign, new in ((one.text or "").strip().partition(":="),)
        if sign
    ]


def _of_classic(plugin: Element) -> Endpoint:
    space = next((child_text(ros, "namespace") for ros in children(plugin, "ros")), None)
    topic = child_text(plugin, "command_topic") or "cmd_vel"
    topic = dict(_remappings(plugin)).get(topic, topic)
    return Endpoint(
        resolve(topic, space or ""), TWIST, f"the plugin {plugin.get('name')}", is_published=False
    )


def _of_controllers(
    plugin: Element, plan: LaunchPlan, files: Mapping[Path, yamlfile.Value | None]
) -> Iterator[Endpoint]:
    remappings = [*_remappings(plugin), *_of_spawners(plan)]
    for file, content in files.items():
        if content is None or not any(
            (one.text or "").strip() == str(file) for one in children(plugin, "parameters")
        ):
            continue
        for name, type_, values in managed_controllers(content):
            if type_ != "diff_drive_controller/DiffDriveController":
                continue
            stamped = values.get("use_stamped_vel") if values else None
            is_plain = stamped is not None and stamped.content is False
            command = "cmd_vel_unstamped" if is_plain else "cmd_vel"
            owner = f"the controller `{name.rpartition('/')[2]}`"
            for topic, kind, is_published in (
                (command, TWIST if is_plain else STAMPED, False),
                ("odom", "nav_msgs/Odometry", True),
            ):
                whole = f"{name}/{topic}"
                names = {whole, f"~/{topic}"}
                right = next((new for old, new in remappings if old in names), whole)
                yield Endpoint(resolve(right), kind, owner, is_published, file=file)


def _of_spawners(plan: LaunchPlan) -> Iterator[tuple[str, str]]:
    """The remappings that spawners hand to controllers."""
    for program in started_programs(plan):
        for word in " ".join(program.arguments).split():
            old, sign, new = word.strip("'\"").partition(":=")
            if sign and program.package == "controller_manager":
                yield old, new


def resolve(topic: str, namespace: str = "") -> str:
    """The absolute name of a topic."""
    if topic.startswith("/"):
        return topic
    return f"{'/' + namespace.strip('/') if namespace.strip('/') else ''}/{topic}"


class UsedTopic(NamedTuple):
    """A topic of a Python node of the workspace."""

    topic: str | None  # absolute, after remappings; None: not known
    type: str
    is_published: bool
    written: str
    file: Path
    line: int  # 1-based


def remapped(topic: str, program: Process | None) -> str | None:
    """The absolute name of a topic of a node; None where it is not known."""
    if topic.startswith("~") or "{" in topic:
        return None
    space = program.namespace if program else ""
    name = resolve(topic, space)
    for old, new in program.remappings if program else ():
        if resolve(old, space) == name:
            return None if new.startswith("~") else resolve(new, space)
    return name


def unheard_commands(graphs: Sequence[Graph], used: Sequence[UsedTopic]) -> Iterator[Diagnostic]:
    """Report commands that no drive reads; `graphs` are those of launch files with robots."""
    if not graphs or not all(graph.is_whole for graph in graphs):
        return
    if any(one.topic is None and one.type in COMMANDS for one in used):
        return  # a computed topic may be any
    drives = [
        one
        for graph in graphs
        for one in graph.endpoints
        if not one.is_published and one.type in COMMANDS
    ]
    heard = {one.topic for one in used if not one.is_published}
    sent = {one.topic for one in used if one.is_published}
    for one in used:
        if not one.is_published or one.type not in COMMANDS or one.topic in heard:
            continue
        if one.topic is None:
            continue
        here = [drive for drive in drives if drive.topic == one.topic]
        if any(drive.type == one.type for drive in here):
            continue
        meant = (
            here
            or [
                drive
                for drive in drives
                if _is_misspelled(one.topic, drive.topic)
                or (_is_alike(one.topic, drive.topic) and drive.topic not in sent)
            ]
            or [
                # Another name, but of a command, and nothing else commands this drive.
                drive
                for drive in drives
                if drive.type == one.type
                and _names_command(one.topic)
                and {each.topic for each in drives} == {drive.topic}
                and drive.topic not in sent
            ]
        )
        if not meant:
            continue
        drive = meant[0]
        message = (
            f"{one.file.name} publishes {one.type} on `{one.topic}`, but {drive.owner} expects "
            f"{drive.type}."
            if here
            else f"{one.file.name} publishes {one.type} on `{one.topic}`, which has no subscriber; "
            f"{drive.owner} subscribes to `{drive.topic}`."
        )
        yield UNHEARD_COMMAND.at(
            one.file,
            one.line,
            one.written,
            message=message,
            hint=f"Publish {drive.type} instead."
            if here
            else f"{did_you_mean(drive.topic)} If not, remap one of them."
            + (f" Its type is {drive.type}." if drive.type != one.type else ""),
        )


def unpublished_topics(graphs: Sequence[Graph], used: Sequence[UsedTopic]) -> Iterator[Diagnostic]:
    """Report topics that are read, and published under a name that differs in little."""
    published = [one for graph in graphs for one in graph.endpoints if one.is_published]
    sent = {one.topic for one in used if one.is_published} | {one.topic for one in published}
    computed = {one.type for one in used if one.topic is None}
    for one in used if all(graph.is_whole for graph in graphs) else ():
        if one.is_published or one.topic is None or one.topic in sent or one.type in computed:
            continue
        meant = next(
            (
                other
                for other in published
                if other.type == one.type and _is_misspelled(one.topic, other.topic)
            ),
            None,
        )
        if meant is not None:
            where = f" ({meant.file.name}, line {meant.line})" if meant.file and meant.line else ""
            yield UNPUBLISHED_TOPIC.at(
                one.file,
                one.line,
                one.written,
                message=f"{one.file.name} subscribes to `{one.topic}`, which has no publisher; "
                f"{meant.owner} publishes `{meant.topic}`{where}.",
                hint=did_you_mean(meant.topic),
            )


def _is_alike(topic: str, other: str) -> bool:
    """Whether two topics have the same name in different namespaces."""
    return topic.rpartition("/")[2] == other.rpartition("/")[2]


def _names_command(topic: str) -> bool:
    """Whether the name is one of commands; a Twist may be a measured velocity, too."""
    words = topic.rpartition("/")[2].lower().split("_")
    return not COMMAND_WORDS.isdisjoint(words)


def _is_misspelled(topic: str, other: str) -> bool:
    """Whether a topic surely is a misspelling of another one, and not that of another sensor."""
    letters = (topic.lower().replace("_", ""), other.lower().replace("_", ""))
    digits = [[letter for letter in each if letter.isdigit()] for each in letters]
    shorter = min(map(len, letters))
    if digits[0] != digits[1] or topic.count("/") != other.count("/") or shorter < LONG_ENOUGH:
        return False
    return mistakes_between(*letters) <= (2 if shorter > LONG else 1)


class GazeboTopic(NamedTuple):
    """A topic, and what has it."""

    name: str  # absolute
    type: str  # of gz.msgs
    is_published: bool  # by Gazebo; if not, it reads the topic
    owner: str  # "the sensor `lidar`"


def topics_of(root: Element, model: str | None, world: str | None) -> Iterator[GazeboTopic]:
    """The topics of the plugins and sensors of a robot or a model.

    Default names are given only where what they are made of is known.

    Args:
        root: A `<robot>`, or a `<model>`.
        model: What it is called in the world.
        world: The name of the world.
    """
    names = {"model": model, "world": world}
    for plugin in root.iter("plugin"):
        yield from _of_plugin(plugin, names)
    for sensor in root.iter("sensor"):
        yield from _of_sensor(sensor, names)


def _of_plugin(plugin: Element, names: dict[str, str | None]) -> Iterator[GazeboTopic]:
    filename = plugin.get("filename") or ""
    if simulator_of(filename) != SIM:
        return
    known = PLUGINS.get(stem(filename), GazeboPlugin())
    for _, topic, name in known.topic_names(lambda tag: child_text(plugin, tag), names):
        if name is not None:
            yield GazeboTopic(name, topic.type, not topic.is_read, f"the plugin `{filename}`")


def _of_sensor(sensor: Element, names: dict[str, str | None]) -> Iterator[GazeboTopic]:
    kind = sensor.get("type") or ""
    of_sensor = SENSORS.get(kind)
    if of_sensor is None:
        return
    name = sensor.get("name")
    owner = f"the sensor `{name}`"
    written = _in_child(sensor, kind, "topic") if kind == "contact" else None
    written = written or child_text(sensor, "topic")
    if written:
        base = absolute(written)
    else:
        place = _place_of(sensor)
        default = f"/world/{{world}}/model/{{model}}/{place}/sensor/{name}{of_sensor.default}"
        filled = _filled(default, names) if place and name else None
        if filled is None:
            return
        base = filled
    for suffix, type_name in of_sensor.topics:
        yield GazeboTopic(f"{base}{suffix}", type_name, is_published=True, owner=owner)
    if of_sensor.has_info:
        info = _in_child(sensor, "camera", "camera_info_topic")
        beside = f"{base.rpartition('/')[0]}/camera_info"
        yield GazeboTopic(
            absolute(info) if info else beside, "CameraInfo", is_published=True, owner=owner
        )


def _in_child(sensor: Element, tag: str, name: str) -> str | None:
    """The text of an element in the first child of that tag that has it."""
    return next((text for one in children(sensor, tag) if (text := child_text(one, name))), None)


def _place_of(sensor: Element) -> str | None:
    """The link or joint that has a sensor; None in the `<gazebo>` of a URDF.

    Gazebo may have lumped the link that it refers to into another one.
    """
    for place in sensor.iterancestors():
        if place.tag in ("link", "joint") and place.get("name"):
            return f"{place.tag}/{place.get('name')}"
        if place.tag == "gazebo":
            return None
    return None


def _filled(default: str, names: dict[str, str | None]) -> str | None:
    used = {key: name for key, name in names.items() if f"{{{key}}}" in default}
    if None in used.values():
        return None
    for key, name in used.items():
        default = default.replace(f"{{{key}}}", name or "")
    return default

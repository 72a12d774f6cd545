"""The topics of ROS that a simulated robot has, with their types and frames, without running it.

In Gazebo Classic plugins are nodes; in Gazebo Sim a bridge connects the topics of plugins and
sensors. What is known of them is that which live runs and the checks of bridges know.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.bridges import FROM_GZ, TO_GZ, Bridge, absolute, find_bridges
from wsgen.checks.rules.node_topics import STAMPED, TWIST, remapped, resolve
from wsgen.gazebo.bridged_types import short_gz_type, short_ros_type
from wsgen.gazebo.plugins import PLUGINS, REMAPPINGS, TRUE, node_name, simulator_of, stem
from wsgen.gazebo.sensors import (
    DEPTH_KINDS,
    FRAME_NAMES,
    SENSORS,
    TOPICS_OF_CLASSIC,
    TOPICS_OF_DEPTH,
)
from wsgen.launching.commands import started_programs
from wsgen.launching.spawner_options import SPAWN_ENTITY, read_options
from wsgen.model.devices import Element, in_namespace
from wsgen.model.target import CLASSIC
from wsgen.pipeline.check_launched import topics_of_launch

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.gazebo.plugins import GazeboPlugin
    from wsgen.model.devices import Devices, MountedSensor
    from wsgen.model.plan import LaunchPlan
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.started import Started


class RosTopic(NamedTuple):
    """A topic of ROS that the simulator has for a robot."""

    name: str  # absolute
    type: str  # "sensor_msgs/LaserScan"
    is_published: bool  # by the simulator; if not, it reads the topic
    frame: str = ""  # in the header, and of odometry "odom → base_link"; empty: not known


class _GzTopic(NamedTuple):
    """A topic of Gazebo Sim."""

    name: str
    type: str  # of gz.msgs
    is_published: bool
    frame: str


# The parameters of plugins that name the frames of a pose, where they have both.
_FRAMES = (
    ("odometry_frame", "robot_base_frame"),
    ("odom_frame", "robot_base_frame"),
    ("frame_id", "child_frame_id"),
    ("frame_name", "body_name"),
)
_IMAGE_BRIDGES = (("ros_gz_image", "image_bridge"), ("ros_ign_image", "image_bridge"))
_STAMPER = "twist_stamper"  # a package, and its program
_CLOCK = RosTopic("/clock", "rosgraph_msgs/Clock", is_published=True)
_WORLD = re.compile(r"^/world/[^/]+/")


def topics_of_robot(
    robot: PreparedRobot, started: Started, kind: str | None, world: str | None
) -> frozenset[RosTopic]:
    """The topics that a robot has in the simulator of a launch.

    Args:
        robot: It, with its devices.
        started: What the launch file starts.
        kind: Of the simulator, "classic" or "gz".
        world: The name of its world; None: it is not known.
    """
    devices = robot.devices
    found: set[RosTopic] = set()
    if devices is not None and kind == CLASSIC:
        found.update(_of_classic(robot, in_namespace(devices, _namespace(robot, started))))
    elif devices is not None:
        bridges = (*find_bridges(started.plan).topics, *_image_bridges(started.plan))
        found.update(_bridged(_of_sim(robot, devices, world), bridges, world))
    if started.simulator is not None and (kind == CLASSIC or _has_clock(started.plan)):
        found.add(_CLOCK)
    found.update(
        RosTopic(one.topic, one.type, one.is_published)
        for one in topics_of_launch(started, ()).endpoints
        if one.owner.startswith("the controller")
    )
    return frozenset((*found, *_stamped(found, started.plan)))


def _stamped(found: Iterable[RosTopic], plan: LaunchPlan) -> Iterator[RosTopic]:
    """The commands without a time that nodes of twist_stamper read for a robot."""
    for program in started_programs(plan):
        if (program.package, program.executable) == (_STAMPER, _STAMPER):
            source, target = (remapped(f"cmd_vel_{end}", program) for end in ("in", "out"))
            if source and any(one.name == target and one.type == STAMPED for one in found):
                yield RosTopic(source, TWIST, is_published=False)


def _namespace(robot: PreparedRobot, started: Started) -> str:
    """The namespace that spawn_entity.py gives to the plugins of a robot."""
    for spawn in started.spawns:
        if spawn.entity == robot.entity and spawn.process is not None:
            return read_options(spawn.process, SPAWN_ENTITY).values.get("robot_namespace", "")
    return ""


# Gazebo Classic


def _of_classic(robot: PreparedRobot, devices: Devices) -> Iterator[RosTopic]:
    for plugin in devices.plugins:
        filename = plugin.attributes.get("filename", "")
        facts = PLUGINS.get(stem(filename))
        if facts is None or simulator_of(filename) != CLASSIC:
            continue
        for use, topic, name in facts.topic_names(plugin.get, {}):
            # The transforms of wheels alone are those of robot_state_publisher, too.
            if name is not None and (use != "tf" or _is_true("publish_odom_tf", plugin, facts)):
                frame = _frames(use, plugin, facts, robot)
                yield RosTopic(_in_ros(name, plugin), topic.type, not topic.is_read, frame)
    for sensor in devices.sensors:
        for plugin in sensor.plugins:
            yield from of_classic_sensor(sensor, plugin)


def of_classic_sensor(sensor: MountedSensor, plugin: Element) -> Iterator[RosTopic]:
    """The topics that a plugin of Gazebo Classic has in a sensor."""
    name = stem(plugin.attributes.get("filename", ""))
    topics = {**TOPICS_OF_CLASSIC.get(name, {})}
    if name == "gazebo_ros_camera" and sensor.kind in DEPTH_KINDS:
        topics |= TOPICS_OF_DEPTH
    camera = plugin.get("camera_name") or sensor.name
    cameras = [camera]
    if sensor.kind == "multicamera":
        eyes = sensor.element.find_all("camera")
        cameras = [f"{camera}/{one.attributes.get('name', 'default')}" for one in eyes]
    parameters = {} if name not in PLUGINS else PLUGINS[name].parameters
    frame = plugin.get("frame_name") or str(parameters.get("frame_name") or "")
    # A link of an included model has the names of models before its own.
    frame = frame or sensor.link.rpartition("::")[2]
    for one in cameras if name == "gazebo_ros_camera" else cameras[:1]:
        for pattern, type_ in topics.items():
            topic = _in_ros(pattern.format(camera=one), plugin)
            said = plugin.get("output_type") or str(parameters.get("output_type"))
            kind = type_.format(output_type=said)
            yield RosTopic(topic, kind, is_published=True, frame=frame)


def _in_ros(topic: str, plugin: Element) -> str:
    """The absolute name of a topic of a plugin, which is a node."""
    ros = plugin.find("ros") or Element(tag="ros")
    space, node = ros.get("namespace"), node_name(plugin.attributes.get("name", "gazebo"))

    def whole(name: str) -> str:
        own = f"{node}/{name[2:]}" if name.startswith("~/") else name
        return resolve(own, space)

    for rule in (one for kind in REMAPPINGS for one in ros.find_all(kind)):
        old, sign, new = rule.text.partition(":=")
        if sign and whole(old) == whole(topic):
            return whole(new)
    return whole(topic)


def _is_true(name: str, plugin: Element, facts: GazeboPlugin) -> bool:
    return (plugin.get(name) or str(facts.parameters.get(name))).lower() in TRUE


def _frames(use: str, plugin: Element, facts: GazeboPlugin, robot: PreparedRobot) -> str:
    """The frames of an odometry: in its header, and that of what moves; empty where not known."""
    if use not in {"odometry", "tf"}:
        return ""
    pair = next((pair for pair in _FRAMES if facts.parameters.keys() >= {*pair}), ())
    return " → ".join(
        plugin.get(name)
        or str(facts.parameters[name]).format(model=robot.entity, link=robot.lumped.root)
        for name in pair
    )


# Gazebo Sim


def _of_sim(robot: PreparedRobot, devices: Devices, world: str | None) -> Iterator[_GzTopic]:
    names: Mapping[str, str | None] = {"model": robot.entity, "world": world or "?"}
    for plugin in devices.plugins:
        filename = plugin.attributes.get("filename", "")
        facts = PLUGINS.get(stem(filename))
        if facts is None or simulator_of(filename) == CLASSIC:
            continue
        for use, topic, name in facts.topic_names(plugin.get, names):
            if name is not None:
                frame = _frames(use, plugin, facts, robot)
                yield _GzTopic(name, topic.type, not topic.is_read, frame)
    for sensor in devices.sensors:
        yield from _of_sim_sensor(sensor, robot.entity, world or "?")


def _of_sim_sensor(sensor: MountedSensor, entity: str, world: str) -> Iterator[_GzTopic]:
    topics = SENSORS.get(sensor.kind)
    if topics is None:
        return
    element, link = sensor.element, sensor.link.replace("::", "/model/")
    place = f"/world/{world}/model/{entity}/link/{link}/sensor/{sensor.name}"
    if sensor.kind == "force_torque":  # it is on a joint
        place = f"/world/{world}/model/{entity}/joint/{sensor.frame}/sensor/{sensor.name}"
    written = element.get("contact/topic") if sensor.kind == "contact" else ""
    written = written or element.get("topic")
    base = absolute(written) if written else f"{place}{topics.default}"
    own = f"{entity}/{sensor.link.replace('::', '/')}/{sensor.name}"
    frame = element.get("camera/optical_frame_id") or next(
        filter(None, map(element.get, FRAME_NAMES)), own
    )
    frame = "" if sensor.kind == "contact" else frame
    for suffix, type_ in topics.topics:
        yield _GzTopic(f"{base}{suffix}", type_, is_published=True, frame=frame)
    if topics.has_info:
        info = element.get("camera/camera_info_topic")
        beside = absolute(info) if info else f"{base.rpartition('/')[0]}/camera_info"
        yield _GzTopic(beside, "CameraInfo", is_published=True, frame=frame)


def _bridged(
    topics: Iterator[_GzTopic], bridges: Sequence[Bridge], world: str | None
) -> Iterator[RosTopic]:
    """The topics of Gazebo Sim that ROS has by a bridge."""

    def known(name: str) -> str:
        """A name without that of a world which is not known."""
        return absolute(name) if world else _WORLD.sub("/world/?/", absolute(name))

    for topic in topics:
        other = TO_GZ if topic.is_published else FROM_GZ
        for bridge in bridges:
            if (
                known(bridge.gz_topic) == known(topic.name)
                and short_gz_type(bridge.gz_type) == topic.type
                and bridge.direction != other
            ):
                type_ = short_ros_type(bridge.ros_type)
                yield RosTopic(absolute(bridge.ros_topic), type_, topic.is_published, topic.frame)


def _image_bridges(plan: LaunchPlan) -> Iterator[Bridge]:
    """What ros_gz_image connects: each of its arguments, with the same name in ROS."""
    for program in started_programs(plan):
        if (program.package or "", program.executable or "") in _IMAGE_BRIDGES:
            for topic in program.arguments:
                if topic.startswith("-"):
                    break
                name = dict(program.remappings).get(topic, topic)
                yield Bridge(topic, name, "sensor_msgs/msg/Image", "gz.msgs.Image", FROM_GZ)


def _has_clock(plan: LaunchPlan) -> bool:
    return any(
        absolute(one.ros_topic) == _CLOCK.name and one.direction != TO_GZ
        for one in find_bridges(plan).topics
    )

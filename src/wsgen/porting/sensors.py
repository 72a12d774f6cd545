"""The sensors of Gazebo Classic and their plugins, for Gazebo Sim: it publishes by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.gazebo.plugins import stem
from wsgen.gazebo.sensors import FRAME_NAMES, SYSTEM_OF_SENSOR
from wsgen.gazebo.successors import (
    AS_IN_ROS_2,
    NO_TOPIC,
    SENSOR_ELEMENTS,
    SENSOR_TYPES,
    TYPES_OF_ROS_1,
)
from wsgen.porting.porter import carrier_of, link_of, number
from wsgen.porting.topics import absolute, folder
from wsgen.porting.xml_edits import COMPUTED, Block, Copy

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.porting.porter import ClassicPlugin, Porter
    from wsgen.porting.xml_edits import Node

SCAN, RANGE, CLOUD = (f"sensor_msgs/{name}" for name in ("LaserScan", "Range", "PointCloud2"))
POINTS = "/points"  # behind the topic of a lidar


def kind_of(sensor: Node) -> str:
    """The type of a sensor; by what describes it, where xacro computes it."""
    kind = sensor.get("type")
    if COMPUTED not in kind:
        return kind
    return next((name for name in ("ray", "imu", "contact") if sensor.find(name)), kind)


def goes_with_sensor(plugin: Node) -> bool:
    """Whether a plugin is one of a sensor, and publishes what Gazebo Sim does by itself."""
    name = stem(plugin.get("filename"))
    holder = plugin.holder
    is_inside = holder is not None and holder.name == "sensor"
    return is_inside and AS_IN_ROS_2.get(name, name) in PLUGINS


def port_sensor(port: Porter, sensor: Node) -> None:
    """Port a sensor, and what its plugins of Gazebo Classic publish."""
    kind = kind_of(sensor)
    plugins = [port.plugin(one) for one in sensor.children("plugin") if goes_with_sensor(one)]
    publishes = bool(plugins)
    if kind == "sonar":
        port.leave(
            sensor,
            "Gazebo Sim lacks sensors of the type sonar.",
            "Write a sensor of the type gpu_lidar in its place.",
        )
        return
    if kind == "multicamera":
        _part_cameras(port, sensor, plugins)
        return
    becomes = SENSOR_TYPES.get(kind, kind) if kind != "depth" or publishes else kind
    if becomes != sensor.get("type"):
        port.editor.set_attribute(sensor, "type", becomes)
    for name, new in SENSOR_ELEMENTS.items():
        for node in sensor.children(name):
            port.editor.rename(node, new)
    if system := SYSTEM_OF_SENSOR.get(becomes):
        port.systems.add(system)
    for plugin in plugins:
        port.editor.remove(plugin.node)
        PLUGINS[plugin.stem](port, sensor, plugin)
    if publishes:
        _put_frame(port, sensor, plugins[0])
    elif sensor.value("topic") == NO_TOPIC and (topic := sensor.find("topic")) is not None:
        port.editor.remove(topic)


def _part_cameras(port: Porter, sensor: Node, plugins: list[ClassicPlugin]) -> None:
    """Make a sensor of each camera; the first one stays where it is."""
    name = sensor.get("name")
    common = [one for one in sensor.children() if one.name not in ("camera", "plugin", "topic")]
    for place, camera in enumerate(sensor.children("camera")):
        own = camera.get("name") or "default"
        content = []
        for plugin in plugins:
            base = f"{plugin.value('camera_name') or name}/{own}"
            image = plugin.topics.resolve(f"{base}/image_raw")
            info = plugin.topics.resolve(f"{base}/camera_info")
            named = _own_topic(port, sensor, "camera", f"{name}_{own}") if port.is_scoped else image
            port.bridge(named, "Image", image)
            port.bridge(f"{folder(named)}/camera_info", "CameraInfo", info)
            content = [] if port.is_scoped else [Block("topic", image)]
            if frame := plugin.value("frame_name") or carrier_of(port, sensor):
                content.append(Block(port.target.frame_tag, frame))
        if place == 0:
            port.editor.set_attribute(sensor, "type", "camera")
            port.editor.set_attribute(sensor, "name", f"{name}_{own}")
            port.editor.append(sensor, *content)
        else:
            port.editor.cut(camera)
            copies = [*map(Copy, common), Copy(camera), *content]
            attributes = f'name="{name}_{own}" type="camera"'
            port.editor.add_behind(sensor, Block("sensor", copies, attributes))
    for node in (*(one.node for one in plugins), *sensor.children("topic")):
        port.editor.remove(node)
    port.systems.add("Sensors")


def _name_topic(port: Porter, sensor: Node, topic: str) -> str:
    """Write the name of the topic; one that stands beside a frame of Gazebo Sim stays."""
    if port.is_scoped:
        for node in sensor.children("topic"):
            port.editor.remove(node)
        return _own_topic(port, sensor, kind_of(sensor), sensor.get("name"))
    said = sensor.value("topic")
    if said and said != NO_TOPIC and any(map(sensor.find, FRAME_NAMES)):
        return said
    port.editor.put(sensor, "topic", topic)
    return topic


def _own_topic(port: Porter, sensor: Node, kind: str, name: str) -> str:
    """The topic that Gazebo Sim has for a sensor by itself."""
    becomes = SENSOR_TYPES.get(kind, kind)
    return port.topic_of_sensor(sensor, becomes, f"link/{carrier_of(port, sensor)}", name)


def _put_frame(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    """Name the frame of the messages, which is the link without a name."""
    if kind_of(sensor) == "contact" or any(map(sensor.find, FRAME_NAMES)):
        return
    named = plugin.value("frame_name")
    frame = named or carrier_of(port, sensor)
    if frame:
        port.editor.append(sensor, Block(port.target.frame_tag, frame))
        port.frames |= set() if named else {frame}


def _imu(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    topic = _output(plugin)
    port.bridge(_name_topic(port, sensor, topic), "IMU", topic)
    if plugin.value("initial_orientation_as_reference").lower() in ("true", "1"):
        return
    # Of Gazebo Sim's, the orientation is that since the beginning, if it is not said.
    if sensor.find("imu/orientation_reference_frame") is None:
        frame = Block("orientation_reference_frame", [Block("localization", "ENU")])
        inside = sensor.find("imu")
        if inside is None:
            port.editor.append(sensor, Block("imu", [frame]))
        else:
            port.editor.append(inside, frame)


def _output(plugin: ClassicPlugin) -> str:
    """The topic of a plugin that has one."""
    if plugin.is_of_ros_1:
        return plugin.topics.expand(plugin.value("topic_name") or plugin.node.get("name"))
    return plugin.topics.resolve("~/out")


def _lidar(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    ros, kind = _output(plugin), _type_of(plugin)
    first = next(
        one
        for one in map(port.plugin, sensor.children("plugin"))
        if one.stem == "gazebo_ros_ray_sensor"
    )
    base = _output(first)
    if _type_of(first) == CLOUD and base != POINTS:
        base = base.removesuffix(POINTS)
    if first.node.start == plugin.node.start or port.is_scoped:
        base = _name_topic(port, sensor, base)
    if kind not in (SCAN, RANGE, CLOUD) and COMPUTED not in kind:
        port.leave(
            plugin.node,
            f"Its messages are `{kind}`, which Gazebo Sim does not have.",
            f"Have nodes that read them take `{CLOUD}`.",
        )
        kind = CLOUD
    if kind == CLOUD:
        port.bridge(f"{base}{POINTS}", "PointCloudPacked", ros)
    else:
        port.bridge(base, "LaserScan", ros, ros_type=SCAN if COMPUTED in kind else kind)
    if number(plugin.value("min_intensity")) not in (None, 0.0):
        port.leave(
            plugin.node,
            "Gazebo Sim does not have a least intensity of lidars.",
            "Filter the scan in a node.",
        )


def _type_of(plugin: ClassicPlugin) -> str:
    """The type of the messages of a lidar."""
    usual = SCAN if plugin.own_stem in AS_IN_ROS_2 else CLOUD
    default = TYPES_OF_ROS_1.get(plugin.own_stem, usual)
    return plugin.value("output_type", default)


def _camera(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    base = plugin.value("camera_name") or sensor.get("name")
    topics = plugin.topics
    names = {
        use: topics.resolve(f"{base}/{name}")
        for use, name in (
            ("image", "image_raw"),
            ("info", "camera_info"),
            ("depth", "depth/image_raw"),
            ("depth info", "depth/camera_info"),
            ("points", "points"),
        )
    }
    if plugin.is_of_ros_1:
        for use, parameter in (
            ("image", "image_topic_name"),
            ("info", "camera_info_topic_name"),
            ("depth", "depth_image_topic_name"),
            ("depth info", "depth_image_camera_info_topic_name"),
            ("points", "point_cloud_topic_name"),
        ):
            if said := plugin.value(parameter):
                names[use] = topics.expand(said if said.startswith("/") else f"{base}/{said}")
    camera = sensor.find("camera")
    if kind_of(sensor) == "depth":
        _depth(port, sensor, plugin, topics.expand(base), names)
    else:
        image, info = names["image"], names["info"]
        named = _name_topic(port, sensor, image)
        port.bridge(named, "Image", image)
        beside = absolute(f"{folder(named)}/camera_info")
        said = camera.value("camera_info_topic") if camera is not None else ""
        if camera is not None and named == image and beside != absolute(info):
            port.editor.put(camera, "camera_info_topic", info)
            said = info
        port.bridge(said or beside, "CameraInfo", info)
    if number(plugin.value("hack_baseline")) not in (None, 0.0):
        port.leave(
            plugin.node,
            "Its <hack_baseline> was in the projection matrix of `camera_info`.",
            "Write <lens><projection><tx> into the <camera> if a node reads it.",
            is_note=True,
        )


def _depth(
    port: Porter, sensor: Node, plugin: ClassicPlugin, base: str, names: dict[str, str]
) -> None:
    base = _name_topic(port, sensor, base)
    for ending, gz_type, uses in (
        ("image", "Image", ("image",)),
        ("camera_info", "CameraInfo", ("info", "depth info")),
        ("depth_image", "Image", ("depth",)),
        ("points", "PointCloudPacked", ("points",)),
    ):
        for use in uses:
            port.bridge(f"{base}/{ending}", gz_type, names[use])
    camera = sensor.find("camera")
    if camera is not None and camera.find("depth_camera/clip") is None:
        near = plugin.value("min_depth", plugin.default("min_depth"))
        bounds = [Block("near", near)]
        if far := plugin.value("max_depth"):
            bounds.append(Block("far", far))
        inside = camera.find("depth_camera")
        clip = Block("clip", bounds)
        if inside is None:
            port.editor.append(camera, Block("depth_camera", [clip]))
        else:
            port.editor.append(inside, clip)
    frame = plugin.value("frame_name")
    if frame and frame != link_of(sensor):
        port.leave(
            plugin.node,
            f"The z-axis of `{frame}` points ahead in the point clouds of Gazebo Classic, and the "
            "x-axis in those of Gazebo Sim.",
            "Turn the clouds in the node that reads them, or name a frame whose x-axis points "
            "ahead.",
        )


def _contact(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    topic = plugin.topics.resolve("bumper_states")
    contact = sensor.find("contact")
    named = topic
    if port.is_scoped:
        named = _name_topic(port, sensor, topic)
    elif contact is not None:
        port.editor.put(contact, "topic", topic)
    port.bridge(named, "Contacts", topic)
    port.leave(
        plugin.node,
        "Its messages were gazebo_msgs/ContactsState, also while nothing touched; those of Gazebo "
        "Sim are ros_gz_interfaces/Contacts, while something touches.",
        "Change the nodes that read them.",
    )


def _navsat(port: Porter, sensor: Node, plugin: ClassicPlugin) -> None:
    topic = _output(plugin)
    port.bridge(_name_topic(port, sensor, topic), "NavSat", topic)
    port.leave(
        plugin.node,
        f"It published the velocity, too, on `{plugin.topics.resolve('~/vel')}`.",
        "Add gz-sim-odometry-publisher-system if a node reads it.",
    )


PLUGINS: dict[str, Callable[[Porter, Node, ClassicPlugin], None]] = {
    "gazebo_ros_imu_sensor": _imu,
    "gazebo_ros_ray_sensor": _lidar,
    "gazebo_ros_camera": _camera,
    "gazebo_ros_bumper": _contact,
    "gazebo_ros_gps_sensor": _navsat,
}

"""The topics of Gazebo Sim that the plugins and sensors of robots and worlds have.

Source of the default names: gazebosim/gz-sim, src/systems; gazebosim/gz-sensors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.gazebo_systems import system_of
from wsgen.values import NamedTuple
from wsgen.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.xmltree import Element


class GazeboTopic(NamedTuple):
    """A topic, and what has it."""

    name: str  # absolute
    type: str  # of gz.msgs
    is_published: bool  # by Gazebo; if not, it reads the topic
    owner: str  # "the sensor `lidar`"


class _OfSystem(NamedTuple):
    tag: str  # the child of <plugin> that names the topic; empty: nothing does
    default: str  # with {model} and {world}
    type: str
    is_published: bool = True


_DRIVE = (
    _OfSystem("topic", "/model/{model}/cmd_vel", "Twist", is_published=False),
    _OfSystem("odom_topic", "/model/{model}/odometry", "Odometry"),
    _OfSystem("tf_topic", "/model/{model}/tf", "Pose_V"),
)
_SYSTEMS = {
    "DiffDrive": _DRIVE,
    "AckermannSteering": _DRIVE,
    "MecanumDrive": _DRIVE,
    "VelocityControl": (_DRIVE[0],),
    "OdometryPublisher": (
        _OfSystem("odom_topic", "/model/{model}/odometry", "Odometry"),
        _OfSystem(
            "odom_covariance_topic",
            "/model/{model}/odometry_with_covariance",
            "OdometryWithCovariance",
        ),
        _OfSystem("tf_topic", "/model/{model}/pose", "Pose_V"),
    ),
    "PosePublisher": (
        _OfSystem("", "/model/{model}/pose", "Pose_V"),
        _OfSystem("", "/model/{model}/pose_static", "Pose_V"),
    ),
    "JointStatePublisher": (
        _OfSystem("topic", "/world/{world}/model/{model}/joint_state", "Model"),
    ),
}
# Type of a sensor -> the topics below its own, or beside it, with their types.
_SENSORS = {
    "gpu_lidar": (("", "LaserScan"), ("/points", "PointCloudPacked")),
    "gpu_ray": (("", "LaserScan"), ("/points", "PointCloudPacked")),
    "lidar": (("", "LaserScan"), ("/points", "PointCloudPacked")),
    "ray": (("", "LaserScan"), ("/points", "PointCloudPacked")),
    "imu": (("", "IMU"),),
    "camera": (("", "Image"),),
    "magnetometer": (("", "Magnetometer"),),
    "air_pressure": (("", "FluidPressure"),),
    "altimeter": (("", "Altimeter"),),
    "navsat": (("", "NavSat"),),
    "gps": (("", "NavSat"),),
    "rgbd_camera": (
        ("/image", "Image"),
        ("/depth_image", "Image"),
        ("/points", "PointCloudPacked"),
        ("/camera_info", "CameraInfo"),
    ),
}
_DEFAULTS = {
    "gpu_lidar": "/scan",
    "gpu_ray": "/scan",
    "lidar": "/scan",
    "ray": "/scan",
    "imu": "/imu",
    "camera": "/image",
    "magnetometer": "/magnetometer",
    "air_pressure": "/air_pressure",
    "altimeter": "/altimeter",
    "navsat": "/navsat",
    "gps": "/navsat",
    "rgbd_camera": "",
}


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
    system = system_of(plugin.get("filename") or "")
    for one in _SYSTEMS.get(system or "", ()):
        written = child_text(plugin, one.tag)
        name = _absolute(written) if written else _filled(one.default, names)
        if name is not None:
            yield GazeboTopic(name, one.type, one.is_published, f"the plugin {system}")


def _of_sensor(sensor: Element, names: dict[str, str | None]) -> Iterator[GazeboTopic]:
    kind = sensor.get("type") or ""
    name = sensor.get("name")
    owner = f"the sensor `{name}`"
    written = child_text(sensor, "topic")
    if kind not in _SENSORS:
        return
    if written:
        base = _absolute(written)
    else:
        link = _link_of(sensor)
        default = f"/world/{{world}}/model/{{model}}/link/{link}/sensor/{name}{_DEFAULTS[kind]}"
        filled = _filled(default, names) if link and name else None
        if filled is None:
            return
        base = filled
    for suffix, type_name in _SENSORS[kind]:
        yield GazeboTopic(f"{base}{suffix}", type_name, is_published=True, owner=owner)
    if kind == "camera":
        info = next(
            (
                text
                for one in children(sensor, "camera")
                if (text := child_text(one, "camera_info_topic"))
            ),
            None,
        )
        beside = f"{base.rpartition('/')[0]}/camera_info"
        yield GazeboTopic(
            _absolute(info) if info else beside, "CameraInfo", is_published=True, owner=owner
        )


def _link_of(sensor: Element) -> str | None:
    """The link that has a sensor; in URDF the one that its `<gazebo>` refers to, if it has one."""
    for place in sensor.iterancestors():
        if place.tag == "link":
            return place.get("name")
        if place.tag == "gazebo":
            return None  # Gazebo may have lumped the link into another one
    return None


def _absolute(topic: str) -> str:
    return topic if topic.startswith("/") else f"/{topic}"


def _filled(default: str, names: dict[str, str | None]) -> str | None:
    used = {key: name for key, name in names.items() if f"{{{key}}}" in default}
    if None in used.values():
        return None
    for key, name in used.items():
        default = default.replace(f"{{{key}}}", name or "")
    return default

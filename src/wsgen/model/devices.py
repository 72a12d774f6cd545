"""What a robot carries for ROS: sensors and plugins, on the links that a simulator has.

Gazebo lumps links that fixed joints join; what the description puts on such a link is carried by
the link that it became a part of. SI units; poses are seen from the frame of the carrying link.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping  # noqa: TC003  answers are decoded by type hints
from dataclasses import field, replace
from typing import TYPE_CHECKING

from wsgen.model.transform import IDENTITY, Pose, rotation_of_quaternion, rpy_of_rotation
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from wsgen.text import xmltree

# Elements of a world that sensors measure.
SURROUNDINGS = ("spherical_coordinates", "magnetic_field", "atmosphere")
NUMBERS_OF_POSE = 6
NUMBERS_OF_QUATERNION_POSE = 7


@dataclass(frozen=True, kw_only=True)
class Element:
    """An element of XML, as it is written, without its comments."""

    tag: str
    text: str = ""  # without blanks around it
    attributes: Mapping[str, str] = field(default_factory=dict)
    children: tuple[Element, ...] = ()
    line: int | None = None  # 1-based

    def find(self, path: str) -> Element | None:
        """The first element at a path of tags, `a/b/c`; None without it."""
        return next(self.find_all(path), None)

    def find_all(self, path: str) -> Iterator[Element]:
        """All elements at a path of tags, in order."""
        tag, _, rest = path.partition("/")
        for child in self.children:
            if child.tag == tag:
                if rest:
                    yield from child.find_all(rest)
                else:
                    yield child

    def get(self, path: str, default: str = "") -> str:
        """The text of the first element at a path; `default` without it."""
        found = self.find(path)
        return default if found is None else found.text


@dataclass(frozen=True, kw_only=True)
class Carried:
    """Where a frame of the description is."""

    link: str  # the link of the lumped robot that carries it
    pose_in_link: Pose = IDENTITY


@dataclass(frozen=True, kw_only=True)
class MountedSensor:
    """A `<sensor>`; `pose_in_link` has the sensor's own <pose> in it."""

    name: str
    kind: str  # its attribute `type`: ray, gpu_lidar, imu, camera …
    link: str  # of the lumped robot, that carries it
    pose_in_link: Pose = IDENTITY
    frame: str  # the link that the description puts it on
    element: Element
    plugins: tuple[Element, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Devices:
    """What one robot, or the world, carries."""

    sensors: tuple[MountedSensor, ...] = ()
    plugins: tuple[Element, ...] = ()  # of the whole robot: tag "plugin", attributes filename, name
    # For each link of the description, lumped ones too; the values of a fixed frame.
    frames: Mapping[str, Carried] = field(default_factory=dict)
    ros2_control: tuple[Element, ...] = ()  # <ros2_control> of the URDF
    surroundings: tuple[Element, ...] = ()  # of a world: what its sensors measure, by SURROUNDINGS


def in_namespace(devices: Devices, namespace: str) -> Devices:
    """The devices with that namespace in the <ros> of each plugin, whatever was there."""
    if not namespace:
        return devices
    return replace(
        devices,
        plugins=tuple(_in_namespace(plugin, namespace) for plugin in devices.plugins),
        sensors=tuple(
            replace(
                sensor,
                plugins=tuple(_in_namespace(plugin, namespace) for plugin in sensor.plugins),
            )
            for sensor in devices.sensors
        ),
    )


def _in_namespace(plugin: Element, namespace: str) -> Element:
    ros = plugin.find("ros") or Element(tag="ros")
    kept = tuple(child for child in ros.children if child.tag != "namespace")
    given = replace(ros, children=(Element(tag="namespace", text=namespace), *kept))
    others = tuple(child for child in plugin.children if child is not ros)
    return replace(plugin, children=(given, *others))


def copied(element: xmltree.Element) -> Element:
    """An element of a document that is read, with all that is in it."""
    line = element.sourceline
    return Element(
        tag=element.tag,
        text=(element.text or "").strip(),
        attributes={str(name): str(value) for name, value in element.attrib.items()},
        children=tuple(copied(child) for child in element if isinstance(child.tag, str)),
        line=line if isinstance(line, int) else None,
    )


def pose_of(element: Element | None) -> Pose:
    """The pose that a `<pose>` says, in whatever frame it is; the identity for what says none.

    The rotation is roll, pitch and yaw in rad (in degrees with `degrees="true"`), or with
    `rotation_format="quat_xyzw"` a quaternion.
    """
    numbers = [] if element is None else numbers_of(element.text)
    if element is None or not all(map(math.isfinite, numbers)):
        return IDENTITY
    if element.attributes.get("rotation_format") == "quat_xyzw":
        if len(numbers) != NUMBERS_OF_QUATERNION_POSE:
            return IDENTITY
        x, y, z, *turn = numbers
        length = math.hypot(*turn)
        if not length:
            return Pose(xyz=(x, y, z))
        i, j, k, w = (part / length for part in turn)
        return Pose(xyz=(x, y, z), rpy=rpy_of_rotation(rotation_of_quaternion((i, j, k, w))))
    if len(numbers) != NUMBERS_OF_POSE:
        return IDENTITY
    x, y, z, *angles = numbers
    if element.attributes.get("degrees", "").lower() in {"true", "1"}:
        angles = [math.radians(angle) for angle in angles]
    roll, pitch, yaw = angles
    return Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw))


def numbers_of(text: str) -> list[float]:
    """The numbers of a text; none where one of its words is none."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []

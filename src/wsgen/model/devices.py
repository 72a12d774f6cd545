"""What a robot carries for ROS: sensors and plugins, on the links that a simulator has.

Gazebo lumps links that fixed joints join; what the description puts on such a link is carried by
the link that it became a part of. SI units; poses are seen from the frame of the carrying link.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping  # noqa: TC003  answers are decoded by type hints
from dataclasses import field

from wsgen.model.transform import IDENTITY, Pose
from wsgen.values import dataclass


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

"""What a URDF says for ROS and Gazebo: sensors, plugins and the hardware of ros2_control.

sdformat puts the sensors of a lumped link on the link that it became a part of, and their poses
with them (`ReduceSDFExtensionsTransform` of parser_urdf.cc). Sensors of a joint are for a joint
that is left; plugins count where they are in a `<gazebo>` without a reference, or in a sensor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.descriptions.urdf.reader import read_document
from wsgen.model.devices import NUMBERS_OF_POSE, Carried, Devices, MountedSensor, copied, pose_of
from wsgen.model.kinematics import fixed_frames, link_poses
from wsgen.model.transform import IDENTITY, compose, invert
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.model.devices import Element
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Pose
    from wsgen.text import xmltree


def read_devices(text: str | bytes, written: Robot, lumped: Robot) -> Devices:
    """What a robot carries, of the text of its URDF.

    Args:
        text: The URDF, without xacro; bytes are those of a file.
        written: The robot that `read_urdf` makes of it.
        lumped: The same, as `lump` leaves it.
    """
    root = read_document(text)
    if root is None:
        return Devices()
    frames = {
        name: Carried(link=link, pose_in_link=pose)
        for name, (link, pose) in fixed_frames(written, lumped).items()
    }
    places = dict(frames)
    # A frame of a joint is that of its child.
    places |= {
        joint.name: frames[joint.child] for joint in lumped.joints if joint.name not in places
    }
    sensors: list[MountedSensor] = []
    plugins: list[Element] = []
    for tag in children(root, "gazebo"):
        reference = tag.get("reference") or ""
        if not reference:
            plugins += map(copied, children(tag, "plugin"))
        elif reference in places:
            elements = map(copied, children(tag, "sensor"))
            sensors += _mounted(elements, reference, places, lumped)
    return Devices(
        sensors=tuple(sensors),
        plugins=tuple(plugins),
        frames=frames,
        ros2_control=_hardware(root),
    )


def hardware_of_urdf(text: str) -> tuple[Element, ...]:
    """The <ros2_control> of a URDF; none where it is no XML."""
    root = read_document(text)
    return () if root is None else _hardware(root)


def _hardware(root: xmltree.Element) -> tuple[Element, ...]:
    return tuple(map(copied, children(root, "ros2_control")))


def _mounted(
    elements: Iterator[Element], reference: str, places: Mapping[str, Carried], lumped: Robot
) -> Iterator[MountedSensor]:
    """The sensors of the link, or of the joint, that a `<gazebo>` refers to."""
    place = places[reference]
    kept = {*(link.name for link in lumped.links), *(joint.name for joint in lumped.joints)}
    for element in elements:
        written = element.find("pose")
        relative_to = "" if written is None else written.attributes.get("relative_to", "")
        base = place.pose_in_link
        if relative_to in places and relative_to != reference:
            base = _seen_from(place.link, places[relative_to], lumped)
        yield MountedSensor(
            name=element.attributes.get("name", ""),
            kind=element.attributes.get("type", ""),
            link=place.link,
            pose_in_link=compose(base, _pose_of(written, is_moved=reference not in kept)),
            frame=reference,
            element=element,
            plugins=tuple(element.find_all("plugin")),
        )


def _pose_of(written: Element | None, *, is_moved: bool) -> Pose:
    """What is read of the `<pose>` of a sensor, which may be of a lumped link.

    Where sdformat moves a sensor to another link, it reads the first six numbers as x y z roll
    pitch yaw, in rad, whatever the attributes of the `<pose>` say.
    """
    if written is None or not is_moved:
        return pose_of(written)
    numbers = written.text.split()[:NUMBERS_OF_POSE]
    return pose_of(replace(written, text=" ".join(numbers), attributes={}))


def _seen_from(link: str, place: Carried, lumped: Robot) -> Pose:
    """The pose of a frame in that of a link, with all joints at zero."""
    if place.link == link:
        return place.pose_in_link
    poses = link_poses(lumped, IDENTITY)
    return compose(invert(poses[link]), compose(poses[place.link], place.pose_in_link))

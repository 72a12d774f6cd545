"""What models and worlds of SDF say for ROS and Gazebo: their sensors and plugins.

The frame of a link in a `Robot` is that of the joint above it; `Devices.frames` says where the
link's own is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.frames import link_of
from wsgen.model.devices import SURROUNDINGS, Carried, Devices, MountedSensor, copied, pose_of
from wsgen.model.transform import compose, invert
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.descriptions.sdf.frames import Node, Poses, Scope
    from wsgen.model.devices import Element
    from wsgen.model.transform import Pose
    from wsgen.text.xmltree import Element as XmlElement


def read_world_devices(world: XmlElement) -> Devices:
    """The plugins of a world, and what its sensors measure."""
    return Devices(
        plugins=tuple(map(copied, children(world, "plugin"))),
        surroundings=tuple(map(copied, children(world, *SURROUNDINGS))),
    )


def read_devices(
    model: Scope, parts: Mapping[str, Mapping[str, Node]], poses: Poses, frames: Mapping[str, Pose]
) -> Devices:
    """What a model carries, with all models in it.

    Args:
        model: The model.
        parts: Its links, joints and frames, by these words and their full names.
        poses: Of all nodes of the model, in the model.
        frames: The frames of the links of the robot that is made of it, in the model.
    """
    links = parts["link"]
    name_of = {node: name for name, node in links.items()}
    carriers = {name: (name, node) for name, node in links.items()}
    for kind in ("frame", "joint"):
        for name, node in parts[kind].items():
            link = link_of(node)
            if link is not None and link in name_of and name not in carriers:
                carriers[name] = (name_of[link], node)
    sensors: list[MountedSensor] = []
    for kind in ("link", "joint"):
        for name, node in parts[kind].items():
            if carriers.get(name, ("", None))[1] is node:
                sensors += _mounted(node, name, carriers[name][0], poses, frames)
    return Devices(
        sensors=tuple(sensors),
        plugins=tuple(_plugins(model)),
        frames={
            name: Carried(link=link, pose_in_link=_from(frames[link], poses[node]))
            for name, (link, node) in carriers.items()
            if node.kind != "joint"
        },
    )


def _mounted(
    node: Node, name: str, link: str, poses: Poses, frames: Mapping[str, Pose]
) -> Iterator[MountedSensor]:
    """The sensors of a link, or of a joint."""
    for element in map(copied, children(node.element, "sensor")):
        written = element.find("pose")
        base = None
        if written is not None:
            attributes = written.attributes
            frame = attributes.get("relative_to") or attributes.get("frame") or ""
            base = node.scope.lookup(frame) if frame else None
        pose = compose(poses[base or node], pose_of(written))
        yield MountedSensor(
            name=element.attributes.get("name", ""),
            kind=element.attributes.get("type", ""),
            link=link,
            pose_in_link=_from(frames[link], pose),
            frame=name,
            element=element,
            plugins=tuple(element.find_all("plugin")),
        )


def _plugins(model: Scope) -> Iterator[Element]:
    """The plugins of the model and of those in it; an <include> may add some."""
    for scope in model.below():
        yield from map(copied, children(scope.element, "plugin"))
        if scope.node is not None and scope.node.include is not None:
            yield from map(copied, children(scope.node.include, "plugin"))


def _from(frame: Pose, pose: Pose) -> Pose:
    """The pose in a frame, when both are given in the same one."""
    return compose(invert(frame), pose)

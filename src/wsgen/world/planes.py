"""Planes: half-spaces without end in Gazebo, the ground or large boxes in a trial."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.pose import Pose
from wsgen.model.robot import Box, Collision, Visual
from wsgen.model.transform import (
    compose,
    multiply,
    rotation_of_rpy,
    rpy_of_rotation,
)
from wsgen.world.frames import is_level_at_zero, pose_in
from wsgen.world.shapes import KNOWN
from wsgen.world.surfaces import read_colour, read_surface
from wsgen.world.values import FARTHEST, first, read_numbers, read_pose, triple, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.transform import Matrix
    from wsgen.world.scopes import Node, Scope
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

EXTENT = (1000.0, 1000.0, 10.0)  # m, of the box that a plane is the upper side of, as the ground is
SHEET = 0.001  # m, how thick the box is that a plane is seen as
UP = (0.0, 0.0, 1.0)
DOWNWARD = -1 + 1e-9  # of a direction's z: from here on, every way there is the shortest


class Planes(NamedTuple):
    """What becomes of the planes of a link."""

    collisions: tuple[Collision, ...] = ()
    visuals: tuple[Visual, ...] = ()
    is_ground: bool = False  # one of them is the ground of the world, which the engine has itself


NONE = Planes()


def read_planes(node: Node, model: Scope, model_in_world: Pose) -> Planes:
    """The planes of a link of a model, seen from the link's own frame.

    One that is level, at z = 0 and of a static model is the ground. Others of static models carry
    as far as anybody goes in a trial. What moves is left out, which is reported: no engine has a
    half-space that does.
    """
    found = list(_planes_of(node.element))
    if not found:
        return NONE
    source, is_static = node.source, node.scope.is_static
    link_in_world = compose(model_in_world, pose_in(model, node))
    collisions, visuals, is_ground = [], [], False
    for owner, shape in found:
        upward = _upward(source, owner, shape)
        if upward is None:
            continue
        is_level = is_static and is_level_at_zero(compose(link_in_world, upward))
        if owner.tag == "visual":
            size = _size(source, shape)
            if size is not None and not is_level:
                visuals.append(_seen(source, owner, upward, size))
        elif not is_static:
            source.warning(
                "WLD031",
                f"The plane of the link `{node.name}` is left out of the trial: Gazebo's planes "
                "have no end, and only one that is static can be tried.",
                at=shape,
                hint="Make the model static, or make a plate of a thin box.",
            )
        elif is_level:
            is_ground = True
        else:
            collisions.append(
                Collision(
                    geometry=Box(size=EXTENT),
                    pose_in_link=_below(upward, EXTENT[2]),
                    surface=read_surface(source, owner),
                    name=owner.get("name"),
                )
            )
    return Planes(tuple(collisions), tuple(visuals), is_ground)


def _planes_of(link: Element) -> Iterator[tuple[Element, Element]]:
    """The collisions and visuals whose shape is a plane, and their planes."""
    for owner in children(link, "collision", "visual"):
        geometry = first(owner, "geometry")
        shape = None if geometry is None else next(children(geometry, *KNOWN), None)
        if shape is not None and shape.tag == "plane":
            yield owner, shape


def _upward(source: Source, owner: Element, shape: Element) -> Pose | None:
    """The pose in the link of a frame in the plane whose z axis is the normal."""
    pose, _ = read_pose(source, owner)
    normal = triple(source, shape, "normal", default=UP)
    length = math.hypot(*normal)
    if not 0 < length < math.inf:
        source.error(
            "WLD034",
            "The normal of this plane has no direction.",
            at=shape,
            hint="A level plane has <normal>0 0 1</normal>.",
        )
        return None
    x, y, z = (part / length for part in normal)
    if (x, y, z) == UP:
        return pose
    rotation = multiply(rotation_of_rpy(pose.rpy), _turned_up(x, y, z))
    return Pose(pose.xyz, rpy_of_rotation(rotation))


def _turned_up(x: float, y: float, z: float) -> Matrix:
    """The shortest rotation that takes the z axis to a direction of length 1."""
    if z < DOWNWARD:
        return ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    part = 1 / (1 + z)
    return (
        (1 - x * x * part, -x * y * part, x),
        (-x * y * part, 1 - y * y * part, y),
        (-x, -y, z),
    )


def _below(upward: Pose, thickness: float) -> Pose:
    """The pose of a box whose upper side is in the plane."""
    return compose(upward, Pose((0.0, 0.0, -thickness / 2)))


def _size(source: Source, shape: Element) -> tuple[float, float] | None:
    """What is seen of the plane; None where it is nothing, which is reported."""
    element = first(shape, "size") if word(shape, "size") else None
    numbers = (1.0, 1.0) if element is None else read_numbers(source, element, 2)
    if numbers is None:
        return None
    if all(0 < edge <= FARTHEST for edge in numbers):
        return (numbers[0], numbers[1])
    source.warning(
        "WLD034",
        f"The size of this plane is not between 0 and {FARTHEST:g} m.",
        at=shape,
        hint="Give both edges of what is to be seen a sensible number of metres.",
    )
    return None


def _seen(source: Source, owner: Element, upward: Pose, size: tuple[float, float]) -> Visual:
    return Visual(
        geometry=Box(size=(*size, SHEET)),
        pose_in_link=_below(upward, SHEET),
        rgba=read_colour(source, owner),
        name=owner.get("name"),
    )

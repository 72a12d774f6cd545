"""Which links of a robot are next to each other, and which may touch each other."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.model.robot import Robot


def neighbours(robot: Robot) -> set[frozenset[str]]:
    """The pairs of links that a joint joins."""
    return {frozenset((joint.parent, joint.child)) for joint in (*robot.joints, *robot.loose)}


def may_touch(robot: Robot) -> set[frozenset[str]]:
    """The pairs of links that collide with each other.

    Both have `self_collide`, and no joint joins them. SDF says that one is enough, Gazebo Sim takes
    the flag of the whole model alone; with one, PyBullet's convex hulls would push robots apart
    whose meshes do not touch.
    """
    joined = neighbours(robot)
    collide = {link.name for link in robot.links if link.self_collide}
    return {
        pair
        for one, other in combinations([link.name for link in robot.links], 2)
        if (pair := frozenset((one, other))) <= collide and pair not in joined
    }

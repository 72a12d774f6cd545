"""Which links of a robot are next to each other, and which may touch each other."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from wsgen.simulation.engine import Overlap

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.robot import Robot

TOUCHING = 1e-3  # m; PyBullet's margin around convex shapes: less than this is no overlap

Place = tuple[str, str]  # entity and link


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


def deepest_overlaps(
    found: Iterable[tuple[Place, Place, float]], robots: Mapping[str, Robot]
) -> list[Overlap]:
    """One overlap for each pair of links, of all that an engine finds between their shapes (m).

    Left out are the shapes of one link, links that a joint joins, and what only touches.
    """
    joined = {entity: neighbours(robot) for entity, robot in robots.items()}
    deepest: dict[tuple[Place, Place], float] = {}
    for one, other, depth in found:
        (entity, link), (other_entity, other_link) = pair = min(one, other), max(one, other)
        is_one = entity == other_entity and link == other_link
        is_joined = entity == other_entity and frozenset((link, other_link)) in joined[entity]
        if depth > TOUCHING and not (is_one or is_joined):
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
    return [Overlap(*one, *other, depth=depth) for (one, other), depth in deepest.items()]

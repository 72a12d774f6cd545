"""The robot that Gazebo builds from a URDF: fixed joints lumped, massless links dropped.

The rules are those of sdformat's `parser_urdf.cc` since its pull request 1238 (March 2023, in
12.7.2, 13.5 and 14.0); before it, a lumped link without mass also cut off its children.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description.dropping import (
    drop_massless,
    dropped_by_old_sdformat,
    dropped_links,
    impossible_sum,
    nothing_but_the_world,
    sdf_joint_ends,
    two_zero_masses,
    values_without_effect,
    without_inertia,
)
from wsgen.description.extensions import (
    collides_with_itself,
    is_static,
    with_extensions,
    with_springs,
)
from wsgen.description.lumping import bodies_of, joints_that_say
from wsgen.model.robot import JointLimit, JointType

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.description.lumping import Body
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Joint, Link, Robot

# Of a fixed joint whose lumping is disabled: no movement, by any force.
HELD = JointLimit(lower=0.0, upper=0.0, effort=-1.0, velocity=-1.0)
# Gazebo makes no joint of these: what hangs on them is loose.
LOOSE = frozenset((JointType.FLOATING, JointType.PLANAR))


def lump(robot: Robot, *, file: Path | None = None) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Lump fixed joints into their parents, drop what Gazebo drops, and do what its tags say.

    Poses, centres of mass and inertias of the result are seen from the links that are left, which
    keep their names and frames; the order of links and joints is kept. The robot must be a tree,
    as `read_urdf` gives it. `file` is what the diagnostics name.
    """
    bodies = bodies_of(robot)
    kept, dropped = drop_massless(robot, bodies)
    reported = {name for name, body in bodies.items() if body.has_error}
    diagnostics = [
        *nothing_but_the_world(robot, file),
        *sdf_joint_ends(robot, bodies, file),
        *dropped_by_old_sdformat(robot, bodies, kept, file),
        *dropped_links(
            robot, bodies, [name for name in dropped if not bodies[name].has_error], file
        ),
    ]
    tags = _tags_by_reference(robot)
    collides = collides_with_itself(robot.gazebo)
    links: dict[str, Link] = {}
    for name in kept:
        body = bodies[name]
        links[name] = _link_of(robot, body)
        about = [tag for part, _ in body.parts for tag in tags.get(part.name, ())]
        if name not in reported:
            diagnostics += two_zero_masses(robot, body, file)
            diagnostics += impossible_sum(body, links[name], file)
            diagnostics += without_inertia(body, links[name], file)
        if body.is_as_meant:
            diagnostics += values_without_effect(body, links[name], about, file)
        links[name] = with_extensions(links[name], about, self_collide=collides)
    joints = {joint.child: joint for name in kept for joint in bodies[name].joints}
    return _assembled(robot, bodies, links, joints, tags), tuple(diagnostics)


def _tags_by_reference(robot: Robot) -> dict[str, list[GazeboTag]]:
    tags: dict[str, list[GazeboTag]] = {}
    for tag in robot.gazebo:
        if tag.reference:
            tags.setdefault(tag.reference, []).append(tag)
    return tags


def _link_of(robot: Robot, body: Body) -> Link:
    """Gazebo makes no body of a root called `world`: what mass it is given counts for nothing."""
    is_world = robot.fixed_to_world and body.link.name == robot.root
    if len(body.parts) == 1:
        return replace(body.link, inertial=None) if is_world else body.link
    return replace(
        body.link,
        inertial=None if is_world else body.inertial(),
        visuals=body.visuals(),
        collisions=body.collisions(),
    )


def _assembled(
    robot: Robot,
    bodies: Mapping[str, Body],
    links: Mapping[str, Link],
    joints: Mapping[str, Joint],
    tags: Mapping[str, list[GazeboTag]],
) -> Robot:
    preserved = joints_that_say(robot, "preserveFixedJoint")
    held = joints_that_say(robot, "disableFixedJointLumping") - preserved
    body_of = {part.name: name for name, body in bodies.items() for part, _ in body.parts}
    left = [
        with_springs(_as_gazebo_has_it(joints[joint.child], held), tags.get(joint.name, ()))
        for joint in robot.joints
        if joint.child in joints and joint.child in links
    ]
    return replace(
        robot,
        links=tuple(links[link.name] for link in robot.links if link.name in links),
        joints=tuple(joint for joint in left if joint.type not in LOOSE),
        loose=tuple(joint for joint in left if joint.type in LOOSE),
        gazebo=tuple(
            replace(tag, reference=body_of.get(tag.reference or "", tag.reference))
            for tag in robot.gazebo
        ),
        is_static=is_static(robot.gazebo),
    )


def _as_gazebo_has_it(joint: Joint, held: set[str]) -> Joint:
    """A fixed joint whose lumping is disabled becomes a revolute one that cannot turn."""
    if joint.type is not JointType.FIXED or joint.name not in held:
        return joint
    return replace(joint, type=JointType.REVOLUTE, limit=HELD, axis_in_joint=(0.0, 0.0, 1.0))

"""The robot that Gazebo builds from a URDF: fixed joints lumped, massless links dropped.

The rules are those of sdformat's `parser_urdf.cc` since its pull request 1238 (March 2023, in
12.7.2, 13.5 and 14.0); before it, a lumped link without mass also cut off its children.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description.gazebo import is_true
from wsgen.description.lumping import (
    MASSLESS,
    Body,
    dropped_link,
    impossible_sum,
    two_zero_masses,
)
from wsgen.model.inertia import about_link_axes, is_possible, moved
from wsgen.model.pose import Pose
from wsgen.model.robot import Inertial, Joint, JointLimit, JointType, Link, Robot
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

HELD = JointLimit(lower=0.0, upper=0.0)  # of a fixed joint whose lumping is disabled


def lump(robot: Robot, *, file: Path | None = None) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Lump fixed joints into their parents and drop what Gazebo drops.

    Poses, centres of mass and inertias of the result are seen from the links that are left, which
    keep their names and frames; the order of links and joints is kept. The robot must be a tree,
    as `read_urdf` gives it. `file` is what the diagnostics name.
    """
    diagnostics: list[Diagnostic] = []
    bodies, merged_into = _merged(robot, file, diagnostics)
    kept, dropped = _drop_massless(robot, bodies)
    diagnostics += [dropped_link(robot, bodies, name, file) for name in dropped]
    for name in kept:
        diagnostics += impossible_sum(robot, bodies[name], file)
    return _assembled(robot, bodies, kept, merged_into), tuple(diagnostics)


def parts_of_impossible_sums(robot: Robot) -> set[str]:
    """The links that are fixed together to something whose inertia no body has.

    The robot must be a tree. A link that nothing is fixed to counts as well.
    """
    bodies, merged_into = _merged(robot, None, [])
    return {
        part
        for name, body in bodies.items()
        if name not in merged_into
        and body.link.inertial is not None
        and not is_possible(body.link.inertial.inertia)
        for part in (name, *body.lumped)
    }


def _merged(
    robot: Robot, file: Path | None, diagnostics: list[Diagnostic]
) -> tuple[dict[str, Body], dict[str, str]]:
    """What every link is after lumping, and which link each lumped one went into."""
    joint_to = {joint.child: _as_gazebo_has_it(joint, robot) for joint in robot.joints}
    bodies = {link.name: Body(link) for link in robot.links}
    merged_into: dict[str, str] = {}
    for name in reversed(_from_root_to_leaves(robot)[1:]):
        joint = joint_to[name]
        parent = bodies[joint.parent]
        if joint.type is JointType.FIXED and _is_lumped(joint, robot):
            diagnostics += two_zero_masses(parent.link, bodies[name].link, file)
            _merge(parent, bodies[name], joint.pose_in_parent)
            merged_into[name] = joint.parent
        else:
            parent.joints.append(joint)
    return bodies, merged_into


def _from_root_to_leaves(robot: Robot) -> list[str]:
    """The link names, every link behind its parent.

    Siblings go from the last joint name to the first: from the leaves to the root, they are then
    lumped in sdformat's order. No recursion, because a chain may have 10,000 links.
    """
    children: dict[str, list[str]] = {}
    for joint in sorted(robot.joints, key=lambda joint: joint.name, reverse=True):
        children.setdefault(joint.parent, []).append(joint.child)
    order = [robot.root]
    for name in order:
        order += children.get(name, ())
    return order


def _as_gazebo_has_it(joint: Joint, robot: Robot) -> Joint:
    """A fixed joint whose lumping is disabled becomes a revolute one that cannot turn."""
    if (
        joint.type is not JointType.FIXED
        or not _says(robot, joint, "disableFixedJointLumping")
        or _says(robot, joint, "preserveFixedJoint")  # which wins
    ):
        return joint
    return replace(joint, type=JointType.REVOLUTE, limit=HELD, axis_in_joint=(0.0, 0.0, 1.0))


def _is_lumped(joint: Joint, robot: Robot) -> bool:
    return not (robot.fixed_to_world and joint.parent == robot.root) and not _says(
        robot, joint, "preserveFixedJoint"
    )


def _says(robot: Robot, joint: Joint, key: str) -> bool:
    return any(is_true(tag.values.get(key)) for tag in robot.gazebo if tag.reference == joint.name)


def _merge(parent: Body, child: Body, pose: Pose) -> None:
    """Put the child, whose frame has this pose in the parent's, into the parent."""
    parent.lumped += [child.link.name, *child.lumped]
    parent.joints += [
        replace(
            joint,
            parent=parent.link.name,
            pose_in_parent=compose(pose, joint.pose_in_parent),
        )
        for joint in child.joints
    ]
    link = child.link
    parent.link = replace(
        parent.link,
        inertial=_sum(parent.link.inertial, _seen_from(link.inertial, pose)),
        visuals=parent.link.visuals
        + tuple(
            replace(visual, pose_in_link=compose(pose, visual.pose_in_link))
            for visual in link.visuals
        ),
        collisions=parent.link.collisions
        + tuple(
            replace(collision, pose_in_link=compose(pose, collision.pose_in_link))
            for collision in link.collisions
        ),
        self_collide=parent.link.self_collide or link.self_collide,
        gravity=parent.link.gravity and link.gravity,
    )


def _seen_from(inertial: Inertial | None, pose: Pose) -> Inertial | None:
    if inertial is None:
        return None
    return replace(inertial, pose_in_link=compose(pose, inertial.pose_in_link))


def _sum(parent: Inertial | None, child: Inertial | None) -> Inertial | None:
    """Both together, about the common centre of mass, along the axes of the link frame.

    A part without mass adds its inertia all the same, as in sdformat.
    """
    if parent is None or child is None:
        return parent or child
    mass = parent.mass + child.mass
    (x, y, z), (child_x, child_y, child_z) = parent.pose_in_link.xyz, child.pose_in_link.xyz
    share = child.mass / mass if mass else 0.0  # two zero masses are reported
    offset = ((child_x - x) * share, (child_y - y) * share, (child_z - z) * share)
    rest = 1 - share
    child_offset = ((child_x - x) * rest, (child_y - y) * rest, (child_z - z) * rest)
    ixx, ixy, ixz, iyy, iyz, izz = (
        one + other
        for one, other in zip(
            moved(about_link_axes(parent), parent.mass, offset),
            moved(about_link_axes(child), child.mass, child_offset),
            strict=True,
        )
    )
    return Inertial(
        mass=mass,
        pose_in_link=Pose(xyz=(x + offset[0], y + offset[1], z + offset[2])),
        inertia=(ixx, ixy, ixz, iyy, iyz, izz),
    )


def _drop_massless(robot: Robot, bodies: dict[str, Body]) -> tuple[list[str], list[str]]:
    """The links that stay, and those whose lack of mass cuts off what hangs on them."""
    kept, dropped, queue = [], [], [robot.root]
    for name in queue:
        inertial = bodies[name].link.inertial
        is_world = robot.fixed_to_world and name == robot.root
        if is_world or (inertial is not None and inertial.mass > MASSLESS):
            kept.append(name)
            queue += [joint.child for joint in bodies[name].joints]
        else:
            dropped.append(name)
    return kept, dropped


def _assembled(
    robot: Robot, bodies: dict[str, Body], kept: list[str], merged_into: dict[str, str]
) -> Robot:
    stays = set(kept)
    joints = {
        joint.child: joint for name in kept for joint in bodies[name].joints if joint.child in stays
    }

    def final(reference: str | None) -> str | None:
        while reference in merged_into:
            reference = merged_into[reference]
        return reference

    return replace(
        robot,
        links=tuple(
            _without_mass_of_world(robot, bodies[link.name].link)
            for link in robot.links
            if link.name in stays
        ),
        joints=tuple(joints[joint.child] for joint in robot.joints if joint.child in joints),
        gazebo=tuple(replace(tag, reference=final(tag.reference)) for tag in robot.gazebo),
    )


def _without_mass_of_world(robot: Robot, link: Link) -> Link:
    """Gazebo makes no body of a root called `world`: what mass it is given counts for nothing."""
    is_world = robot.fixed_to_world and link.name == robot.root
    return replace(link, inertial=None) if is_world else link

"""The robot that Gazebo builds from a URDF: fixed joints lumped, massless links dropped.

The rules are those of sdformat's `parser_urdf.cc` since its pull request 1238 (March 2023, in
12.7.2, 13.5 and 14.0); before it, a lumped link without mass also cut off its children.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from wsgen.description.gazebo import is_true
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.inertia import about_link_axes, is_possible, moved
from wsgen.model.pose import Pose
from wsgen.model.robot import Inertial, Joint, JointLimit, JointType, Link, Robot
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from pathlib import Path

MASSLESS = 1e-6  # kg; what sdformat's comparison with zero cannot tell from it
NAMED = 8  # so many names are told in a message
HELD = JointLimit(lower=0.0, upper=0.0)  # of a fixed joint whose lumping is disabled


@dataclass
class _Body:
    """A link that grows by what is fixed to it."""

    link: Link
    lumped: list[str] = field(default_factory=list)  # names, in the order of lumping
    joints: list[Joint] = field(default_factory=list)  # to children that stay links


def lump(robot: Robot, *, file: Path | None = None) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Lump fixed joints into their parents and drop what Gazebo drops.

    Poses, centres of mass and inertias of the result are seen from the links that are left, which
    keep their names and frames; the order of links and joints is kept. The robot must be a tree,
    as `read_urdf` gives it. `file` is what the diagnostics name.
    """
    diagnostics: list[Diagnostic] = []
    bodies, merged_into = _merged(robot, file, diagnostics)
    kept, dropped = _drop_massless(robot, bodies)
    diagnostics += [_dropped(robot, bodies, name, file) for name in dropped]
    for name in kept:
        diagnostics += _impossible_sum(robot, bodies[name], file)
    return _assembled(robot, bodies, kept, merged_into), tuple(diagnostics)


def is_impossible(inertial: Inertial) -> bool:
    """Whether no body of this mass has this inertia; that of a zero mass means nothing."""
    return inertial.mass > 0 and not is_possible(inertial.inertia)


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
) -> tuple[dict[str, _Body], dict[str, str]]:
    """What every link is after lumping, and which link each lumped one went into."""
    joint_to = {joint.child: _as_gazebo_has_it(joint, robot) for joint in robot.joints}
    bodies = {link.name: _Body(link) for link in robot.links}
    merged_into: dict[str, str] = {}
    for name in reversed(_from_root_to_leaves(robot)[1:]):
        joint = joint_to[name]
        parent = bodies[joint.parent]
        if joint.type is JointType.FIXED and _is_lumped(joint, robot):
            diagnostics += _two_zero_masses(parent.link, bodies[name].link, file)
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


def _merge(parent: _Body, child: _Body, pose: Pose) -> None:
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


def _drop_massless(robot: Robot, bodies: dict[str, _Body]) -> tuple[list[str], list[str]]:
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
    robot: Robot, bodies: dict[str, _Body], kept: list[str], merged_into: dict[str, str]
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


def _below(bodies: dict[str, _Body], name: str) -> list[str]:
    """The links that disappear with a link: those lumped into it, and all that hang on it."""
    queue = [name]
    for link in queue:
        queue += [joint.child for joint in bodies[link].joints]
    return [part for link in queue for part in (link, *bodies[link].lumped)][1:]


def _dropped(robot: Robot, bodies: dict[str, _Body], name: str, file: Path | None) -> Diagnostic:
    """What Gazebo leaves out; blamed is the link that was surely meant to have mass."""
    blamed = _lacks_mass(robot, bodies[name])
    why = f"`{blamed.name}` has " + (
        "no <inertial>" if blamed.inertial is None else f"a mass of {blamed.inertial.mass:g} kg"
    )
    if blamed.name != name:
        why += f", and `{name}`, which it is fixed to, has no mass either"
    below = [link for link in _below(bodies, name) if link != blamed.name]
    told = ", ".join(f"`{link}`" for link in below[:NAMED])
    told += f" and {len(below) - NAMED} more" if len(below) > NAMED else ""
    if name == robot.root:
        message = f"Gazebo refuses the robot: its root link {why}"
        if blamed.name != name:
            message = f"Gazebo refuses the robot: {why}"
        message += f"; with the root disappear {told}." if below else "."
    else:
        message = f"Gazebo drops the link `{name}` with the joint above it"
        message += f" and {told}: {why}." if below else f": {why}."
    return Diagnostic(
        code="ROB040",
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=blamed.line,
        element=f"link[@name='{blamed.name}']",
        hint=f"Give `{blamed.name}` an <inertial> with a mass above {MASSLESS:g} kg"
        + (", or fix a link with mass to it by a fixed joint." if blamed.name == name else "."),
    )


def _lacks_mass(robot: Robot, body: _Body) -> Link:
    """The part of a massless body that should have mass.

    That is one whose <inertial> says 0, or one that can be touched or seen; else the body's own
    link, which is nothing but a frame.
    """
    links = {link.name: link for link in robot.links}
    parts = [links[name] for name in (body.link.name, *body.lumped)]
    return next(
        (part for part in parts if part.inertial is not None),
        next((part for part in parts if part.collisions or part.visuals), parts[0]),
    )


def _two_zero_masses(parent: Link, child: Link, file: Path | None) -> list[Diagnostic]:
    """Gazebo computes the common centre of two zero masses as 0/0 and refuses the robot."""
    if parent.inertial is None or child.inertial is None:
        return []
    if parent.inertial.mass or child.inertial.mass:
        return []
    return [
        Diagnostic(
            code="ROB041",
            severity=Severity.ERROR,
            message=f"The links `{child.name}` and `{parent.name}` are fixed together and both "
            "have a mass of 0: their centre of mass is not a number, and Gazebo refuses the robot.",
            file=file,
            line=child.line,
            element=f"link[@name='{child.name}']/inertial/mass",
            hint=f"Remove <inertial> from `{child.name}`: no inertia is better than a zero mass.",
        )
    ]


def _impossible_sum(robot: Robot, body: _Body, file: Path | None) -> list[Diagnostic]:
    """The reader has judged single links; here the sum of sound ones is new."""
    inertial = body.link.inertial
    if not body.lumped or inertial is None or is_possible(inertial.inertia):
        return []
    parts = {body.link.name, *body.lumped}
    written = [link.inertial for link in robot.links if link.name in parts]
    if any(part is not None and is_impossible(part) for part in written):
        return []
    return [
        Diagnostic(
            code="ROB042",
            severity=Severity.ERROR,
            message=f"With the links that are fixed to it, `{body.link.name}` has an inertia that "
            "no body has, and Gazebo refuses the robot.",
            file=file,
            line=body.link.line,
            element=f"link[@name='{body.link.name}']",
            hint=f"Correct the inertia of {', '.join(f'`{name}`' for name in body.lumped[:NAMED])}"
            f" or of `{body.link.name}` itself.",
        )
    ]

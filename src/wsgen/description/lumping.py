"""Which links Gazebo makes one body of, and what the body weighs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from wsgen.description.extensions import is_true
from wsgen.model.inertia import about_link_axes, is_possible, moved
from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import Inertial, JointType
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from wsgen.model.inertia import Six
    from wsgen.model.robot import Collision, Joint, Link, Robot, Visual

NO_MASS = 1e-6  # kg; sdformat before its pull request 1238 took less for nothing
WORLD = "world"  # sdformat's word for what never moves; it knows no other way to say so in a URDF


@dataclass
class Body:
    """A link with what is fixed to it, in sdformat's order: depth first, by the joints' names."""

    parts: list[tuple[Link, Pose]]  # the link itself first; poses in its frame
    joints: list[Joint] = field(default_factory=list)  # to other bodies, seen from its frame
    massless: list[str] = field(default_factory=list)  # lumped with what is fixed to them: 0 kg
    two_zeros: tuple[str, str] | None = None  # parent and child of a sum of two masses of 0

    @property
    def link(self) -> Link:
        """The link whose name and frame the body keeps."""
        return self.parts[0][0]

    @property
    def lumped(self) -> list[str]:
        """The names of the others."""
        return [link.name for link, _ in self.parts[1:]]

    @property
    def is_as_meant(self) -> bool:
        """Whether all its links were understood."""
        return all(link.is_as_meant for link, _ in self.parts)

    @property
    def has_error(self) -> bool:
        """Whether an error has been reported about one of its links."""
        return any(link.has_error for link, _ in self.parts)

    @property
    def mass(self) -> float:
        """The sum of the masses, kg."""
        return sum(link.inertial.mass for link, _ in self.parts if link.inertial is not None)

    def inertial(self) -> Inertial | None:
        """All together, about the common centre of mass, along the axes of the link frame.

        A part without mass adds its inertia all the same, as in sdformat.
        """
        parts = [
            replace(link.inertial, pose_in_link=compose(pose, link.inertial.pose_in_link))
            for link, pose in self.parts
            if link.inertial is not None
        ]
        return parts[0] if len(parts) == 1 else _sum(parts) if parts else None

    def visuals(self) -> tuple[Visual, ...]:
        """What can be seen, in the body's frame; the lumped ones are named as sdformat does."""
        return tuple(
            replace(
                visual,
                pose_in_link=compose(pose, visual.pose_in_link),
                name=visual.name if link is self.link else visual.name or link.name,
            )
            for link, pose in self.parts
            for visual in link.visuals
        )

    def collisions(self) -> tuple[Collision, ...]:
        """What can be touched, likewise."""
        return tuple(
            replace(
                collision,
                pose_in_link=compose(pose, collision.pose_in_link),
                name=collision.name if link is self.link else collision.name or link.name,
            )
            for link, pose in self.parts
            for collision in link.collisions
        )


def bodies_of(robot: Robot) -> dict[str, Body]:
    """The bodies by the names of their first links, parents before children.

    No recursion, and nothing is moved twice: a chain may have 10,000 links.
    """
    below: dict[str, list[Joint]] = {}
    for joint in sorted(robot.joints, key=lambda joint: joint.name):
        below.setdefault(joint.parent, []).append(joint)
    kept = _kept_joints(robot)
    links = {link.name: link for link in robot.links}
    bodies = {robot.root: Body([(links[robot.root], IDENTITY)])}
    stack = [(robot.root, bodies[robot.root], IDENTITY)]
    while stack:
        name, body, pose = stack.pop()
        if name != body.link.name:
            body.parts.append((links[name], pose))
        for joint in reversed(below.get(name, ())):
            place = compose(pose, joint.pose_in_parent)
            if joint.type is JointType.FIXED and joint.name not in kept:
                stack.append((joint.child, body, place))
                continue
            bodies[joint.child] = Body([(links[joint.child], IDENTITY)])
            body.joints.append(replace(joint, parent=body.link.name, pose_in_parent=place))
            stack.append((joint.child, bodies[joint.child], IDENTITY))
    _add_up_masses(robot, below, kept, bodies)
    return bodies


def parts_of_impossible_sums(robot: Robot) -> set[str]:
    """The links that are fixed together to something whose inertia no body has.

    The robot must be a tree. A link that nothing is fixed to counts as well.
    """
    return {
        part.name
        for body in bodies_of(robot).values()
        if (inertial := body.inertial()) is not None
        and inertial.mass > 0
        and not is_possible(inertial.inertia)
        for part, _ in body.parts
    }


def joints_that_say(robot: Robot, key: str) -> set[str]:
    """The names of the joints about which a `<gazebo>` element says that this is true."""
    return {
        tag.reference
        for tag in robot.gazebo
        if tag.reference is not None and is_true(tag.values.get(key))
    }


def _kept_joints(robot: Robot) -> set[str]:
    """The fixed joints that sdformat does not lump."""
    return (
        joints_that_say(robot, "preserveFixedJoint")
        | joints_that_say(robot, "disableFixedJointLumping")
        | {joint.name for joint in robot.joints if robot.fixed_to_world and joint.parent == WORLD}
    )


def _add_up_masses(
    robot: Robot, below: dict[str, list[Joint]], kept: set[str], bodies: dict[str, Body]
) -> None:
    """Note which lumped links have no mass, and where a common centre of mass becomes 0/0.

    sdformat puts every link into its parent when all below it are done; a parent without <inertial>
    counts as 0 kg there.
    """
    masses = {
        link.name: None if link.inertial is None else link.inertial.mass for link in robot.links
    }
    order = list(bodies)[:1]
    body_of = {name: body for body in bodies.values() for name in (body.link.name, *body.lumped)}
    for name in order:
        order += [joint.child for joint in reversed(below.get(name, ()))]
    parent_of = {joint.child: joint for joint in robot.joints}
    for child in reversed(order[1:]):
        joint, mass = parent_of[child], masses[child]
        if joint.type is not JointType.FIXED or joint.name in kept:
            continue
        if (mass or 0.0) < NO_MASS:
            body_of[child].massless.append(child)
        if mass is None:
            continue
        total = (masses[joint.parent] or 0.0) + mass
        masses[joint.parent] = total
        body = body_of[child]
        if total == 0 and body.two_zeros is None:
            body.two_zeros = (joint.parent, child)


def _sum(parts: list[Inertial]) -> Inertial:
    mass = sum(part.mass for part in parts)
    if not mass:  # there is no centre, and Gazebo makes no body of it
        return replace(parts[0], mass=0.0)
    x, y, z = (
        sum(part.mass * part.pose_in_link.xyz[axis] for part in parts) / mass for axis in range(3)
    )
    moments: list[Six] = [
        moved(
            about_link_axes(part),
            part.mass,
            (
                part.pose_in_link.xyz[0] - x,
                part.pose_in_link.xyz[1] - y,
                part.pose_in_link.xyz[2] - z,
            ),
        )
        for part in parts
    ]
    ixx, ixy, ixz, iyy, iyz, izz = map(sum, zip(*moments, strict=True))
    return Inertial(
        mass=mass,
        pose_in_link=Pose(xyz=(x, y, z)),
        inertia=(ixx, ixy, ixz, iyy, iyz, izz),
    )

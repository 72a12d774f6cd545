"""The robot that Gazebo builds from a URDF: fixed joints lumped, massless links dropped.

The rules are those of sdformat's `parser_urdf.cc` since its pull request 1238 (March 2023, in
9.10.1, 12.7.2, 13.5 and 14.0), and those before it: there a lumped link without mass also cuts off
its children. What Gazebo leaves out, or refuses, on the way is reported.
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import IMPOSSIBLE_INERTIA, NO_LINK
from wsgen.descriptions.urdf.extensions import HELD, LOOSE, extend_joints, extend_links, is_static
from wsgen.descriptions.urdf.gazebo import (
    NOT_SIMULATED_HINT,
    NOT_SIMULATED_MESSAGE,
    SDF_NOT_SIMULATED,
)
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.inertia import (
    about_link_axes,
    as_attributes,
    if_filled,
    is_positive_definite,
    is_possible,
    moved,
)
from wsgen.model.robot import Inertial, Joint, JointType, Link, by_parent
from wsgen.model.transform import IDENTITY, Pose, compose
from wsgen.text.suggestions import some_named
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.inertia import Six
    from wsgen.model.robot import Collision, GazeboTag, Robot, Visual


NO_MASS = 1e-6  # kg; sdformat before its pull request 1238 took less for 0
WORLD = "world"  # sdformat's word for what never moves; it knows no other way to say so in a URDF
NAMED = 8  # at most so many names stand in a message
OF_ODE = (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)  # kg m²
DROPPED_LINK = Rule(
    code="ROB040",
    name="dropped-link",
    severity=Severity.ERROR,
    severity_varies="a warning for links that are only frames, or are fixed to the world and carry "
    "nothing, such as a plate under an arm, and from `wsgen check` where nothing in the workspace "
    "uses Gazebo",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="Gazebo drops a link without mass and everything that is attached to it.",
    why="`sdformat` drops a link without mass unless a fixed joint attaches it to a link with "
    "mass. The robot in Gazebo lacks the link, its joint and everything below it; older "
    "versions do not print a warning. wsgen simulates what is left for Gazebo Classic.",
    example='<link name="wheel">\n  <collision>…</collision>\n</link>',
    instead='<link name="wheel">\n'
    "  <inertial>\n"
    '    <mass value="0.5"/>\n'
    '    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>\n'
    "  </inertial>\n"
    "  <collision>…</collision>\n"
    "</link>",
)

TWO_ZERO_MASSES = Rule(
    code="ROB041",
    name="two-zero-masses",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="refuses it"),
    summary="Two links of mass 0 are attached by a fixed joint.",
    why="`sdformat` lumps them and divides by their total mass: the center of mass is not a "
    "number, and Gazebo refuses the robot.",
    example="<inertial>\n"
    '  <mass value="0"/>\n'
    '  <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>\n'
    "</inertial>",
    instead="Remove the `<inertial>` of links that are only frames.",
)

IMPOSSIBLE_SUM = Rule(
    code="ROB042",
    name="impossible-sum",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, which still loads the robot",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="The total inertia of links that are connected by fixed joints is impossible.",
    why="`sdformat` lumps the links into one body, and Gazebo Sim refuses a robot with a body of "
    "impossible inertia.",
    example="<inertial>\n"
    '  <mass value="0"/>\n'
    '  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/>\n'
    "</inertial>",
    instead="Remove the `<inertial>` of the link without mass, or correct it.",
)

GAZEBO_VALUE_WITHOUT_EFFECT = Rule(
    code="ROB046",
    name="gazebo-value-without-effect",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A surface value in a `<gazebo>` element does not apply to a collision.",
    why="`sdformat` finds the collisions of a link by the names that it generates. A collision "
    "with a `name` that does not begin with that of its link is not found, and keeps the "
    "default friction.",
    example='<link name="wheel">\n'
    '  <collision name="rubber">…</collision>\n'
    "</link>\n"
    '<gazebo reference="wheel">\n'
    "  <mu1>0.2</mu1>\n"
    "</gazebo>",
    instead='<link name="wheel">\n'
    "  <collision>…</collision>\n"
    "</link>\n"
    '<gazebo reference="wheel">\n'
    "  <mu1>0.2</mu1>\n"
    "</gazebo>",
)

UNKNOWN_END_OF_SDF_JOINT = Rule(
    code="ROB078",
    name="unknown-end-of-sdf-joint",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates what is left", sim="refuses it"),
    summary="An SDF joint in a `<gazebo>` element names a link that does not exist.",
    why="Gazebo adds the joint to the robot, and then refuses the robot because the link does not "
    "exist.",
    example="<gazebo>\n"
    '  <joint name="closing_joint" type="revolute">\n'
    "    <parent>arm</parent>\n"
    "    <child>hnad</child>\n"
    "  </joint>\n"
    "</gazebo>",
    instead="<gazebo>\n"
    '  <joint name="closing_joint" type="revolute">\n'
    "    <parent>arm</parent>\n"
    "    <child>hand</child>\n"
    "  </joint>\n"
    "</gazebo>",
)

LUMPED_END_OF_SDF_JOINT = Rule(
    code="ROB079",
    name="lumped-end-of-sdf-joint",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="An SDF joint in a `<gazebo>` element names a link that is lumped into another one.",
    why="Gazebo Sim with sdformat before 12.7 and 13.1 (Debian 12 and Ubuntu 22.04 have such "
    "versions) does not find the lumped link, and refuses the robot.",
    example="<gazebo>\n"
    '  <joint name="closing_joint" type="revolute">\n'
    "    <parent>arm</parent>\n"
    "    <child>flange</child>\n"
    "  </joint>\n"
    "</gazebo>",
    instead='<gazebo reference="flange_joint">\n'
    "  <preserveFixedJoint>true</preserveFixedJoint>\n"
    "</gazebo>",
)

DROPPED_BY_OLD_SDFORMAT = Rule(
    code="ROB080",
    name="dropped-by-old-sdformat",
    severity=Severity.WARNING,
    severity_varies="an error in Gazebo Classic, which Ubuntu 22.04 has with such a version",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="Older versions of sdformat drop links on movable joints of a link without mass.",
    why="`sdformat` before 9.10.1, 12.7.2 and 13.5 (Debian 12 and Ubuntu 22.04 have such "
    "versions) drops every link that is attached to a lumped link without mass by a "
    "movable joint.",
    example='<link name="wheel_mount"/>\n'
    '<joint name="mount_joint" type="fixed">…</joint>\n'
    '<joint name="wheel_joint" type="continuous">\n'
    '  <parent link="wheel_mount"/>\n'
    '  <child link="wheel"/>\n'
    "</joint>",
    instead='<joint name="wheel_joint" type="continuous">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="wheel"/>\n'
    "</joint>",
)


def lump(
    robot: Robot, *, file: Path | None = None, for_classic: bool = False
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Lump fixed joints into their parents, drop what Gazebo drops, apply its tags.

    Poses, centers of mass and inertias of the result are seen from the links that are left, which
    keep their names and frames; the order of links and joints is kept. The robot must be a tree,
    as `read_urdf` gives it. `file` is what the diagnostics name. For Gazebo Classic, the rules are
    those before sdformat's pull request 1238, and inertias those of its engine.
    """
    bodies = _bodies_of(robot)
    kept, dropped = _drop_massless(robot, bodies, NO_MASS if for_classic else 0.0)
    below_massless = list(_below_massless(robot, bodies, kept))
    if for_classic:
        lost = {link for _, _, links in below_massless for link in links}
        kept = [name for name in kept if name not in lost]
    reported = {name for name, body in bodies.items() if body.has_error}
    diagnostics = [
        *_only_world(robot, file),
        *_check_sdf_joints(robot, bodies, file),
        *_dropped_by_old_sdformat(robot, bodies, below_massless, file),
        *_report_dropped(
            robot, bodies, [name for name in dropped if not bodies[name].has_error], file
        ),
    ]
    links: dict[str, Link] = {}
    for name in kept:
        body = bodies[name]
        links[name] = _link_of(robot, body)
        if name not in reported:
            diagnostics += _two_zero_masses(robot, body, file)
            diagnostics += _impossible_sum(body, links[name], file)
            diagnostics += _without_inertia(body, links[name], file, for_classic=for_classic)
        if for_classic:
            links[name] = _with_inertia_of_ode(links[name])
    parts = {name: [part.name for part, _ in bodies[name].parts] for name in kept}
    extended = extend_links(links, parts, robot.gazebo)
    for name, (link, without_effect) in extended.items():
        links[name] = link
        if bodies[name].is_as_meant:
            diagnostics += _values_without_effect(bodies[name], without_effect, file)
    joints = {joint.child: joint for name in kept for joint in bodies[name].joints}
    lumped = _assembled(robot, bodies, links, joints)
    lumped = hold_kinematic(lumped) if for_classic else lumped
    return lumped, (*diagnostics, *_balls_not_simulated(lumped, file))


def _link_of(robot: Robot, body: Body) -> Link:
    """The link of a body; Gazebo makes none of a root called `world`, whose mass it ignores."""
    is_world = robot.fixed_to_world and body.link.name == robot.root
    if len(body.parts) == 1:
        return replace(body.link, inertial=None) if is_world else body.link
    return replace(
        body.link,
        inertial=None if is_world else body.inertial(),
        visuals=body.visuals(),
        collisions=body.collisions(),
    )


def _with_inertia_of_ode(link: Link) -> Link:
    """ODE takes 1 kg m² about each axis where the moments are not all positive."""
    if link.inertial is None or is_positive_definite(link.inertial.inertia):
        return link
    return replace(link, inertial=replace(link.inertial, inertia=OF_ODE))


def _assembled(
    robot: Robot,
    bodies: Mapping[str, Body],
    links: Mapping[str, Link],
    joints: Mapping[str, Joint],
) -> Robot:
    body_of = {part.name: name for name, body in bodies.items() for part, _ in body.parts}
    left = extend_joints(
        (joints[one.child] for one in robot.joints if one.child in joints and one.child in links),
        robot.gazebo,
        body_of,
    )
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
        gazebo_order=tuple(joints[name].name for name in bodies if name in joints),
    )


def that_stay(robot: Robot) -> set[str]:
    """The kinematic links of the root, or of a chain of such links from the root or the world."""
    kinematic = {link.name for link in robot.links if link.is_kinematic}
    if not kinematic:
        return kinematic
    below = by_parent(robot.joints)
    queue = [robot.root] if robot.fixed_to_world or robot.root in kinematic else []
    for name in queue:
        queue += kinematic.intersection(joint.child for joint in below.get(name, ()))
    return kinematic.intersection(queue)


def hold_kinematic(robot: Robot) -> Robot:
    """The robot of Gazebo Classic, where kinematic links stay where they are.

    Such a root is fixed to the world, and the joint between a link that stays and a kinematic one
    cannot move. A kinematic link that moving ones carry is left as it is.
    """
    stay = that_stay(robot)
    joints = tuple(
        replace(
            joint,
            type=joint.type if joint.type is JointType.PRISMATIC else JointType.REVOLUTE,
            limit=HELD,
        )
        if joint.is_movable and joint.child in stay
        else joint
        for joint in robot.joints
    )
    if robot.root not in stay:
        return replace(robot, joints=joints)
    foot = Joint(name=f"{robot.root}_held", type=JointType.FIXED, parent=WORLD, child=robot.root)
    return replace(
        robot,
        root=WORLD,
        links=(Link(name=WORLD), *robot.links),
        joints=(foot, *joints),
        fixed_to_world=True,
    )


def _balls_not_simulated(lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Ball joints of SDF in `<gazebo>` that hold nothing that would be loose without them."""
    made = {joint.line for joint in lumped.joints if joint.type is JointType.BALL}
    for joint in (joint for tag in lumped.gazebo for joint in tag.joints if joint.is_ball):
        if joint.line not in made:
            yield SDF_NOT_SIMULATED.at(
                file,
                joint.line,
                "gazebo/joint",
                message=NOT_SIMULATED_MESSAGE.format("joint"),
                hint=NOT_SIMULATED_HINT,
            )


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
        """All together, about the common center of mass, along the axes of the link frame.

        A part without mass adds its inertia all the same, as in sdformat.
        """
        parts = [
            replace(link.inertial, pose_in_link=compose(pose, link.inertial.pose_in_link))
            for link, pose in self.parts
            if link.inertial is not None
        ]
        return parts[0] if len(parts) == 1 else _sum(parts) if parts else None

    def visuals(self) -> tuple[Visual, ...]:
        """The visuals in the body's frame; the lumped ones are named as sdformat does."""
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
        """The collisions, likewise."""
        return tuple(
            replace(
                collision,
                pose_in_link=compose(pose, collision.pose_in_link),
                name=collision.name if link is self.link else collision.name or link.name,
            )
            for link, pose in self.parts
            for collision in link.collisions
        )


def _bodies_of(robot: Robot) -> dict[str, Body]:
    """The bodies by the names of their first links, in sdformat's order: parents before children.

    No recursion, and nothing is moved twice: a chain may have 10,000 links.
    """
    below = by_parent(sorted(robot.joints, key=lambda joint: joint.name))
    kept = _kept_joints(robot)
    links = {link.name: link for link in robot.links}
    bodies: dict[str, Body] = {}
    stack = [(robot.root, Body([(links[robot.root], IDENTITY)]), IDENTITY)]
    while stack:
        name, body, pose = stack.pop()
        if name != body.link.name:
            body.parts.append((links[name], pose))
        else:
            bodies[name] = body
        for joint in reversed(below.get(name, ())):
            place = compose(pose, joint.pose_in_parent)
            if joint.type is JointType.FIXED and joint.name not in kept:
                stack.append((joint.child, body, place))
                continue
            body.joints.append(replace(joint, parent=body.link.name, pose_in_parent=place))
            stack.append((joint.child, Body([(links[joint.child], IDENTITY)]), IDENTITY))
    _add_up_masses(robot, below, kept, bodies)
    return bodies


def _kept_joints(robot: Robot) -> set[str]:
    """The fixed joints that sdformat does not lump."""
    return {
        joint.name
        for joint in robot.joints
        if joint.kept_by or (robot.fixed_to_world and joint.parent == WORLD)
    }


def _add_up_masses(
    robot: Robot, below: dict[str, list[Joint]], kept: set[str], bodies: dict[str, Body]
) -> None:
    """Note which lumped links have no mass, and where a common center of mass becomes 0/0.

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
    if not mass:  # there is no center, and Gazebo makes no body of it
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


def parts_of_impossible_sums(robot: Robot) -> set[str]:
    """The links that are fixed together to something whose inertia no body has.

    The robot must be a tree. A link that nothing is fixed to counts as well.
    """
    return {
        part.name
        for body in _bodies_of(robot).values()
        if (inertial := body.inertial()) is not None
        and inertial.mass > 0
        and not is_possible(inertial.inertia)
        for part, _ in body.parts
    }


def is_impossible(inertial: Inertial) -> bool:
    """Whether no body of this mass has this inertia; that of a zero mass means nothing."""
    return inertial.mass > 0 and not is_possible(inertial.inertia)


def _drop_massless(
    robot: Robot, bodies: Mapping[str, Body], no_mass: float
) -> tuple[list[str], list[str]]:
    """The bodies that stay, and those whose lack of mass cuts off what hangs on them."""
    kept, dropped, queue = [], [], [robot.root]
    for name in queue:
        is_world = robot.fixed_to_world and name == robot.root
        if is_world or bodies[name].mass > no_mass:
            kept.append(name)
            queue += [joint.child for joint in bodies[name].joints]
        else:
            dropped.append(name)
    return kept, dropped


def _only_world(robot: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """A root called `world` does not count as a link."""
    if robot.fixed_to_world and len(robot.links) == 1:
        yield NO_LINK.at(
            file,
            robot.links[0].line,
            "link[@name='world']",
            message="The robot has no link besides `world`: Gazebo refuses it.",
            hint="Attach a link to `world` by a joint, or rename it.",
        )


def _check_sdf_joints(
    robot: Robot, bodies: Mapping[str, Body], file: Path | None
) -> Iterator[Diagnostic]:
    """Joints of SDF in `<gazebo>` whose parent or child is no link of the model."""
    body_of = {part.name: name for name, body in bodies.items() for part, _ in body.parts}
    if any(tag.is_open for tag in robot.gazebo):
        return
    others = {joint.name for joint in robot.joints} | {"world", "__model__"}
    others |= {name for tag in robot.gazebo for name in tag.frames}
    above = {joint.child: joint.name for joint in robot.joints}
    for joint in (joint for tag in robot.gazebo for joint in tag.joints):
        for end, link in joint.ends.items():
            name = body_of.get(link)
            if name == link or link in others or "::" in link:
                continue
            what = f"The SDF joint `{joint.name}` in <gazebo> has `{link}` as {end}"
            place = f"gazebo/joint[@name='{joint.name}']/{end}"
            if name is None:
                yield UNKNOWN_END_OF_SDF_JOINT.at(
                    file,
                    joint.line,
                    place,
                    message=f"{what}, which does not exist: Gazebo refuses the robot.",
                    hint="Name a link of this robot.",
                )
            else:
                yield LUMPED_END_OF_SDF_JOINT.at(
                    file,
                    joint.line,
                    place,
                    message=f"{what}, which is lumped into `{name}`: Gazebo Sim with sdformat "
                    "before 12.7 and 13.1 (Debian 12 and Ubuntu 22.04 have such) refuses the "
                    "robot.",
                    hint=f'Write <gazebo reference="{above[link]}"><preserveFixedJoint>true'
                    f"</preserveFixedJoint></gazebo>, or name `{name}`.",
                )


def _below_massless(
    robot: Robot, bodies: Mapping[str, Body], kept: Sequence[str]
) -> Iterator[tuple[str, str, list[str]]]:
    """Bodies, links without mass lumped into them, and what older versions drop with these."""
    joints = by_parent(robot.joints)
    for name in kept:
        for massless in reversed(bodies[name].massless):
            below = [massless]
            for link in below:
                below += [joint.child for joint in joints.pop(link, ())]
            yield name, massless, [link for link in below if link in bodies]


def _dropped_by_old_sdformat(
    robot: Robot,
    bodies: Mapping[str, Body],
    below_massless: Iterable[tuple[str, str, list[str]]],
    file: Path | None,
) -> Iterator[Diagnostic]:
    """What hangs on a lumped link without mass, which older versions drop with it."""
    links = {link.name: link for link in robot.links}
    for name, massless, lost in below_massless:
        mass = sum(bodies[link].mass for link in lost)
        if mass and bodies[name].is_as_meant:
            yield DROPPED_BY_OLD_SDFORMAT.at(
                file,
                links[massless].line,
                f"link[@name='{massless}']",
                message=f"`{massless}` has no mass, and sdformat before 9.10.1, 12.7.2 and "
                "13.5 (Debian 12 and Ubuntu 22.04 have such) drops the links on its movable "
                f"joints: {some_named(lost, NAMED)}, {mass:.4g} kg.",
                hint=f"Add an <inertial> with a small mass to `{massless}`, or attach "
                f"{some_named(lost[:1], NAMED)} to `{name}`.",
            )


def _report_dropped(
    robot: Robot, bodies: Mapping[str, Body], names: Sequence[str], file: Path | None
) -> Iterator[Diagnostic]:
    """What Gazebo drops; blamed is the link that was surely meant to have mass."""
    is_all = set(names) >= bodies.keys() - {WORLD}
    for name in names:
        blamed = _lacks_mass(bodies[name])
        message = _dropped_message(robot, bodies, name, blamed)
        if is_all and name != robot.root:
            message += " No link is left, and Gazebo refuses the robot."
        yield DROPPED_LINK.at(
            file,
            blamed.line,
            f"link[@name='{blamed.name}']",
            message=message,
            hint=f"Write the mass of `{blamed.name}` in kilograms."
            if blamed.inertial is not None
            else f"Add an <inertial> with a mass to `{blamed.name}`"
            + (
                ", or attach a link with mass to it by a fixed joint."
                if blamed.name == name
                else "."
            ),
            severity=Severity.WARNING
            if not is_all and (_is_scenery(bodies, name) or _is_frame(robot, bodies, name))
            else None,
        )


def _is_scenery(bodies: Mapping[str, Body], name: str) -> bool:
    """Whether a body is fixed to the world and carries none: the robot moves as well without."""
    on_the_world = bodies[WORLD].joints if WORLD in bodies else ()
    return not bodies[name].joints and any(
        joint.child == name and joint.type is JointType.FIXED for joint in on_the_world
    )


def _is_frame(robot: Robot, bodies: Mapping[str, Body], name: str) -> bool:
    """Whether only frames are dropped with a body: nothing to see or touch, that moves or is used.

    A plugin or a sensor uses what it is in or names.
    """
    lost = {name, *_below(bodies, name)}
    plugins = [plugin for tag in robot.gazebo for plugin in tag.plugins]
    return not (
        any(link.visuals or link.collisions for link in robot.links if link.name in lost)
        or any(joint.is_movable for joint in robot.joints if joint.child in lost)
        or any((tag.sensors or tag.plugins) and tag.reference in lost for tag in robot.gazebo)
        or any(lost.intersection(texts) for one in plugins for texts in one.values.values())
    )


def _dropped_message(robot: Robot, bodies: Mapping[str, Body], name: str, blamed: Link) -> str:
    why = f"`{blamed.name}` has " + (
        "no <inertial>" if blamed.inertial is None else f"a mass of {blamed.inertial.mass:g} kg"
    )
    if blamed.name != name:
        why += f", and `{name}`, which a fixed joint attaches it to, has no mass either"
    below = [link for link in _below(bodies, name) if link != blamed.name]
    names_below = some_named(below, NAMED)
    if name == robot.root:
        message = f"Gazebo refuses the robot: its root link {why}"
        if blamed.name != name:
            message = f"Gazebo refuses the robot: {why}"
        return message + (f". It drops {names_below} with the root." if below else ".")
    message = f"Gazebo drops the link `{name}` with the joint above it"
    return message + (f" and {names_below}: {why}." if below else f": {why}.")


def _below(bodies: Mapping[str, Body], name: str) -> list[str]:
    """The links that disappear with a link: those lumped into it, and all that hang on it."""
    queue = [name]
    for link in queue:
        queue += [joint.child for joint in bodies[link].joints]
    return [part.name for link in queue for part, _ in bodies[link].parts][1:]


def _lacks_mass(body: Body) -> Link:
    """The part of a massless body that should have mass.

    That is one whose <inertial> says 0, or one that has a shape; else the body's own link, which is
    only a frame.
    """
    parts = [part for part, _ in body.parts]
    return next(
        (part for part in parts if part.inertial is not None),
        next((part for part in parts if part.collisions or part.visuals), parts[0]),
    )


def _two_zero_masses(robot: Robot, body: Body, file: Path | None) -> Iterator[Diagnostic]:
    """Gazebo computes the common center of two zero masses as 0/0 and refuses the robot."""
    if body.two_zeros is None or (robot.fixed_to_world and body.link.name == robot.root):
        return
    parent, child = body.two_zeros
    links = {part.name: part for part, _ in body.parts}
    blamed = links[child] if links[child].inertial is not None else links[parent]
    yield TWO_ZERO_MASSES.at(
        file,
        blamed.line,
        f"link[@name='{blamed.name}']/inertial/mass",
        message=f"The links `{child}` and `{parent}` are connected by a fixed joint and have no "
        "mass: their center of mass is not a number, and Gazebo refuses the robot.",
        hint=f"Remove <inertial> from `{blamed.name}`: Gazebo accepts a lumped link without one.",
    )


def _impossible_sum(body: Body, link: Link, file: Path | None) -> Iterator[Diagnostic]:
    """A sum that is impossible although each part is possible; the reader checks single links."""
    if len(body.parts) == 1 or link.inertial is None or is_possible(link.inertial.inertia):
        return
    if any(part.inertial is not None and is_impossible(part.inertial) for part, _ in body.parts):
        return
    yield IMPOSSIBLE_SUM.at(
        file,
        link.line,
        f"link[@name='{link.name}']",
        message=f"Together with the links that fixed joints attach to it, `{link.name}` has an "
        "impossible inertia: Gazebo Sim refuses the robot.",
        hint=f"Correct the inertia of {', '.join(f'`{name}`' for name in body.lumped[:NAMED])}"
        f" or of `{link.name}` itself.",
    )


def _without_inertia(
    body: Body, lumped: Link, file: Path | None, *, for_classic: bool
) -> Iterator[Diagnostic]:
    """A mass without any inertia, on which engines diverge; `lumped` is all of the body."""
    if lumped.inertial is None or any(lumped.inertial.inertia):
        return
    # The link that is written with that mass, which may be another one than gives the name.
    link = next(part for part, _ in body.parts if part.inertial is not None)
    yield IMPOSSIBLE_INERTIA.at(
        file,
        link.line,
        f"link[@name='{link.name}']/inertial/inertia",
        severity=Severity.WARNING,
        message=f"The link `{link.name}` has a mass of {lumped.inertial.mass:g} kg and no inertia: "
        + (
            "Gazebo Classic takes 1 kg m² about each axis."
            if for_classic
            else "every contact makes it spin."
        ),
        hint="Compute the inertia from mass and shape, or export it from CAD."
        if (moments := if_filled(link)) is None
        else f"If the mass is right and the body homogeneous, write {as_attributes(moments)} (kg "
        "m², products 0).",
    )


def _values_without_effect(
    body: Body, without_effect: Sequence[tuple[GazeboTag, str]], file: Path | None
) -> Iterator[Diagnostic]:
    """Gazebo finds the collisions that a value is for by their names, and may find none."""
    link = body.link
    for tag, key in without_effect:
        about = next(part for part, _ in body.parts if part.name == tag.reference)
        if not about.collisions:
            continue
        where = "" if about is body.link else f", which is lumped into `{link.name}`"
        yield GAZEBO_VALUE_WITHOUT_EFFECT.at(
            file,
            tag.line,
            f"gazebo[@reference='{about.name}']/{key}",
            message=f"<{key}> has no effect: Gazebo does not find the collisions of the link "
            f"`{about.name}`{where} by their names.",
            hint=f"Remove the attribute `name` from the collisions of `{about.name}`."
            if any(collision.name for collision in about.collisions)
            else f"Give `{about.name}` a name that does not begin with `{link.name}`.",
        )

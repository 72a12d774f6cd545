"""Rules about the limits and dampers of joints, and about joints that follow others.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.urdf.gazebo import TRUTHS
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.inertia import about_link_axes, matrix_of
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import JointType
from wsgen.model.transform import IDENTITY, multiply, rotate, rotation_of_rpy, transpose
from wsgen.model.world import World

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Joint, JointLimit, Link, Robot


# rad; no joint of the published robots that is not free turns further, but for ±10 (solo, bolt).
FURTHEST_TURN = 10.0
MOST_DEGREES = 720.0  # larger bounds are how descriptions write "no limit"
HAVE_RANGE = (JointType.REVOLUTE, JointType.PRISMATIC)
# How far a follower may be sent beyond its limits: rounding of what is written by hand.
SLACK = 0.01  # of its range

LIMITS_IN_DEGREES = Rule(
    code="ROB081",
    name="limits-in-degrees",
    severity=Severity.WARNING,
    summary="The limits of a revolute joint look like degrees.",
    what="Looks for revolute joints with a bound between 10 and 720 and no more than one decimal.",
    why="Angles in URDF are in radians. A joint with limits of ±90 makes 14 turns in each "
    "direction before it stops, so that the arm runs into the robot.",
    example="""
<joint name="elbow" type="revolute">
  <parent link="upper_arm"/>
  <child link="forearm"/>
  <axis xyz="0 1 0"/>
  <limit lower="-90" upper="90" effort="10" velocity="1"/>
</joint>
""",
    instead="""
<joint name="elbow" type="revolute">
  <parent link="upper_arm"/>
  <child link="forearm"/>
  <axis xyz="0 1 0"/>
  <limit lower="-1.5708" upper="1.5708" effort="10" velocity="1"/>
</joint>
""",
)


def limits_in_degrees(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """Report angles that are surely meant in degrees."""
    for joint in joints:
        limit = joint.limit
        if joint.type is not JointType.REVOLUTE or limit is None or not _in_degrees(limit):
            continue
        lower, upper = math.radians(limit.lower), math.radians(limit.upper)
        yield LIMITS_IN_DEGREES.at(
            file,
            limit.line or joint.line,
            f"joint[@name='{joint.name}']/limit",
            message=f"The limits {limit.lower:g} and {limit.upper:g} of the revolute joint "
            f"`{joint.name}` look like degrees; URDF uses radians.",
            hint=f'Write lower="{lower:.5g}" upper="{upper:.5g}". If the joint turns without '
            "limits, make it continuous.",
        )


def _in_degrees(limit: JointLimit) -> bool:
    bounds = (limit.lower, limit.upper)
    largest = max(map(abs, bounds))
    is_round = all(round(bound, 1) == bound for bound in bounds)
    return FURTHEST_TURN < largest <= MOST_DEGREES and is_round


ZERO_EFFORT = Rule(
    code="ROB082",
    name="zero-effort",
    severity=Severity.WARNING,
    summary="The `<limit>` of a joint has an effort of 0.",
    what='Looks for movable joints whose `<limit>` says `effort="0"`, except those that mimic '
    "another joint.",
    why="`effort` is the maximum force or torque of the motor. With 0, Gazebo discards every "
    "command of a controller: the arm hangs down. CAD exporters write 0 as a placeholder.",
    example='<limit lower="-1.57" upper="1.57" effort="0" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>',
)

ZERO_VELOCITY = Rule(
    code="ROB083",
    name="zero-velocity",
    severity=Severity.WARNING,
    summary="The `<limit>` of a joint has a velocity of 0.",
    what='Looks for movable joints whose `<limit>` says `velocity="0"`, except those that mimic '
    "another joint.",
    why="`velocity` is the maximum speed of the joint. With 0, controllers and motion planners "
    "do not move it: MoveIt refuses to plan, and Gazebo Sim discards commanded speeds.",
    example='<limit lower="-1.57" upper="1.57" effort="10" velocity="0"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>',
)


def zero_limits(
    joints: Iterable[Joint], file: Path | None, tags: Iterable[GazeboTag] = ()
) -> Iterator[Diagnostic]:
    """Report movable joints that may have no force or no speed; springs need neither."""
    with_spring = {tag.reference for tag in tags if "springStiffness" in tag.values}
    for joint in joints:
        limit = joint.limit
        if limit is None or not _has_motor(joint) or joint.name in with_spring:
            continue
        turns = joint.type is not JointType.PRISMATIC
        if limit.effort == 0:
            yield ZERO_EFFORT.at(
                file,
                limit.line or joint.line,
                f"joint[@name='{joint.name}']/limit",
                message=f"The <limit> of the joint `{joint.name}` has an effort of 0: no "
                "controller can move or hold it.",
                hint=f"Write the motor's maximum {'torque in N m' if turns else 'force in N'}, for "
                'example effort="10".',
            )
        if limit.velocity == 0:
            yield ZERO_VELOCITY.at(
                file,
                limit.line or joint.line,
                f"joint[@name='{joint.name}']/limit",
                message=f"The <limit> of the joint `{joint.name}` has a velocity of 0: controllers "
                "do not move it.",
                hint=f"Write its maximum speed in {'rad/s' if turns else 'm/s'}, for example "
                'velocity="1".',
            )


NEGATIVE_LIMIT = Rule(
    code="ROB131",
    name="negative-limit",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The `<limit>` of a joint has a negative effort or velocity.",
    what="Looks for movable joints whose `<limit>` says `effort` or `velocity` below 0.",
    why="Both are the maximum in either direction. Gazebo treats a negative value as no limit; "
    "other programs refuse it, or do not move the joint.",
    example='<limit lower="-1.57" upper="1.57" effort="-10" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>',
)


def negative_limits(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """Report amounts that are below 0."""
    for joint in joints:
        limit = joint.limit
        if limit is None or joint.type not in (*HAVE_RANGE, JointType.CONTINUOUS):
            continue
        for name, value in (("effort", limit.effort), ("velocity", limit.velocity)):
            if value < 0:
                yield NEGATIVE_LIMIT.at(
                    file,
                    limit.line or joint.line,
                    f"joint[@name='{joint.name}']/limit",
                    message=f"The <limit> of the joint `{joint.name}` has a negative {name}, "
                    f"{value:g}: Gazebo treats it as no limit.",
                    hint=f'Write {name}="{-value:g}".',
                )


LIMITS_IN_MILLIMETERS = Rule(
    code="ROB132",
    name="limits-in-millimeters",
    severity=Severity.WARNING,
    summary="The limits of a prismatic joint look like millimeters.",
    what="Looks for prismatic joints between links with shapes that can slide 10 m or more and at "
    "least 30 times the size of the robot, with no more than one decimal in their limits.",
    why="Lengths in URDF are in meters. A slider with limits of 0 and 300 does not stop at the end "
    "of its rail and leaves the robot.",
    example="""
<joint name="lift" type="prismatic">
  <parent link="base_link"/>
  <child link="carriage"/>
  <axis xyz="0 0 1"/>
  <limit lower="0" upper="300" effort="100" velocity="0.5"/>
</joint>
""",
    instead="""
<joint name="lift" type="prismatic">
  <parent link="base_link"/>
  <child link="carriage"/>
  <axis xyz="0 0 1"/>
  <limit lower="0" upper="0.3" effort="100" velocity="0.5"/>
</joint>
""",
)
# Of what slides in millimeters: finger 10 to gantry 5000, on robots of 0.1 m and more.
SHORTEST_WAY = 10.0  # m
LONGEST_WAY = 5000.0  # m; larger bounds are how descriptions write "no limit"
TIMES_ITS_SIZE = 30.0


def limits_in_millimeters(
    joints: Iterable[Joint], links: Iterable[Link], extent: float, file: Path | None
) -> Iterator[Diagnostic]:
    """Report sliders that leave the robot; `extent` is its size, m.

    Joints that stand for a robot's own way over the floor are between links without shapes.
    """
    with_shapes = {link.name for link in links if link.collisions or link.visuals}
    for joint in joints:
        limit = joint.limit
        if joint.type is not JointType.PRISMATIC or limit is None:
            continue
        bounds = (limit.lower, limit.upper)
        way = max(map(abs, bounds))
        is_far = SHORTEST_WAY <= way <= LONGEST_WAY and way >= TIMES_ITS_SIZE * extent > 0
        is_round = all(round(bound, 1) == bound for bound in bounds)
        if not (is_far and is_round and {joint.parent, joint.child} <= with_shapes):
            continue
        lower, upper = (f"{bound / 1000:.5g}" for bound in bounds)
        yield LIMITS_IN_MILLIMETERS.at(
            file,
            limit.line or joint.line,
            f"joint[@name='{joint.name}']/limit",
            message=f"The limits {limit.lower:g} and {limit.upper:g} of the prismatic joint "
            f"`{joint.name}` look like millimeters: the size of the robot is {extent:.2g} m, and "
            "URDF uses meters.",
            hint=f'Write lower="{lower}" upper="{upper}".',
        )


def _has_motor(joint: Joint) -> bool:
    """Whether it is of a type that a motor may move, and is not moved by another joint."""
    kinds = (*HAVE_RANGE, JointType.CONTINUOUS)
    return joint.type in kinds and joint.mimic is None


NO_RANGE = Rule(
    code="ROB084",
    name="no-range",
    severity=Severity.WARNING,
    summary="The lower and the upper limit of a joint are the same: it cannot move.",
    what="Looks for revolute and prismatic joints whose bounds are equal. A missing bound is 0.",
    why="The joint may have a controller, but never moves. Usually the bounds are missing: `lower` "
    "and `upper` default to 0.",
    example='<limit effort="10" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>',
)


def no_range(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """Report joints whose limits leave no way to move."""
    for joint in joints:
        limit = joint.limit
        if joint.type not in HAVE_RANGE or limit is None or limit.lower != limit.upper:
            continue
        yield NO_RANGE.at(
            file,
            limit.line or joint.line,
            f"joint[@name='{joint.name}']/limit",
            message=f"The lower and the upper limit of the joint `{joint.name}` are both "
            f"{limit.lower:g}: it cannot move.",
            hint='Write lower="-1.57" upper="1.57" with its bounds in radians, or make it '
            "continuous or fixed."
            if joint.type is JointType.REVOLUTE
            else 'Write lower="0" upper="0.1" with its bounds in meters, or make it fixed.',
        )


MIMICS_FIXED_JOINT = Rule(
    code="ROB085",
    name="mimics-fixed-joint",
    severity=Severity.WARNING,
    severity_varies="information where the joint itself is fixed, which may be on purpose",
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A joint mimics a fixed joint, or is a fixed joint itself.",
    what="Looks at the type of the joint with `<mimic>` and that of the joint that it names.",
    why="A fixed joint has no position: a joint that mimics it never moves, and a `<mimic>` in a "
    "fixed joint has no effect. Gazebo prints no error.",
    example="""
<joint name="left_finger_joint" type="fixed">…</joint>
<joint name="right_finger_joint" type="prismatic">
  …
  <mimic joint="left_finger_joint"/>
</joint>
""",
    instead="""
<joint name="left_finger_joint" type="prismatic">…</joint>
<joint name="right_finger_joint" type="prismatic">
  …
  <mimic joint="left_finger_joint"/>
</joint>
""",
)

MIMIC_BEYOND_LIMITS = Rule(
    code="ROB086",
    name="mimic-beyond-limits",
    severity=Severity.INFO,
    summary="A joint that mimics another one cannot follow it over its whole range.",
    what="Compares the limits of the joint with those of the other one times `multiplier` plus "
    "`offset`; reports differences above 1% of the range.",
    why="The joint stops at its own limit while the other one continues. In Gazebo Sim the "
    "constraint between the two then holds the other joint back, too.",
    example="""
<joint name="left" type="prismatic"><limit lower="0" upper="0.04" …/></joint>
<joint name="right" type="prismatic">
  <limit lower="0" upper="0.04" …/>
  <mimic joint="left" multiplier="-1"/>
</joint>
""",
    instead="""
<joint name="left" type="prismatic"><limit lower="0" upper="0.04" …/></joint>
<joint name="right" type="prismatic">
  <limit lower="-0.04" upper="0" …/>
  <mimic joint="left" multiplier="-1"/>
</joint>
""",
)


def useless_mimics(joints: Iterable[Joint], file: Path | None) -> Iterator[Diagnostic]:
    """Report joints that follow what cannot move, or that cannot follow."""
    joints = tuple(joints)
    named = {joint.name: joint for joint in joints}
    for joint in joints:
        leader = None if joint.mimic is None else named.get(joint.mimic.joint)
        if leader is None:
            continue
        place = f"joint[@name='{joint.name}']/mimic"
        line = (joint.mimic.line if joint.mimic else None) or joint.line
        fixed = next((one for one in (joint, leader) if one.type is JointType.FIXED), None)
        if fixed is not None:
            yield MIMICS_FIXED_JOINT.at(
                file,
                line,
                place,
                message=f"The joint `{joint.name}` mimics `{leader.name}`, but "
                + ("is itself fixed." if fixed is joint else "that joint is fixed."),
                hint=f"Make `{fixed.name}` revolute, continuous or prismatic, or remove <mimic>.",
                severity=Severity.INFO if fixed is joint else Severity.WARNING,
            )
            continue
        if (reach := _reach(joint, leader)) is not None and joint.limit is not None:
            yield MIMIC_BEYOND_LIMITS.at(
                file,
                line,
                place,
                message=f"The joint `{joint.name}` must follow `{leader.name}` from "
                f"{reach[0]:.4g} to {reach[1]:.4g}, but its limits are {joint.limit.lower:g} and "
                f"{joint.limit.upper:g}.",
                hint=f'Write lower="{reach[0]:.4g}" upper="{reach[1]:.4g}" in its <limit>, or '
                "change `multiplier` and `offset`.",
            )


def _reach(joint: Joint, leader: Joint) -> tuple[float, float] | None:
    """Where the leader takes the follower, if that is beyond the follower's limits."""
    mimic, limit, other = joint.mimic, joint.limit, leader.limit
    has_range = joint.type in HAVE_RANGE and leader.type in HAVE_RANGE
    if mimic is None or limit is None or other is None or not has_range:
        return None
    low, high = sorted(
        mimic.multiplier * bound + mimic.offset for bound in (other.lower, other.upper)
    )
    slack = SLACK * max(limit.upper - limit.lower, high - low)
    is_beyond = low < limit.lower - slack or high > limit.upper + slack
    return (low, high) if is_beyond else None


UNSTABLE_DAMPING = Rule(
    code="ROB152",
    name="unstable-damping",
    severity=Severity.WARNING,
    severity_varies="an error in Gazebo Classic; not reported for Gazebo Sim",
    summary="The damping of a joint is too strong for the steps of Gazebo Classic.",
    what="Computes from all masses and dampings how much of a motion the dampers take in a step of "
    "1 ms. Measured with Gazebo Classic 11.",
    why="Gazebo Classic computes the damping from the speed before each step. If a step takes more "
    "than twice the speed, the joint swings faster and faster, until its position is not a number "
    "and the robot disappears.",
    example='<dynamics damping="100"/>',
    instead='<dynamics damping="0.1"/>',
)
STEP = World(name="").step  # s
MOST = 2.0  # of the speed, that a step may take


def unstable_damping(
    robot: Robot, file: Path | None, simulator: str | None
) -> Iterator[Diagnostic]:
    """Report the joint whose damper makes Gazebo Classic unstable; `robot` is lumped.

    Left out are joints with friction, which may stop them in each step.
    """
    if simulator == "gz":
        return
    implicit = {
        tag.reference
        for tag in robot.gazebo
        if tag.values.get("implicitSpringDamper", "").lower() in TRUTHS
    }
    damped = [
        joint
        for joint in robot.movable_joints
        if joint.damping > 0
        and joint.friction == 0
        and joint.type is not JointType.BALL
        and joint.name not in implicit
    ]
    # NumPy takes as long to import as a check; most dampers are far below.
    if robot.is_static or not any(_may_be_unstable(joint, robot) for joint in damped):
        return
    joint, share = _strongest(robot, damped)
    if share > MOST:
        yield UNSTABLE_DAMPING.at(
            file,
            joint.line,
            f"joint[@name='{joint.name}']/dynamics",
            message=f"Gazebo Classic loses the robot: the damping of the joint `{joint.name}`, "
            f"{joint.damping:g}, takes {share:.3g} times the speed in a step of 1 ms; more than "
            "twice makes the joint swing faster and faster.",
            hint=f'Write damping="{joint.damping * MOST / share / 4:.1g}" or less, or add '
            f'<gazebo reference="{joint.name}"><implicitSpringDamper>true</implicitSpringDamper>'
            "</gazebo>.",
            severity=Severity.ERROR if simulator == "classic" else None,
        )


def _may_be_unstable(joint: Joint, robot: Robot) -> bool:
    """Whether a damper may stop one of the two bodies at its joint."""
    inertials = (robot.link(joint.child).inertial, robot.link(joint.parent).inertial)
    for inertial in inertials:
        if inertial is None or not inertial.mass > 0:
            continue
        xx, _, _, yy, _, zz = inertial.inertia
        least = inertial.mass if joint.type is JointType.PRISMATIC else min(xx, yy, zz)
        if joint.damping * STEP > least:
            return True
    return False


def _strongest(robot: Robot, damped: list[Joint]) -> tuple[Joint, float]:
    """The joint that moves most in the motion which dampers take most of, and how much a step."""
    import numpy as np  # noqa: PLC0415  see above

    inverse = np.linalg.pinv(_mass_matrix(robot))
    offset = 0 if robot.fixed_to_world else 6
    places = [offset + place for place, joint in enumerate(robot.movable_joints) if joint in damped]
    roots = np.sqrt([joint.damping for joint in damped])
    shares, motions = np.linalg.eigh(roots[:, None] * inverse[np.ix_(places, places)] * roots)
    return damped[int(np.abs(motions[:, -1]).argmax())], float(shares[-1]) * STEP


def _mass_matrix(robot: Robot) -> NDArray[Any]:
    """Of the joints at 0, after six rows for the root where that is loose: kg, kg m, kg m²."""
    import numpy as np  # noqa: PLC0415

    poses = link_poses(robot, IDENTITY)
    movable = list(robot.movable_joints)
    place = {joint.child: number for number, joint in enumerate(movable)}
    above = {joint.child: joint for joint in robot.joints}
    offset = 0 if robot.fixed_to_world else 6
    matrix = np.zeros((offset + len(movable),) * 2)
    for link in robot.links:
        if link.inertial is None or not link.inertial.mass > 0:
            continue
        rotation = rotation_of_rpy(poses[link.name].rpy)
        center = np.add(poses[link.name].xyz, rotate(rotation, link.inertial.pose_in_link.xyz))
        inertia = multiply(
            multiply(rotation, matrix_of(about_link_axes(link.inertial))), transpose(rotation)
        )
        linear, angular = np.zeros((3, len(matrix))), np.zeros((3, len(matrix)))
        if offset:
            linear[:, :3] = angular[:, 3:6] = np.eye(3)
            linear[:, 3:6] = np.cross(np.eye(3), center).T
        below = link.name
        while below in above:
            joint = above[below]
            if below in place:
                pose, column = poses[below], offset + place[below]
                axis = rotate(rotation_of_rpy(pose.rpy), joint.axis_in_joint)
                if joint.type is JointType.PRISMATIC:
                    linear[:, column] = axis
                else:
                    angular[:, column] = axis
                    linear[:, column] = np.cross(axis, center - pose.xyz)
            below = joint.parent
        matrix += link.inertial.mass * linear.T @ linear + angular.T @ np.array(inertia) @ angular
    return matrix

"""Joint dampers that are too strong for Gazebo Classic, which applies them explicitly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen.descriptions.urdf.gazebo import TRUTHS
from wsgen.diagnostics import Rule, Severity
from wsgen.model.inertia import about_link_axes, matrix_of
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import JointType
from wsgen.model.transform import IDENTITY, multiply, rotate, rotation_of_rpy, transpose
from wsgen.model.world import World

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Joint, Robot

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

"""Which joints gravity can move: arms and legs, not wheels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import JointType
from wsgen.model.transform import UNIT, multiply, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from wsgen.model.robot import Inertial, Joint, Robot
    from wsgen.model.transform import Matrix

ENDLESS = 8 * math.pi  # rad between limits; some write them for wheels
UPRIGHT = math.cos(math.radians(5))
ON_AXIS = 0.005  # m; a wheel's centre of mass may be so far from its axle


def limb_joints(robot: Robot) -> set[str]:
    """The names of the movable joints that are neither axles of wheels nor upright swivels.

    A wheel turns without end, carries nothing that moves, and its centre of mass is on its axle. A
    swivel, as of a caster, turns about the vertical of the robot with all joints at zero.
    """
    carriers = {joint.parent for joint in robot.joints}
    inertials = {link.name: link.inertial for link in robot.links}
    rotations = _rotations(robot)
    return {
        joint.name
        for joint in robot.movable_joints
        if not _is_axle(joint, inertials[joint.child], is_leaf=joint.child not in carriers)
        and not _is_swivel(joint, rotations.get(joint.child, UNIT))
    }


def _is_swivel(joint: Joint, rotation: Matrix) -> bool:
    if joint.type is JointType.PRISMATIC:
        return False
    return abs(rotate(rotation, joint.axis_in_joint)[2]) > UPRIGHT


def _rotations(robot: Robot) -> dict[str, Matrix]:
    """The rotation of every link in the root's frame, with all joints at zero."""
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    rotations, queue = {robot.root: UNIT}, [robot.root]
    for parent in queue:
        for joint in below.get(parent, ()):
            turned = rotation_of_rpy(joint.pose_in_parent.rpy)
            rotations[joint.child] = multiply(rotations[parent], turned)
            queue.append(joint.child)
    return rotations


def _is_axle(joint: Joint, inertial: Inertial | None, *, is_leaf: bool) -> bool:
    limit = joint.limit
    is_endless = joint.type is JointType.CONTINUOUS or (
        joint.type is JointType.REVOLUTE
        and limit is not None
        and limit.upper - limit.lower > ENDLESS
    )
    if not is_endless or not is_leaf or inertial is None:
        return False
    (x, y, z), (ax, ay, az) = inertial.pose_in_link.xyz, joint.axis_in_joint
    off_axis = math.hypot(y * az - z * ay, z * ax - x * az, x * ay - y * ax)
    return off_axis <= ON_AXIS

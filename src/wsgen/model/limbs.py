"""Which joints gravity can move: arms and legs, not wheels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from wsgen.model.robot import Joint, Robot

ON_AXIS = 0.005  # m; a wheel's centre of mass may be so far from its axle


def limb_joints(robot: Robot) -> set[str]:
    """The names of the movable joints that are no axles of wheels.

    A wheel turns without end, carries nothing that moves, and its centre of mass is on its axle.
    """
    carriers = {joint.parent for joint in robot.joints}
    return {
        joint.name
        for joint in robot.movable_joints
        if not _is_axle(robot, joint, is_leaf=joint.child not in carriers)
    }


def _is_axle(robot: Robot, joint: Joint, *, is_leaf: bool) -> bool:
    inertial = robot.link(joint.child).inertial
    if joint.type is not JointType.CONTINUOUS or not is_leaf or inertial is None:
        return False
    (x, y, z), (ax, ay, az) = inertial.pose_in_link.xyz, joint.axis_in_joint
    off_axis = math.hypot(y * az - z * ay, z * ax - x * az, x * ay - y * ax)
    return off_axis <= ON_AXIS

"""Parts of messages that several plugins fill in or check."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from wsgen.live.nodes.simulator.host import FASTEST
from wsgen.model.transform import Pose, quaternion_of_rpy, rotation_of_quaternion, rpy_of_rotation

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.transform import Vector

Quaternion = tuple[float, float, float, float]

# What Classic's plugins have where a motion in the plane says nothing.
UNKNOWN = 1e12


def set_pose(pose: Any, xyz: Vector, xyzw: Quaternion) -> None:
    """Fill in a `geometry_msgs/Pose`."""
    position, orientation = pose.position, pose.orientation
    position.x, position.y, position.z = xyz
    orientation.x, orientation.y, orientation.z, orientation.w = xyzw


def set_transform(transform: Any, xyz: Vector, xyzw: Quaternion) -> None:
    """Fill in a `geometry_msgs/Transform`."""
    translation, rotation = transform.translation, transform.rotation
    translation.x, translation.y, translation.z = xyz
    rotation.x, rotation.y, rotation.z, rotation.w = xyzw


def set_transform_to(transform: Any, pose: Pose) -> None:
    """Likewise."""
    set_transform(transform, pose.xyz, quaternion_of_rpy(pose.rpy))


def set_twist(twist: Any, linear: Vector, angular: Vector) -> None:
    """Fill in a `geometry_msgs/Twist`."""
    twist.linear.x, twist.linear.y, twist.linear.z = linear
    twist.angular.x, twist.angular.y, twist.angular.z = angular


NOT_FINITE = "a state that is not finite (NaN or infinity) is ignored. Send finite numbers."
TOO_FAST = f"a speed of more than {FASTEST:g} m/s or rad/s is ignored. Send a smaller one."


def pose_of(message: Any) -> Pose | None:
    """A pose of a `geometry_msgs/Pose`, whose rotation may be of any length; None if not finite.

    A rotation of zeros alone is none.
    """
    position, turn = message.position, message.orientation
    xyz = (position.x, position.y, position.z)
    length = math.hypot(turn.x, turn.y, turn.z, turn.w)
    if not all(map(math.isfinite, (*xyz, length))):
        return None
    x, y, z, w = (part / length if length else 0.0 for part in (turn.x, turn.y, turn.z, turn.w))
    rotation = rotation_of_quaternion((x, y, z, w if length else 1.0))
    return Pose(xyz=xyz, rpy=rpy_of_rotation(rotation))


def move(robot: RobotHandle, pose: Pose) -> None:
    """Put a robot elsewhere, at rest, with its joints where they are."""
    positions = dict(robot.joint_positions())
    robot.place(pose)
    if positions:
        robot.set_joint_positions(positions)


def planar_covariance(x: float, y: float, yaw: float) -> list[float]:
    """Of a pose or twist in the plane, 6 by 6."""
    covariance = [0.0] * 36
    for place, value in zip(range(0, 36, 7), (x, y, UNKNOWN, UNKNOWN, UNKNOWN, yaw), strict=True):
        covariance[place] = value
    return covariance


def of_yaw(yaw: float) -> Quaternion:
    """The rotation about z by an angle (rad)."""
    return 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)


def yaw_of(xyzw: Quaternion) -> float:
    """The heading of a rotation, rad."""
    x, y, z, w = xyzw
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def in_heading(yaw: float, linear: Vector) -> tuple[float, float]:
    """A velocity of the world, ahead and to the left of a heading."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * linear[0] + sin * linear[1], cos * linear[1] - sin * linear[0]


def can_follow_twist(host: Host, message: Any, topic: str) -> bool:
    """Whether an engine can compute with a `geometry_msgs/Twist`; if not, it is named."""
    linear, angular = message.linear, message.angular
    parts = (linear.x, linear.y, linear.z), (angular.x, angular.y, angular.z)
    if can_follow(*parts):
        return True
    is_finite = all(math.isfinite(part) for vector in parts for part in vector)
    reason = (
        f"of more than {FASTEST:g} m/s or rad/s, which no engine can follow"
        if is_finite
        else "that is not a finite number (NaN or infinity)"
    )
    host.warn(
        f"A message on {topic} has a velocity {reason}. It and all others like it are ignored."
    )
    return False


def can_follow(linear: Vector, angular: Vector) -> bool:
    """Whether an engine can compute with velocities (m/s, rad/s): they are finite, and not huge."""
    return math.hypot(*linear) <= FASTEST and math.hypot(*angular) <= FASTEST

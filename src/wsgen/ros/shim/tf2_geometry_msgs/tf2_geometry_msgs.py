"""Messages of geometry_msgs, seen from another frame.

Functions are those of geometry2's tf2_geometry_msgs (src/tf2_geometry_msgs/tf2_geometry_msgs.py).
Each takes a message and a TransformStamped, and leaves both as they are.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import (
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Vector3Stamped,
)

from tf2_py._rotations import NO_TRANSLATION, add, multiply, normalize, rotate
from tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration


def to_msg_msg(msg: Any) -> Any:
    """A message is one already."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """A message is what was asked for."""
    return msg


def do_transform_point(point: Any, transform: Any) -> Any:
    """A PointStamped."""
    found = PointStamped(header=transform.header)
    _set(found.point, _moved(point.point, transform))
    return found


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """A Vector3Stamped, which is rotated and not moved."""
    found = Vector3Stamped(header=transform.header)
    turn = normalize(_quaternion(transform.transform.rotation))
    _set(found.vector, add(NO_TRANSLATION, rotate(turn, _vector(vector3.vector))))
    return found


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """A Pose."""
    found = Pose()
    _set(found.position, _moved(pose.position, transform))
    turn = multiply(
        _quaternion(transform.transform.rotation), normalize(_quaternion(pose.orientation))
    )
    orientation = found.orientation
    orientation.x, orientation.y, orientation.z, orientation.w = normalize(turn)
    return found


def do_transform_pose_stamped(pose: Any, transform: Any) -> Any:
    """A PoseStamped."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """A PoseWithCovarianceStamped."""
    found = PoseWithCovarianceStamped(header=transform.header)
    found.pose.pose = do_transform_pose(pose.pose.pose, transform)
    found.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return found


def do_transform_polygon_stamped(polygon: Any, transform: Any) -> Any:
    """A PolygonStamped."""
    found = PolygonStamped(header=transform.header)
    for point in polygon.polygon.points:
        corner = Point32()
        _set(corner, _moved(point, transform))
        found.polygon.points.append(corner)
    return found


def transform_covariance(cov_in: Any, transform: Any) -> Any:
    """The covariance (36 numbers, rows of x, y, z and rotations about them) of a pose, rotated."""
    columns = [rotate(normalize(_quaternion(transform.transform.rotation)), unit) for unit in UNITS]
    rotation = np.kron(np.eye(2), np.array(columns).T)
    covariance = np.asarray(cov_in, dtype=float).reshape(6, 6)
    return (rotation @ covariance @ rotation.T).ravel()


UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def _moved(point: Any, transform: Any) -> tuple[float, float, float]:
    turn = normalize(_quaternion(transform.transform.rotation))
    return add(rotate(turn, _vector(point)), _vector(transform.transform.translation))


def _vector(message: Any) -> tuple[float, float, float]:
    return (message.x, message.y, message.z)


def _quaternion(message: Any) -> tuple[float, float, float, float]:
    """x, y, z, w; no rotation where all are 0, as messages are made."""
    found = (message.x, message.y, message.z, message.w)
    return found if any(found) else (0.0, 0.0, 0.0, 1.0)


def _set(message: Any, xyz: tuple[float, float, float]) -> None:
    message.x, message.y, message.z = xyz


for _type in (PointStamped, PoseStamped, Vector3Stamped):
    ConvertRegistration().add_to_msg(_type, to_msg_msg)
    ConvertRegistration().add_from_msg(_type, from_msg_msg)

for _type, _function in (
    (PointStamped, do_transform_point),
    (Vector3Stamped, do_transform_vector3),
    (PoseStamped, do_transform_pose_stamped),
    (PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped),
    (PolygonStamped, do_transform_polygon_stamped),
):
    TransformRegistration().add(_type, _function)

"""Messages of Gazebo Sim as messages of ROS, and what a bridge makes of them.

Here plugins speak ROS's messages on the topics of Gazebo, each the first one of its kind
(`gazebo/bridged_types.py`), and a bridge makes the one that its rule wants of it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from wsgen.gazebo.bridged_types import short_ros_type

if TYPE_CHECKING:
    from collections.abc import Callable


def name_of(message_type: type) -> str:
    """`sensor_msgs/LaserScan` of a class of messages."""
    return f"{message_type.__module__.partition('.')[0]}/{message_type.__name__}"


def message_class(name: str) -> type | None:
    """The class of a message type; None where its package is not installed."""
    package, _, message = short_ros_type(name).partition("/")
    try:
        found: type | None = getattr(importlib.import_module(f"{package}.msg"), message, None)
    except ImportError:
        return None
    return found


def conversion(source: str, target: str) -> Callable[[Any], Any] | None:
    """What makes a message of one type of another one; None where they have nothing in common."""
    if source == target:
        return _same
    return _CONVERSIONS.get((source, target))


def _same(message: Any) -> Any:
    return message


def _unstamped_twist(message: Any) -> Any:
    return message.twist


def _stamped_twist(message: Any) -> Any:
    made = _new("geometry_msgs/TwistStamped")
    made.twist = message
    return made


def _pose_array(message: Any) -> Any:
    made = _new("geometry_msgs/PoseArray")
    for transform in message.transforms:
        made.header = transform.header
        made.poses.append(_pose(transform))
    return made


def _pose(stamped: Any) -> Any:
    pose = _new("geometry_msgs/Pose")
    position, translation = pose.position, stamped.transform.translation
    position.x, position.y, position.z = translation.x, translation.y, translation.z
    pose.orientation = stamped.transform.rotation
    return pose


def _stamped_pose(stamped: Any) -> Any:
    made = _new("geometry_msgs/PoseStamped")
    made.header, made.pose = stamped.header, _pose(stamped)
    return made


def _unstamped_transform(message: Any) -> Any:
    return message.transform


def _unstamped_wrench(message: Any) -> Any:
    return message.wrench


def _stamped_wrench(message: Any) -> Any:
    made = _new("geometry_msgs/WrenchStamped")
    made.wrench = message
    return made


def _new(name: str) -> Any:
    made = message_class(name)
    assert made is not None  # noqa: S101  geometry_msgs are always there
    return made()


_CONVERSIONS: dict[tuple[str, str], Callable[[Any], Any]] = {
    ("geometry_msgs/TwistStamped", "geometry_msgs/Twist"): _unstamped_twist,
    ("geometry_msgs/Twist", "geometry_msgs/TwistStamped"): _stamped_twist,
    ("tf2_msgs/TFMessage", "geometry_msgs/PoseArray"): _pose_array,
    ("geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped"): _stamped_pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Pose"): _pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Transform"): _unstamped_transform,
    ("geometry_msgs/WrenchStamped", "geometry_msgs/Wrench"): _unstamped_wrench,
    ("geometry_msgs/Wrench", "geometry_msgs/WrenchStamped"): _stamped_wrench,
}

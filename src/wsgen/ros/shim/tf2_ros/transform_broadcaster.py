"""Sends transforms of frames that move (tf2_ros_py/tf2_ros/transform_broadcaster.py)."""

from __future__ import annotations

from typing import Any

from rclpy.qos import QoSProfile
from tf2_msgs.msg import TFMessage

__all__ = ["TransformBroadcaster"]


class TransformBroadcaster:
    """Publishes on /tf, with the depth 100 unless a QoS is given."""

    def __init__(self, node: Any, qos: Any = None) -> None:
        self.pub_tf = node.create_publisher(
            TFMessage, "/tf", QoSProfile(depth=100) if qos is None else qos
        )

    def sendTransform(self, transform: Any) -> None:  # noqa: N802  tf2's name
        """Send a TransformStamped, or several at once."""
        self.pub_tf.publish(TFMessage(transforms=as_list(transform)))


def as_list(transform: Any) -> list[Any]:
    """What was given as one or as several, as a list."""
    return list(transform) if hasattr(transform, "__iter__") else [transform]

"""Sends transforms that hold at all times (tf2_ros_py/tf2_ros/static_transform_broadcaster.py)."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import as_list

__all__ = ["StaticTransformBroadcaster"]


class StaticTransformBroadcaster:
    """Publishes all that it was given on /tf_static, for those who come later as well.

    Of a child frame the first transform stays: ROS's broadcaster for Python does not replace it,
    in contrast to the one for C++. A node that expects it gets a message.
    """

    def __init__(self, node: Any, qos: Any = None) -> None:
        if qos is None:
            qos = QoSProfile(
                depth=1,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
                history=HistoryPolicy.KEEP_LAST,
            )
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        self.net_message = TFMessage()
        self._logger = node.get_logger()
        self._reported: set[str] = set()

    def sendTransform(self, transform: Any) -> None:  # noqa: N802  tf2's name
        """Send a TransformStamped, or several at once."""
        known = {sent.child_frame_id: sent for sent in self.net_message.transforms}
        for new in as_list(transform):
            frame = new.child_frame_id
            if frame not in known:
                known[frame] = new
                self.net_message.transforms.append(new)
            elif known[frame].transform != new.transform and frame not in self._reported:
                self._reported.add(frame)
                self._logger.warning(
                    f"The static transform of `{frame}` was sent before and stays as it was: "
                    "ROS's StaticTransformBroadcaster for Python does not replace it. "
                    "Use a TransformBroadcaster for a frame that moves."
                )
        self.pub_tf.publish(self.net_message)

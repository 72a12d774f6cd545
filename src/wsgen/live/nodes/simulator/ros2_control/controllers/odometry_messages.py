"""What controllers of wheels publish of their odometry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller


class OdometryMessages:
    """Messages of nav_msgs/msg/Odometry and transforms, by the parameters of a controller."""

    def __init__(
        self,
        controller: Controller,
        *,
        topics: tuple[str, str | None],
        prefix: str = "",
        covariances: Sequence[float] = (0.0,) * 6,
        only_twist: bool = False,
    ) -> None:
        """`topics` are those of odometry and of transforms, None without these.

        With `only_twist` the messages have no pose; transforms have it all the same.
        """
        self._only_twist = only_twist
        parameters, self._ros = controller.parameters, controller.ros
        topic, of_transforms = topics
        self._publisher = controller.publisher(Odometry, topic)
        self._message = message = Odometry()
        message.header.frame_id = prefix + parameters.text("odom_frame_id", "odom")
        message.child_frame_id = prefix + parameters.text("base_frame_id", "base_link")
        for name, part in (("pose", message.pose), ("twist", message.twist)):
            diagonal = parameters.numbers(f"{name}_covariance_diagonal", list(covariances))
            for index, value in enumerate(diagonal[:6]):
                part.covariance[7 * index] = value
        self._tf_publisher = None
        if of_transforms is not None:
            from tf2_msgs.msg import TFMessage  # noqa: PLC0415  if it is wanted

            self._tf_publisher = controller.publisher(TFMessage, of_transforms)
            transform = TransformStamped()
            transform.header.frame_id = message.header.frame_id
            transform.child_frame_id = message.child_frame_id
            self._tf = TFMessage(transforms=[transform])

    def publish(
        self,
        now: float,
        place: tuple[float, float, float],
        speed: tuple[float, float],
        turning: float,
    ) -> None:
        """Say where it is (x, y: m, heading: rad), its speed ahead and to the left, and rad/s."""
        x, y, heading = place
        z, w = math.sin(heading / 2), math.cos(heading / 2)
        if self._publisher.is_wanted:
            message = self._message
            message.header.stamp = self._ros.time(now)
            pose, twist = message.pose.pose, message.twist.twist
            if not self._only_twist:
                pose.position.x, pose.position.y = x, y
                pose.orientation.z, pose.orientation.w = z, w
            twist.linear.x, twist.linear.y = speed
            twist.angular.z = turning
            self._publisher.publish(message)
        if self._tf_publisher is not None and self._tf_publisher.is_wanted:
            stamped = self._tf.transforms[0]
            stamped.header.stamp = self._ros.time(now)
            where, turn = stamped.transform.translation, stamped.transform.rotation
            where.x, where.y = x, y
            turn.z, turn.w = z, w
            self._tf_publisher.publish(self._tf)


def namespace_prefix(controller: Controller) -> str:
    """What the names of frames begin with: the namespace, or as it is asked."""
    if not controller.parameters.flag("tf_frame_prefix_enable", default=True):
        return ""
    prefix = controller.parameters.text("tf_frame_prefix") or controller.node.get_namespace()
    return _with_slash(prefix.replace("~", controller.node.get_namespace()))


def written_prefix(controller: Controller) -> str:
    """Likewise, where nothing is written for nothing; `~` stands for the namespace."""
    prefix = controller.parameters.text("tf_frame_prefix")
    return _with_slash(prefix.replace("~", controller.node.get_namespace()))


def _with_slash(prefix: str) -> str:
    prefix = prefix.strip("/")
    return f"{prefix}/" if prefix else ""

"""What controllers take and publish: commands, odometry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller


TOPIC = "~/reference"


class Reference:
    """The last command of steering and mecanum controllers on `~/reference`, as long as it counts.

    Source: ros-controls/ros2_controllers, `reference_callback` and
    `update_reference_from_subscribers` of steering_controllers_library and
    mecanum_drive_controller.
    """

    def __init__(self, controller: Controller, *, timeout: float, is_stamped: bool = True) -> None:
        """Listen; `timeout` is in s, 0: a command counts for one update."""
        from rclpy.qos import QoSProfile, ReliabilityPolicy  # noqa: PLC0415  of nodes

        self._controller = controller
        self._timeout = timeout
        self.forget()
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        if is_stamped:
            controller.subscription(TwistStamped, TOPIC, self._take, qos)
        else:
            controller.subscription(Twist, f"{TOPIC}_unstamped", self._take_unstamped, qos)

    def forget(self) -> None:
        """Wait for the next command."""
        self._twist: Any = None
        self._time = 0.0  # s

    def _take(self, message: Any) -> None:
        controller, stamp = self._controller, message.header.stamp
        now, time = controller.clock(), stamp.sec + stamp.nanosec * 1e-9
        if not time:
            controller.warn_once(
                "Timestamp in header is missing, using current time as command timestamp."
            )
            time = now
        if self._timeout and now - time > self._timeout:
            controller.error(
                f"Received message has timestamp {time:.10f} older for {now - time:.10f} which is "
                f"more then allowed timeout ({self._timeout:.4f})."
            )
            return
        self._twist, self._time = message.twist, time

    def _take_unstamped(self, message: Any) -> None:
        self._twist, self._time = message, self._controller.clock()

    def at(self, now: float) -> tuple[float, float, float] | None:
        """The command that counts at a time: speeds ahead and to the left (m/s), and rad/s."""
        twist = self._twist
        if twist is None:
            return None
        if not self._timeout:
            self._twist = None
        elif now - self._time > self._timeout:
            self._twist = None
            return None
        values = twist.linear.x, twist.linear.y, twist.angular.z
        return values if all(map(math.isfinite, values)) else None


STILL = (0.0, 0.0)


class VelocityCommand:
    """The last command of diff drive and tricycle controllers on `~/cmd_vel`, as long as it counts.

    Source: ros-controls/ros2_controllers, the subscribers of diff_drive_controller.cpp and
    tricycle_controller.cpp, and how their `update` treats old commands.
    """

    def __init__(
        self,
        controller: Controller,
        *,
        timeout: float,
        unstamped: str | None,
        refuses_old: bool,
        not_finite: str,
    ) -> None:
        """Listen.

        Args:
            controller: Its topics, its clock, and whether it takes commands.
            timeout: s, for which a command counts; inf: for ever.
            unstamped: The topic of commands without stamps; None: they have stamps.
            refuses_old: Whether a command that is older when it comes is reported and ignored.
            not_finite: What is said of a command whose speeds are no numbers.
        """
        self._controller = controller
        self._timeout, self._refuses_old, self._not_finite = timeout, refuses_old, not_finite
        self.forget(0.0)
        if unstamped is None:
            controller.subscription(TwistStamped, "~/cmd_vel", self._take)
        else:
            controller.subscription(Twist, unstamped, self._take_unstamped)

    def forget(self, now: float) -> None:
        """Stand still from that time on (s) until a command comes."""
        self._command, self._time = STILL, now

    def at(self, now: float) -> tuple[float, float]:
        """The command that counts at a time (s): the speed ahead (m/s), and rad/s."""
        return STILL if now - self._time > self._timeout else self._command

    def _take(self, message: Any) -> None:
        controller, stamp = self._controller, message.header.stamp
        now, time = controller.clock(), stamp.sec + stamp.nanosec * 1e-9
        if not time:
            controller.warn_once(
                "Received TwistStamped with zero timestamp, setting it to current time, this "
                "message will only be shown once"
            )
            time = now
        elif self._refuses_old and now - time >= self._timeout:
            controller.warn(
                f"Ignoring the received message (timestamp {time:f}) because it is older than the "
                f"current time by {now - time:f} seconds, which exceeds the allowed timeout "
                f"({self._timeout:.4f})"
            )
            return
        self._obey(message.twist, time)

    def _take_unstamped(self, message: Any) -> None:
        self._obey(message, self._controller.clock())

    def _obey(self, twist: Any, time: float) -> None:
        controller, command = self._controller, (twist.linear.x, twist.angular.z)
        if not controller.is_active:
            controller.warn("Can't accept new commands. subscriber is inactive")
        elif all(map(math.isfinite, command)):
            self._command, self._time = command, time
        else:
            controller.warn_once(self._not_finite)


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

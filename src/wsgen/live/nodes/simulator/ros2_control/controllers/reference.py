"""Commands of steering and mecanum controllers: `~/reference`, which is forgotten in time.

Source: ros-controls/ros2_controllers, `reference_callback` and `update_reference_from_subscribers`
of steering_controllers_library and mecanum_drive_controller.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist, TwistStamped

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller

TOPIC = "~/reference"


class Reference:
    """The last command, as long as it counts."""

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

"""Commands of diff drive and tricycle controllers: `~/cmd_vel`, which counts for a time.

Source: ros-controls/ros2_controllers, the subscribers of diff_drive_controller.cpp and
tricycle_controller.cpp, and how their `update` treats old commands.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist, TwistStamped

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller

STILL = (0.0, 0.0)


class VelocityCommand:
    """The last command, as long as it counts."""

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

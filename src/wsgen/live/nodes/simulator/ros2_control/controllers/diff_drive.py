"""Two wheels, or two rows of wheels, by velocity commands; odometry.

Source: ros-controls/ros2_controllers, diff_drive_controller/src/diff_drive_controller.cpp and its
parameters: Humble and Iron take geometry_msgs/msg/Twist on `~/cmd_vel_unstamped` with
`use_stamped_vel: false`, later releases TwistStamped on `~/cmd_vel` alone.
"""

from __future__ import annotations

import math

from geometry_msgs.msg import TwistStamped

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.controllers.topics import (
    OdometryMessages,
    VelocityCommand,
    namespace_prefix,
)
from wsgen.live.nodes.simulator.ros2_control.hardware import POSITION, VELOCITY
from wsgen.live.nodes.simulator.ros2_control.wheels import Limits, WheelOdometry


class DiffDriveController(Controller):
    """Drives by `~/cmd_vel`; says on `~/odom` and `/tf` how far the wheels say that it came."""

    def configure(self) -> None:
        """Read the parameters, open the topics."""
        parameters = self.parameters
        self._left = self.require("left_wheel_names")
        self._right = self.require("right_wheel_names")
        if len(self._left) != len(self._right):
            message = (
                f"The number of left wheels [{len(self._left)}] and the number of right wheels "
                f"[{len(self._right)}] are different"
            )
            raise ControllerError(message)
        self._separation = self.require_length(
            "wheel_separation", parameters.number("wheel_separation_multiplier", 1.0)
        )
        radius = self.require_length("wheel_radius")
        self._radii = (radius * self._multiplier("left"), radius * self._multiplier("right"))
        self._is_open_loop = parameters.flag("open_loop")
        self._feedback = (
            POSITION if parameters.flag("position_feedback", default=True) else VELOCITY
        )
        wheels = (*self._left, *self._right)
        self.commands = tuple(f"{wheel}/{VELOCITY}" for wheel in wheels)
        self.states = (
            () if self._is_open_loop else tuple(f"{wheel}/{self._feedback}" for wheel in wheels)
        )
        self._linear_limits = Limits.read(parameters, "linear.x", is_former=self._is_former())
        self._angular_limits = Limits.read(parameters, "angular.z", is_former=self._is_former())
        self._window = int(parameters.number("velocity_rolling_window_size", 10))
        self._odometry = self._new_odometry()
        rate = parameters.number("publish_rate", 50.0)
        self._publish_period = 1.0 / rate if rate > 0 else 0.0
        self._next_publish = 0.0
        self._open_topics()

    def _multiplier(self, side: str) -> float:
        """Of the radius of the wheels of a side; a negative one has them turn the other way."""
        name = f"{side}_wheel_radius_multiplier"
        value = self.parameters.number(name, 1.0)
        if not value:
            message = f"Invalid value '{value:f}' of the parameter '{name}': it must not be 0"
            raise ControllerError(message)
        return value

    def _new_odometry(self) -> WheelOdometry:
        return WheelOdometry(self._separation, *self._radii, window=self._window)

    def _is_former(self) -> bool:
        """Whether the parameters are those of Humble."""
        return self.is_former or "use_stamped_vel" in self.parameters.values

    def _open_topics(self) -> None:
        parameters = self.parameters
        is_stamped = True
        if self._is_former():
            is_stamped = parameters.flag("use_stamped_vel", default=True)
        timeout = parameters.number("cmd_vel_timeout", 0.5)
        self._command = VelocityCommand(
            self,
            timeout=timeout if timeout > 0 else math.inf,
            unstamped=None if is_stamped else "~/cmd_vel_unstamped",
            refuses_old=True,
            not_finite="Command message contains NaNs. Not updating reference interfaces.",
        )
        has_tf = parameters.flag("enable_odom_tf", default=True)
        self._messages = OdometryMessages(
            self, topics=("~/odom", "/tf" if has_tf else None), prefix=namespace_prefix(self)
        )
        self._limited_publisher = (
            self.publisher(TwistStamped, "~/cmd_vel_out")
            if parameters.flag("publish_limited_velocity")
            else None
        )

    def activate(self) -> None:
        """Stand still until a command comes."""
        self._command.forget(self.clock())
        self._last = self._before = (0.0, 0.0)

    def reset(self, now: float) -> None:
        """Stand still where odometry begins."""
        self.activate()
        self._odometry = self._new_odometry()
        self._next_publish = now

    def deactivate(self) -> None:
        """Stop the wheels."""
        self.interfaces.commands.update(dict.fromkeys(self.commands, 0.0))

    def update(self, now: float, elapsed: float) -> None:
        """Turn the wheels, and count their turns."""
        linear, angular = (
            limits.next(wanted, last, before, elapsed)
            for limits, wanted, last, before in zip(
                (self._linear_limits, self._angular_limits),
                self._command.at(now),
                self._last,
                self._before,
                strict=True,
            )
        )
        self._before, self._last = self._last, (linear, angular)
        self._count(linear, angular, elapsed)
        if now >= self._next_publish:
            self._next_publish = max(now, self._next_publish + self._publish_period)
            odometry = self._odometry
            place = odometry.x, odometry.y, odometry.heading
            self._messages.publish(now, place, (odometry.linear, 0.0), odometry.angular)
        if self._limited_publisher is not None and self._limited_publisher.is_wanted:
            limited = TwistStamped()
            limited.header.stamp = self.ros.time(now)
            limited.twist.linear.x, limited.twist.angular.z = linear, angular
            self._limited_publisher.publish(limited)
        commands = self.interfaces.commands
        for wheels, side, radius in (
            (self._left, -1.0, self._radii[0]),
            (self._right, 1.0, self._radii[1]),
        ):
            speed = (linear + side * angular * self._separation / 2) / radius
            for wheel in wheels:
                commands[f"{wheel}/{VELOCITY}"] = speed

    def _count(self, linear: float, angular: float, elapsed: float) -> None:
        if self._is_open_loop:
            self._odometry.by_commands(linear, angular, elapsed)
            return
        states, number = self.interfaces.states, len(self._left)
        left, right = (
            sum(states[f"{wheel}/{self._feedback}"] for wheel in wheels) / number
            for wheels in (self._left, self._right)
        )
        if self._feedback == POSITION:
            self._odometry.by_positions(left, right, elapsed)
        else:
            self._odometry.by_velocities(left, right, elapsed)

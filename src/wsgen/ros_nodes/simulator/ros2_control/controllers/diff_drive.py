"""Two wheels, or two rows of wheels, by velocity commands; odometry.

Source: ros-controls/ros2_controllers, diff_drive_controller/src/diff_drive_controller.cpp and its
parameters: Humble and Iron take geometry_msgs/msg/Twist on `~/cmd_vel_unstamped` with
`use_stamped_vel: false`, later releases TwistStamped on `~/cmd_vel` alone.
"""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry

from wsgen.ros_nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.ros_nodes.simulator.ros2_control.hardware import POSITION, VELOCITY
from wsgen.ros_nodes.simulator.ros2_control.wheels import Limits, WheelOdometry


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
        self._separation = parameters.number("wheel_separation") * parameters.number(
            "wheel_separation_multiplier", 1.0
        )
        radius = parameters.number("wheel_radius")
        self._radii = (
            radius * parameters.number("left_wheel_radius_multiplier", 1.0),
            radius * parameters.number("right_wheel_radius_multiplier", 1.0),
        )
        for name, value in (("wheel_separation", self._separation), ("wheel_radius", radius)):
            if not value > 0.0:
                message = f"Invalid value '{value:f}' of the parameter '{name}': it must be above 0"
                raise ControllerError(message)
        self._is_open_loop = parameters.flag("open_loop")
        self._feedback = (
            POSITION if parameters.flag("position_feedback", default=True) else VELOCITY
        )
        wheels = (*self._left, *self._right)
        self.commands = tuple(f"{wheel}/{VELOCITY}" for wheel in wheels)
        self.states = (
            () if self._is_open_loop else tuple(f"{wheel}/{self._feedback}" for wheel in wheels)
        )
        self._timeout = parameters.number("cmd_vel_timeout", 0.5)
        self._linear_limits = Limits.read(parameters, "linear.x", is_former=self._is_former())
        self._angular_limits = Limits.read(parameters, "angular.z", is_former=self._is_former())
        self._window = int(parameters.number("velocity_rolling_window_size", 10))
        self._odometry = self._new_odometry()
        rate = parameters.number("publish_rate", 50.0)
        self._publish_period = 1.0 / rate if rate > 0 else 0.0
        self._next_publish = 0.0
        self._open_topics()

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
        if is_stamped:
            self.subscription(TwistStamped, "~/cmd_vel", self._take)
        else:
            self.subscription(Twist, "~/cmd_vel_unstamped", self._take_unstamped)
        prefix = self._prefix()
        self._odom_publisher = self.publisher(Odometry, "~/odom")
        self._odom = message = Odometry()
        message.header.frame_id = prefix + parameters.text("odom_frame_id", "odom")
        message.child_frame_id = prefix + parameters.text("base_frame_id", "base_link")
        for name, part in (("pose", message.pose), ("twist", message.twist)):
            diagonal = parameters.numbers(f"{name}_covariance_diagonal", [0.0] * 6)
            for index, value in enumerate(diagonal[:6]):
                part.covariance[7 * index] = value
        self._tf_publisher = None
        if parameters.flag("enable_odom_tf", default=True):
            from tf2_msgs.msg import TFMessage  # noqa: PLC0415  if it is wanted

            self._tf_publisher = self.publisher(TFMessage, "/tf")
            transform = TransformStamped()
            transform.header.frame_id = message.header.frame_id
            transform.child_frame_id = message.child_frame_id
            self._tf = TFMessage(transforms=[transform])
        self._limited_publisher = (
            self.publisher(TwistStamped, "~/cmd_vel_out")
            if parameters.flag("publish_limited_velocity")
            else None
        )

    def _prefix(self) -> str:
        """What the names of frames begin with: the namespace, or as it is asked."""
        if not self.parameters.flag("tf_frame_prefix_enable", default=True):
            return ""
        prefix = self.parameters.text("tf_frame_prefix") or self.node.get_namespace()
        prefix = prefix.strip("/")
        return f"{prefix}/" if prefix else ""

    def activate(self) -> None:
        """Stand still until a command comes."""
        self._command: tuple[float, float] | None = None
        self._command_time = self.clock()
        self._last = self._before = (0.0, 0.0)

    def reset(self, now: float) -> None:
        """Stand still where odometry begins."""
        self.activate()
        self._odometry = self._new_odometry()
        self._next_publish = now

    def deactivate(self) -> None:
        """Stop the wheels."""
        self.interfaces.commands.update(dict.fromkeys(self.commands, 0.0))

    def _take(self, message: Any) -> None:
        stamp = message.header.stamp
        time = stamp.sec + stamp.nanosec * 1e-9
        if not time:
            self.warn_once(
                "Received TwistStamped with zero timestamp, setting it to current time, this "
                "message will only be shown once"
            )
            time = self.clock()
        elif self._timeout > 0 and self.clock() - time >= self._timeout:
            self.warn(
                f"Ignoring the received message (timestamp {time:f}) because it is older than the "
                f"current time by {self.clock() - time:f} seconds, which exceeds the allowed "
                f"timeout ({self._timeout:.4f})"
            )
            return
        self._obey(message.twist, time)

    def _take_unstamped(self, message: Any) -> None:
        self._obey(message, self.clock())

    def _obey(self, twist: Any, time: float) -> None:
        if not self.is_active:
            self.warn("Can't accept new commands. subscriber is inactive")
            return
        command = (twist.linear.x, twist.angular.z)
        if all(map(math.isfinite, command)):
            self._command, self._command_time = command, time
        else:
            self.warn_once("Command message contains NaNs. Not updating reference interfaces.")

    def update(self, now: float, elapsed: float) -> None:
        """Turn the wheels, and count their turns."""
        command = self._command or (0.0, 0.0)
        if self._timeout > 0 and now - self._command_time > self._timeout:
            command = (0.0, 0.0)
        linear, angular = (
            limits.next(wanted, last, before, elapsed)
            for limits, wanted, last, before in zip(
                (self._linear_limits, self._angular_limits),
                command,
                self._last,
                self._before,
                strict=True,
            )
        )
        self._before, self._last = self._last, (linear, angular)
        self._count(linear, angular, elapsed)
        if now >= self._next_publish:
            self._next_publish = max(now, self._next_publish + self._publish_period)
            self._publish(now)
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

    def _publish(self, now: float) -> None:
        odometry = self._odometry
        z, w = math.sin(odometry.heading / 2), math.cos(odometry.heading / 2)
        if self._odom_publisher.is_wanted:
            message = self._odom
            message.header.stamp = self.ros.time(now)
            pose, twist = message.pose.pose, message.twist.twist
            pose.position.x, pose.position.y = odometry.x, odometry.y
            pose.orientation.z, pose.orientation.w = z, w
            twist.linear.x, twist.angular.z = odometry.linear, odometry.angular
            self._odom_publisher.publish(message)
        if self._tf_publisher is not None and self._tf_publisher.is_wanted:
            stamped = self._tf.transforms[0]
            stamped.header.stamp = self.ros.time(now)
            place, turn = stamped.transform.translation, stamped.transform.rotation
            place.x, place.y = odometry.x, odometry.y
            turn.z, turn.w = z, w
            self._tf_publisher.publish(self._tf)

"""Two wheels, two rows of wheels, or four mecanum wheels by velocity commands; odometry.

Source: ros-controls/ros2_controllers, diff_drive_controller/src/diff_drive_controller.cpp and its
parameters: Humble and Iron take geometry_msgs/msg/Twist on `~/cmd_vel_unstamped` with
`use_stamped_vel: false`, later releases TwistStamped on `~/cmd_vel` alone.

Of mecanum wheels it is mecanum_drive_controller/src/mecanum_drive_controller.cpp and odometry.cpp.
Limits of speeds are those of the versions since April 2026 (pull request 2313); earlier ones ignore
these parameters. It does not have `~/set_odometry`.
"""

from __future__ import annotations

import math

from geometry_msgs.msg import TwistStamped

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.controllers.topics import (
    OdometryMessages,
    Reference,
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


WHEELS = ("front_left", "front_right", "rear_right", "rear_left")
# How each wheel turns for a speed to the left, and for a turn.
LEFT = (-1.0, 1.0, -1.0, 1.0)
TURN = (-1.0, 1.0, 1.0, -1.0)
COVARIANCES = (0.1,) * 6
SPEEDS = ("linear.x", "linear.y", "angular.z")
KINEMATICS = "kinematics"


class MecanumDriveController(Controller):
    """Drives by `~/reference`; says where it is on `~/odometry` and `~/tf_odometry`."""

    def configure(self) -> None:
        """Read the parameters, open the topics."""
        parameters = self.parameters
        joints = [self.require_text(f"{wheel}_wheel_command_joint_name") for wheel in WHEELS]
        self.commands = tuple(f"{joint}/{VELOCITY}" for joint in joints)
        self._turned = tuple(
            f"{parameters.text(f'{wheel}_wheel_state_joint_name') or joint}/{VELOCITY}"
            for wheel, joint in zip(WHEELS, joints, strict=True)
        )
        self.states = self._turned
        self._radius, self._reach = (
            self.require_length(f"{KINEMATICS}.{name}")
            for name in ("wheels_radius", "sum_of_robot_center_projection_on_X_Y_axis")
        )
        # Of the base in the middle of the wheels: m, m, rad.
        self._offset = tuple(
            parameters.number(f"{KINEMATICS}.base_frame_offset.{one}")
            for one in ("x", "y", "theta")
        )
        self._limits = [Limits.read(parameters, name, is_former=False) for name in SPEEDS]
        self._reference = Reference(self, timeout=parameters.number("reference_timeout"))
        has_tf = parameters.flag("enable_odom_tf", default=True)
        self._messages = OdometryMessages(
            self,
            topics=("~/odometry", "~/tf_odometry" if has_tf else None),
            prefix=namespace_prefix(self),
            covariances=COVARIANCES,
        )
        # Releases of control_msgs differ in what they have.
        from control_msgs.msg import MecanumDriveControllerState  # noqa: PLC0415

        self._status = MecanumDriveControllerState
        self._state_publisher = self.publisher(MecanumDriveControllerState, "~/controller_state")
        self._begin()

    def _begin(self) -> None:
        self._x = self._y = self._heading = 0.0
        self._speeds = (0.0, 0.0, 0.0)  # of the base: m/s, m/s, rad/s
        self._last = self._before = (0.0, 0.0, 0.0)

    def activate(self) -> None:
        """Stand still until a command comes."""
        self._reference.forget()
        self._last = self._before = (0.0, 0.0, 0.0)

    def reset(self, now: float) -> None:  # noqa: ARG002  it has no times of its own
        """Stand still where odometry begins."""
        self.activate()
        self._begin()

    def deactivate(self) -> None:
        """Stop the wheels."""
        self.interfaces.commands.update(dict.fromkeys(self.commands, 0.0))

    def update(self, now: float, elapsed: float) -> None:
        """Count the turns of the wheels, and turn them."""
        self._count(elapsed)
        wanted = self._reference.at(now)
        commands: tuple[float, ...] = (0.0,) * 4
        if wanted is None:
            # The wheels stop at once: the next command begins from there.
            self._last = self._before = (0.0, 0.0, 0.0)
        else:
            limited = tuple(
                limits.next(value, last, before, elapsed)
                for limits, value, last, before in zip(
                    self._limits, wanted, self._last, self._before, strict=True
                )
            )
            self._before, self._last = self._last, (limited[0], limited[1], limited[2])
            commands = self._wheels(*self._last)
        self.interfaces.commands.update(zip(self.commands, commands, strict=True))
        self._messages.publish(
            now, (self._x, self._y, self._heading), self._speeds[:2], self._speeds[2]
        )
        self._publish_state(now, wanted)

    def _wheels(self, ahead: float, left: float, turn: float) -> tuple[float, ...]:
        """How fast the wheels turn (rad/s) for speeds of the base."""
        x, y, theta = self._offset
        cos, sin = math.cos(theta), math.sin(theta)
        forward = cos * ahead - sin * left + y * turn
        aside = sin * ahead + cos * left - x * turn
        return tuple(
            (forward + to_left * aside + around * self._reach * turn) / self._radius
            for to_left, around in zip(LEFT, TURN, strict=True)
        )

    def _count(self, elapsed: float) -> None:
        """Go on with odometry, by how fast the wheels turn."""
        wheels = [self.interfaces.states[name] * self._radius for name in self._turned]
        forward = sum(wheels) / 4
        aside, around = (
            sum(sign * wheel for sign, wheel in zip(signs, wheels, strict=True)) / 4
            for signs in (LEFT, TURN)
        )
        turn = around / self._reach
        x, y, theta = self._offset
        cos, sin = math.cos(theta), -math.sin(theta)
        back_x, back_y = -cos * x + sin * y, -sin * x - cos * y
        ahead = cos * forward - sin * aside + back_y * turn
        left = sin * forward + cos * aside - back_x * turn
        self._speeds = ahead, left, turn
        self._heading += turn * elapsed
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        self._x += (cos * ahead - sin * left) * elapsed
        self._y += (sin * ahead + cos * left) * elapsed

    def _publish_state(self, now: float, wanted: tuple[float, float, float] | None) -> None:
        if not self._state_publisher.is_wanted:
            return
        message = self._status()
        message.header.stamp = self.ros.time(now)
        message.header.frame_id = self.parameters.text("odom_frame_id", "odom")
        states = self.interfaces.states
        (
            message.front_left_wheel_velocity,
            message.front_right_wheel_velocity,
            message.back_right_wheel_velocity,
            message.back_left_wheel_velocity,
        ) = (states[name] for name in self._turned)
        twist = message.reference_velocity
        twist.linear.x, twist.linear.y, twist.angular.z = wanted or (math.nan,) * 3
        self._state_publisher.publish(message)

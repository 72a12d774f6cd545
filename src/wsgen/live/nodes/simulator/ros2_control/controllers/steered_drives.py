"""Robots with steered wheels: the steering controllers library, and the tricycle controller.

Source: ros-controls/ros2_controllers, steering_controllers_library/src and the controllers
ackermann_steering_controller, bicycle_steering_controller and tricycle_steering_controller. They
take the parameters of Humble and Jazzy, too, which name front and rear wheels, and Humble's
`use_stamped_vel`. They do not have `~/set_odometry`.

One wheel that is driven and steered is that of tricycle_controller/src/tricycle_controller.cpp,
odometry.cpp, traction_limiter.cpp and steering_limiter.cpp. Humble and Iron take
geometry_msgs/msg/Twist with `use_stamped_vel: false`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.controllers.topics import (
    OdometryMessages,
    Reference,
    VelocityCommand,
    written_prefix,
)
from wsgen.live.nodes.simulator.ros2_control.hardware import POSITION, VELOCITY
from wsgen.live.nodes.simulator.ros2_control.wheels import Odometry, SteeringBase
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters
    from wsgen.live.nodes.simulator.topics import RosPublisher


COVARIANCES = (0.0, 7.0, 14.0, 21.0, 28.0, 35.0)
FORMER = ("front_wheels_names", "rear_wheels_names")


class SteeringController(Controller):
    """Drives by `~/reference`; says where it is on `~/odometry` and `~/tf_odometry`.

    Attributes:
        kind: What the controllers call themselves in their messages.
        driven: How many wheels turn.
        steered: How many are steered.
    """

    kind = ""
    driven = 1
    steered = 1

    def configure(self) -> None:
        """Read the parameters, open the topics."""
        parameters = self.parameters
        # Which axle is steered, where wheels are those of the front and the rear.
        self._is_former = any(parameters.texts(name) for name in FORMER)
        self._front_steers = parameters.flag("front_steering", default=True)
        self._traction = self._wheels("traction", self.driven)
        self._steering = self._wheels("steering", self.steered)
        self._base = self._measured()
        self._is_open_loop = parameters.flag("open_loop")
        self._waits = parameters.flag("reduce_wheel_speed_until_steering_reached")
        self._feedback = POSITION if parameters.flag("position_feedback") else VELOCITY
        self.commands = (
            *(f"{joint}/{VELOCITY}" for joint in self._traction),
            *(f"{joint}/{POSITION}" for joint in self._steering),
        )
        self._turned = [f"{joint}/{self._feedback}" for joint in self._measured_joints("traction")]
        self._angles = [f"{joint}/{POSITION}" for joint in self._measured_joints("steering")]
        self.states = (*self._turned, *self._angles)
        self._window = int(parameters.number("velocity_rolling_window_size", 10))
        is_stamped = True
        if self.is_former or "use_stamped_vel" in parameters.values:
            is_stamped = parameters.flag("use_stamped_vel")
        self._reference = Reference(
            self, timeout=parameters.number("reference_timeout", 1.0), is_stamped=is_stamped
        )
        has_tf = parameters.flag("enable_odom_tf", default=True)
        self._messages = OdometryMessages(
            self,
            topics=("~/odometry", "~/tf_odometry" if has_tf else None),
            prefix=written_prefix(self),
            covariances=COVARIANCES,
        )
        # Releases of control_msgs differ in what they have.
        from control_msgs.msg import SteeringControllerStatus  # noqa: PLC0415

        self._status = SteeringControllerStatus
        self._status_publisher = self.publisher(SteeringControllerStatus, "~/controller_state")
        self._begin()

    def _begin(self) -> None:
        self._odometry = Odometry(self._window)
        self._last: list[float] | None = None  # positions of the driven wheels, rad

    def _wheels(self, axle: str, count: int) -> list[str]:
        names = self._names(axle, "names")
        if len(names) != count:
            message = (
                f"{self.kind} configuration requires exactly {count} {axle} "
                f"joint{'s' if count > 1 else ''}, but {len(names)} were provided"
            )
            raise ControllerError(message)
        return names

    def _names(self, axle: str, what: str) -> list[str]:
        if not self._is_former:
            return self.parameters.texts(f"{axle}_joints_{what}")
        return self.parameters.texts(f"{self._former_axle(axle)}_wheels_{what}")

    def _former_axle(self, axle: str) -> str:
        return "front" if (axle == "steering") == self._front_steers else "rear"

    def _measured_joints(self, axle: str) -> list[str]:
        return self._names(axle, "state_names") or self._names(axle, "names")

    def _measured(self) -> SteeringBase:
        """The measures in the parameters."""
        wheels = "wheels" if self.driven > 1 else "wheel"
        radius = f"traction_{wheels}_radius"
        if self._is_former:
            wheel = "wheel" if (self.driven, self.steered) == (1, 1) else "wheels"
            radius = f"{self._former_axle('traction')}_{wheel}_radius"
        traction, steering = self._tracks()
        return SteeringBase(
            wheelbase=self.require_length("wheelbase"),
            radius=self.require_length(radius),
            traction_track=traction,
            steering_track=steering,
            driven=self.driven,
            steered=self.steered,
        )

    def _tracks(self) -> tuple[float, float]:
        """The distances of the driven and of the steered wheels, m."""
        return 0.0, 0.0

    def activate(self) -> None:
        """Stand still until a command comes."""
        self._reference.forget()

    def reset(self, now: float) -> None:  # noqa: ARG002  it has no times of its own
        """Stand still where odometry begins."""
        self.activate()
        self._begin()

    def deactivate(self) -> None:
        """Stop the wheels; they stay steered."""
        self._stop()

    def _stop(self) -> None:
        for joint in self._traction:
            self.interfaces.commands[f"{joint}/{VELOCITY}"] = 0.0

    def update(self, now: float, elapsed: float) -> None:
        """Count the turns of the wheels, and turn and steer them."""
        wanted = self._reference.at(now)
        linear, _, angular = wanted or (0.0, 0.0, 0.0)
        steered = self._count(linear, angular, elapsed)
        if wanted is None:
            self._stop()
        else:
            speeds, angles = self._base.commands(
                linear, angular, steered=None if self._is_open_loop else steered, waits=self._waits
            )
            self.interfaces.commands.update(zip(self.commands, (*speeds, *angles), strict=True))
        odometry = self._odometry
        self._messages.publish(
            now,
            (odometry.x, odometry.y, odometry.heading),
            (odometry.linear, 0.0),
            odometry.angular,
        )
        self._publish_status(now)

    def _count(self, linear: float, angular: float, elapsed: float) -> float:
        """Go on with odometry; gives how the wheels are steered, rad."""
        states = self.interfaces.states
        steered = self._base.steered_by([states[name] for name in self._angles])
        if self._is_open_loop:
            self._odometry.by_commands(linear, angular, elapsed)
            return steered
        speeds = [states[name] for name in self._turned]
        if self._feedback == POSITION:
            last, self._last = self._last or speeds, speeds
            if elapsed <= 0.0:
                return steered
            speeds = [(new - old) / elapsed for new, old in zip(speeds, last, strict=True)]
        self._odometry.by_speeds(*self._base.motion(speeds, steered), elapsed)
        return steered

    def _publish_status(self, now: float) -> None:
        if not self._status_publisher.is_wanted:
            return
        states, commands = self.interfaces.states, self.interfaces.commands
        turned = [states[name] for name in self._turned]
        message = self._status()
        message.header.stamp = self.ros.time(now)
        message.header.frame_id = self.parameters.text("odom_frame_id", "odom")
        if self._feedback == POSITION:
            message.traction_wheels_position = turned
        else:
            message.traction_wheels_velocity = turned
        message.steer_positions = [states[name] for name in self._angles]
        driven = self.commands[: self.driven]
        message.traction_command = [commands.get(name, 0.0) for name in driven]
        message.steering_angle_command = [
            commands.get(name, 0.0) for name in self.commands[self.driven :]
        ]
        self._status_publisher.publish(message)


class AckermannSteeringController(SteeringController):
    """Two driven and two steered wheels."""

    kind, driven, steered = "Ackermann", 2, 2

    def _tracks(self) -> tuple[float, float]:
        parameters = self.parameters
        if self._is_former:
            rear, front = (parameters.number(f"{side}_wheel_track") for side in ("rear", "front"))
            return (rear, front) if self._front_steers else (front, rear)
        traction = parameters.number("traction_track_width")
        return traction, parameters.number("steering_track_width") or traction


class BicycleSteeringController(SteeringController):
    """One driven and one steered wheel."""

    kind = "Bicycle"


class TricycleSteeringController(SteeringController):
    """Two driven wheels and a steered one."""

    kind, driven = "Tricycle", 2

    def _tracks(self) -> tuple[float, float]:
        name = "wheel_track" if self._is_former else "traction_track_width"
        return self.parameters.number(name), 0.0


FAR = 1000.0  # the upper bound where the lower one is given alone
MILLISECONDS = 1e-3


@dataclass(frozen=True)
class Bounds:
    """How much something may change in absolute value, whatever its direction."""

    least: float
    most: float

    def of(self, change: float) -> float:
        """The change within the bounds, in its direction."""
        return math.copysign(min(self.most, max(self.least, abs(change))), change)


def bounds(parameters: Parameters, name: str) -> Bounds | None:
    """Those of parameters such as `traction.max_velocity`; None without them.

    Raises:
        ControllerError: One is negative, or they are in the wrong order.
    """
    group, _, what = name.partition(".")
    least = parameters.bound(f"{group}.min_{what}")
    most = parameters.bound(f"{group}.max_{what}")
    if least is None and most is None:
        return None
    found = Bounds(least or 0.0, FAR if most is None else most)
    if found.least < 0 or found.most < found.least:
        message = (
            f"'{group}.min_{what}' and '{group}.max_{what}' must not be negative, and the first "
            "not above the second: they are for both directions"
        )
        raise ControllerError(message)
    return found


class TricycleController(Controller):
    """Drives by `~/cmd_vel`; says where it is on `~/odom` and `/tf`."""

    def configure(self) -> None:
        """Read the parameters, open the topics."""
        parameters = self.parameters
        traction, steering = (
            self.require_text(f"{kind}_joint_name") for kind in ("traction", "steering")
        )
        self._speed, self._angle = f"{traction}/{VELOCITY}", f"{steering}/{POSITION}"
        self.commands = self.states = (self._speed, self._angle)
        self._wheelbase, self._radius = (
            self.require_length(name) for name in ("wheelbase", "wheel_radius")
        )
        self._is_open_loop = parameters.flag("open_loop")
        self._read_limits()
        self._window = int(parameters.number("velocity_rolling_window_size", 10))
        is_former = self.is_former or "use_stamped_vel" in parameters.values
        is_stamped = not is_former or parameters.flag("use_stamped_vel", default=True)
        self._command = VelocityCommand(
            self,
            timeout=parameters.number("cmd_vel_timeout", 500.0) * MILLISECONDS,
            unstamped=None if is_stamped else "~/cmd_vel",
            refuses_old=False,
            not_finite="A command has speeds that are not numbers. It is ignored.",
        )
        has_tf = parameters.flag("enable_odom_tf", default=self.is_former)
        self._messages = OdometryMessages(
            self,
            topics=("~/odom", "/tf" if has_tf else None),
            only_twist=parameters.flag("odom_only_twist"),
        )
        self._out = self._ackermann() if parameters.flag("publish_ackermann_command") else None
        from std_srvs.srv import Empty  # noqa: PLC0415  of nodes

        self.service(Empty, "~/reset_odometry", self._reset_odometry)
        self._begin()

    def _ackermann(self) -> RosPublisher | None:
        try:
            from ackermann_msgs.msg import AckermannDrive  # noqa: PLC0415  if it is wanted
        except ImportError:
            self.warn(
                "'publish_ackermann_command' has no effect: the package ackermann_msgs is not "
                "installed."
            )
            return None
        self._drive = AckermannDrive
        return self.publisher(AckermannDrive, "~/cmd_ackermann")

    def _read_limits(self) -> None:
        parameters = self.parameters
        self._jerk, self._acceleration, self._deceleration, self._fastest = (
            bounds(parameters, f"traction.{what}")
            for what in ("jerk", "acceleration", "deceleration", "velocity")
        )
        self._steering_acceleration, self._steering_speed = (
            bounds(parameters, f"steering.{what}") for what in ("acceleration", "velocity")
        )
        most = parameters.bound("steering.max_position")
        least = parameters.bound("steering.min_position")
        self._most = -least if most is None and least is not None else most
        self._least = -most if least is None and most is not None else least

    def _begin(self) -> None:
        self._odometry = Odometry(self._window)
        self._last = self._before = (0.0, 0.0)  # rad/s of the wheel, rad of the steering

    def _reset_odometry(self, _: Any, response: Any) -> Any:
        self._odometry = Odometry(self._window)
        return response

    def activate(self) -> None:
        """Stand still until a command comes."""
        self._command.forget(self.clock())

    def reset(self, now: float) -> None:
        """Stand still where odometry begins."""
        self._begin()
        self._command.forget(now)

    def deactivate(self) -> None:
        """Stop the wheel, straight ahead."""
        self.interfaces.commands.update({self._speed: 0.0, self._angle: 0.0})

    def update(self, now: float, elapsed: float) -> None:
        """Count the turns of the wheel, and turn and steer it."""
        linear, angular = self._command.at(now)
        turning, steered = (self.interfaces.states[name] for name in self.states or ())
        odometry = self._odometry
        if self._is_open_loop:
            odometry.by_commands(linear, angular, elapsed)
        else:
            rim = turning * self._radius
            odometry.by_speeds(
                rim * math.cos(steered), rim * math.sin(steered) / self._wheelbase, elapsed
            )
        place = odometry.x, odometry.y, odometry.heading
        self._messages.publish(now, place, (odometry.linear, 0.0), odometry.angular)
        speed, angle = self._limited(*self._steered(linear, angular, steered), elapsed)
        self.interfaces.commands.update({self._speed: speed, self._angle: angle})
        if self._out is not None and self._out.is_wanted:
            self._out.publish(self._drive(speed=speed, steering_angle=angle))

    def _steered(self, linear: float, angular: float, steered: float) -> tuple[float, float]:
        """Speed of the wheel (rad/s), less until it is steered so, and its angle (rad)."""
        if linear == 0.0 and angular != 0.0:
            angle = math.copysign(math.pi / 2, angular)
            speed = abs(angular) * self._wheelbase / self._radius
        else:
            angle = math.atan(angular * self._wheelbase / linear) if angular else 0.0
            speed = linear / (self._radius * math.cos(angle))
        off = abs(angle - steered)
        if off > math.pi / 2:
            speed *= 0.01
        elif off >= math.pi / 6:
            speed *= math.cos(off)
        return speed, angle

    def _limited(self, speed: float, angle: float, elapsed: float) -> tuple[float, float]:
        last, before, twice = self._last, self._before, 2 * elapsed * elapsed
        if self._jerk is not None:
            rate = last[0] - before[0]
            speed = last[0] + rate + _scaled(self._jerk, twice).of(speed - last[0] - rate)
        grows = abs(speed) >= abs(last[0])
        # Without bounds of acceleration, those of deceleration do not count either.
        acceleration = self._acceleration if grows else self._deceleration
        if self._acceleration is not None and acceleration is not None:
            speed = last[0] + _scaled(acceleration, elapsed).of(speed - last[0])
        if self._fastest is not None:
            speed = self._fastest.of(speed)
        if self._steering_acceleration is not None:
            rate = last[1] - before[1]
            change = _scaled(self._steering_acceleration, twice).of(angle - last[1] - rate)
            angle = last[1] + rate + change
        if self._steering_speed is not None:
            angle = last[1] + _scaled(self._steering_speed, elapsed).of(angle - last[1])
        if self._most is not None and self._least is not None:
            angle = min(self._most, max(self._least, angle))
        self._before, self._last = last, (speed, angle)
        return speed, angle


def _scaled(found: Bounds, factor: float) -> Bounds:
    return Bounds(found.least * factor, found.most * factor)

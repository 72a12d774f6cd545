"""Robots with steered wheels: the controllers of the steering controllers library.

Source: ros-controls/ros2_controllers, steering_controllers_library/src and the controllers
ackermann_steering_controller, bicycle_steering_controller and tricycle_steering_controller. They
take the parameters of Humble and Jazzy, too, which name front and rear wheels, and Humble's
`use_stamped_vel`. They do not have `~/set_odometry`.
"""

from __future__ import annotations

from typing import Any

from control_msgs.msg import SteeringControllerStatus

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.controllers.topics import (
    OdometryMessages,
    Reference,
    written_prefix,
)
from wsgen.live.nodes.simulator.ros2_control.hardware import POSITION, VELOCITY
from wsgen.live.nodes.simulator.ros2_control.wheels import Odometry, SteeringBase

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
        message: Any = SteeringControllerStatus()
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

"""Drives with four mecanum wheels, of Gazebo Sim.

Sources: gazebosim/gz-sim, src/systems/mecanum_drive/MecanumDrive.cc; gazebosim/gz-math,
src/MecanumDriveOdometry.cc. The drive turns the wheels alone: their rollers are what the robot is
described with, by <fdir1> of the friction of each wheel, which MuJoCo simulates.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

from geometry_msgs.msg import Twist

from wsgen.live.nodes.simulator.elements import topics_of
from wsgen.live.nodes.simulator.host import Plugin
from wsgen.live.nodes.simulator.messages import can_follow_twist
from wsgen.live.nodes.simulator.plugins.drives import (
    DrivePublisher,
    driven_joints,
    length,
    limits,
)
from wsgen.live.nodes.simulator.plugins.wheels import STRAIGHT
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.simulation.controllers import limited_motor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element

WHEELS = ("front_left_joint", "front_right_joint", "back_left_joint", "back_right_joint")
WINDOW = 0.01  # s; gz-math takes the mean of ten steps, of 1 ms each


class MecanumBase(NamedTuple):
    """The measures of a robot, m."""

    separation: float  # of its left and right wheels
    wheel_base: float  # of its front and back wheels
    radius: float

    def wheels(self, ahead: float, left: float, turn: float) -> tuple[float, float, float, float]:
        """How fast wheels turn (rad/s) for speeds (m/s, rad/s), in the order of `WHEELS`."""
        around = turn * (self.separation + self.wheel_base) / 2
        return (
            (ahead - left - around) / self.radius,
            (ahead + left + around) / self.radius,
            (ahead + left - around) / self.radius,
            (ahead - left + around) / self.radius,
        )

    def motion(self, wheels: Sequence[float]) -> tuple[float, float, float]:
        """The opposite: how far it goes ahead and to the left and turns, as its wheels turn."""
        front_left, front_right, back_left, back_right = (angle * self.radius for angle in wheels)
        return (
            (front_left + front_right + back_left + back_right) / 4,
            (-front_left + front_right + back_left - back_right) / 4,
            (-front_left + front_right - back_left + back_right)
            / (2 * (self.separation + self.wheel_base)),
        )


class MecanumOdometry:
    """Where a robot is by how far its four wheels have turned, as `gz::math::MecanumDriveOdometry`.

    Attributes:
        x: m, where it began to the front.
        y: m, to the left.
        heading: rad.
        speeds: Ahead and to the left (m/s) and its turn (rad/s), the mean of `WINDOW`.
    """

    def __init__(self, base: MecanumBase) -> None:
        self._base = base
        self.reset()

    def reset(self) -> None:
        """Begin again where it is."""
        self._last: tuple[tuple[float, ...], float] | None = None
        self._recent: deque[tuple[float, tuple[float, float, float]]] = deque()
        self.x = self.y = self.heading = 0.0
        self.speeds = (0.0, 0.0, 0.0)

    def update(self, wheels: Sequence[float], now: float) -> None:
        """Take in the positions of the wheels (rad) at a time (s)."""
        last, self._last = self._last, (tuple(wheels), now)
        if last is None or now <= last[1]:
            return
        turned = [new - old for new, old in zip(wheels, last[0], strict=True)]
        ahead, left, turn = self._base.motion(turned)
        # A step along an arc, whose chord is at half of the turn.
        share = 1.0 if abs(turn) < STRAIGHT else 2 * math.sin(turn / 2) / turn
        direction = self.heading + turn / 2
        cos, sin = share * math.cos(direction), share * math.sin(direction)
        self.x += ahead * cos - left * sin
        self.y += ahead * sin + left * cos
        self.heading = math.remainder(self.heading + turn, math.tau)
        self._recent.append((now - last[1], (ahead, left, turn)))
        while len(self._recent) > 1 and sum(time for time, _ in self._recent) > WINDOW + 1e-9:
            self._recent.popleft()
        seconds = sum(time for time, _ in self._recent)
        ahead, left, turn = (
            sum(motion[place] for _, motion in self._recent) / seconds for place in range(3)
        )
        self.speeds = ahead, left, turn


class GzMecanum(Plugin):
    """`gz-sim-mecanum-drive-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self._joints = driven_joints(host, robot, element, *WHEELS)
        self._base = MecanumBase(
            separation=length(element, "wheel_separation"),
            wheel_base=length(element, "wheelbase"),
            radius=length(element, "wheel_radius"),
        )
        self._limits = limits(element)
        self._control = Timer(host.update_seconds, host.now)
        self._odometry = MecanumOdometry(self._base)
        self._topic = topics_of(host, robot, element)["command"]
        host.subscription(robot, Twist, self._topic, self._take)
        self._publisher = DrivePublisher(host, robot, element)
        self._begin()

    def _begin(self) -> None:
        self._wanted = (0.0, 0.0, 0.0)  # m/s, m/s, rad/s
        self._last = self._before = (0.0, 0.0, 0.0)
        self._updated = self._host.now

    def _take(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._topic):
            self._wanted = message.linear.x, message.linear.y, message.angular.z

    def update(self) -> None:
        """Turn the wheels, and publish where the robot is by them."""
        now, odometry, timer = self._host.now, self._odometry, self._publisher.timer
        if self._control.is_due(now):
            self._drive()
        positions = self._robot.joint_positions()
        odometry.update([positions[side[0].name] for side in self._joints], now)
        if timer.is_due(now):
            ahead, left, turn = odometry.speeds
            self._publisher.publish((odometry.x, odometry.y, odometry.heading), (ahead, left), turn)
        self.period = until_next(now, self._control, timer)

    def _drive(self) -> None:
        seconds = self._host.now - self._updated or self._host.update_seconds
        self._updated = self._host.now
        ahead, left, turn = (
            self._limits.next(last, wanted, seconds, before)
            for wanted, last, before in zip(self._wanted, self._last, self._before, strict=True)
        )
        self._before, self._last = self._last, (ahead, left, turn)
        speeds = self._base.wheels(ahead, left, turn)
        self._robot.drive(
            {
                joint.name: limited_motor(joint, speed)
                for side, speed in zip(self._joints, speeds, strict=True)
                for joint in side
            }
        )

    def reset(self) -> None:
        """Stand still at the origin of the odometry."""
        self._begin()
        self._odometry.reset()
        for timer in (self._control, self._publisher.timer):
            timer.reset(self._host.now)

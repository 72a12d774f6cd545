"""Robots that move sideways, too: by command, whatever drives them, or by four mecanum wheels.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_planar_move.cpp (branch
ros2); gazebosim/gz-sim, src/systems/velocity_control/VelocityControl.cc and
src/systems/mecanum_drive/MecanumDrive.cc; gazebosim/gz-math, src/MecanumDriveOdometry.cc. A drive
with mecanum wheels, of Gazebo Sim, turns the wheels alone: their rollers are what the robot is
described with, by <fdir1> of the friction of each wheel, which MuJoCo simulates.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

from geometry_msgs.msg import Twist

from wsgen.live.nodes.simulator.elements import number, topics_of, vector
from wsgen.live.nodes.simulator.host import Plugin
from wsgen.live.nodes.simulator.messages import can_follow_twist, yaw_of
from wsgen.live.nodes.simulator.plugins.drives import (
    ClassicOdometry,
    DrivePublisher,
    GzDrive,
    driven_joints,
    length,
    limited_motors,
    limits,
)
from wsgen.live.nodes.simulator.plugins.wheels import STRAIGHT
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.model.transform import rotate, rotation_of_quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element
    from wsgen.simulation.engine import Motor


class PlanarMove(Plugin):
    """`libgazebo_ros_planar_move.so`.

    Between two of its updates friction slows the robot down, as in Gazebo.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        rate, publish_rate = (number(element, name) for name in ("update_rate", "publish_rate"))
        self._control = Timer(1 / rate if rate > 0 else host.step_seconds, host.now)
        # As in the plugin, which looks at the other rate and divides by this one: 1 / 0 is never.
        self._is_silent = rate > 0 and publish_rate == 0
        every = 1 / publish_rate if rate > 0 and publish_rate > 0 else host.step_seconds
        self._publishing = Timer(every, host.now)
        self._node = host.node(robot, element)
        self._command = (0.0, 0.0, 0.0)  # m/s, m/s, rad/s
        topics = topics_of(host, robot, element)
        host.subscription(robot, Twist, topics["command"], self._take, node=self._node, depth=1)
        self._odometry = ClassicOdometry(host, robot, element, self._node)

    def _take(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._node.resolve_topic_name("cmd_vel")):
            self._command = message.linear.x, message.linear.y, message.angular.z

    def update(self) -> None:
        """Set the velocity, and publish where the robot is."""
        now = self._host.now
        if self._control.is_due(now):
            ahead, left, turning = self._command
            yaw = yaw_of(self._robot.state().xyzw)
            cos, sin = math.cos(yaw), math.sin(yaw)
            self._robot.set_velocity(
                (ahead * cos - left * sin, left * cos + ahead * sin, 0.0), (0.0, 0.0, turning)
            )
        if self._publishing.is_due(now) and not self._is_silent:
            self._odometry.publish_true()
        self.period = until_next(now, self._control, self._publishing)

    def reset(self) -> None:
        """Stand still."""
        self._command = (0.0, 0.0, 0.0)
        for timer in (self._control, self._publishing):
            timer.reset(self._host.now)


class VelocityControl(Plugin):
    """`gz-sim-velocity-control-system`, for the whole model: its <link_name>s are not simulated."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self.period = host.step_seconds  # nothing slows the robot down
        self._initial = tuple(vector(element, f"initial_{kind}") for kind in ("linear", "angular"))
        self._linear, self._angular = self._initial
        self._topic = topics_of(host, robot, element)["command"]
        host.subscription(robot, Twist, self._topic, self._take)
        if element.find("link_name") is not None:
            host.warn(
                f"`{robot.entity}`: wsgen does not simulate the <link_name>s of its velocity "
                "control; commands to the whole model are."
            )

    def _take(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._topic):
            linear, angular = message.linear, message.angular
            self._linear = linear.x, linear.y, linear.z
            self._angular = angular.x, angular.y, angular.z

    def update(self) -> None:
        """Set the velocity, which is given in the robot's frame."""
        rotation = rotation_of_quaternion(self._robot.state().xyzw)
        linear, angular = (rotate(rotation, (x, y, z)) for x, y, z in (self._linear, self._angular))
        self._robot.set_velocity(linear, angular)

    def reset(self) -> None:
        """Begin again."""
        self._linear, self._angular = self._initial


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


class GzMecanum(GzDrive):
    """`gz-sim-mecanum-drive-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._joints = driven_joints(host, robot, element, *WHEELS)
        self._base = MecanumBase(
            separation=length(element, "wheel_separation"),
            wheel_base=length(element, "wheelbase"),
            radius=length(element, "wheel_radius"),
        )
        super().__init__(host, robot, (limits(element),) * 3)
        self._odometry = MecanumOdometry(self._base)
        self._topic = topics_of(host, robot, element)["command"]
        host.subscription(robot, Twist, self._topic, self._take)
        self._publisher = DrivePublisher(host, robot, element)

    def _motors(self, speeds: tuple[float, ...]) -> dict[str, Motor]:
        return limited_motors(self._joints, self._base.wheels(*speeds))

    def _count(self, now: float) -> None:
        positions = self._robot.joint_positions()
        self._odometry.update([positions[side[0].name] for side in self._joints], now)

    def _speeds(self) -> tuple[tuple[float, float], float]:
        ahead, left, turn = self._odometry.speeds
        return (ahead, left), turn

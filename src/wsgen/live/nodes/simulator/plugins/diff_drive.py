"""Differential drives: of Gazebo Classic and of Gazebo Sim.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_diff_drive.cpp (branch ros2);
gazebosim/gz-sim, src/systems/diff_drive/DiffDrive.cc; gazebosim/gz-math, src/SpeedLimiter.cc and
src/DiffDriveOdometry.cc. Neither stops when commands cease: the last one holds until the next.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist
from std_msgs.msg import Bool

from wsgen.descriptions.urdf.diff_drive import UnusableError, read_drive
from wsgen.gazebo.plugins import TWO_WHEELS
from wsgen.live.nodes.simulator.elements import boolean, number, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.messages import can_follow_twist, of_yaw
from wsgen.live.nodes.simulator.plugins.drives import (
    ClassicOdometry,
    DrivePublisher,
    GzDrive,
    driven_joints,
    limited_motors,
    values_of,
)
from wsgen.live.nodes.simulator.plugins.wheels import SlipWatch, WheelOdometry
from wsgen.model.target import CLASSIC, SIM
from wsgen.simulation.controllers import ode_motor

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.behavior import DiffDrive
    from wsgen.model.devices import Element
    from wsgen.simulation.engine import Motor

REACHED = 0.01  # m/s; Classic's plugin takes a speed that is so near for the wanted one
WORLD = 1  # odometry_source of Classic's plugin: where the robot is, instead of its wheels


class ClassicDiffDrive(Plugin):
    """`libgazebo_ros_diff_drive.so`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        drive = _read(CLASSIC, robot, element)
        self._pairs, self._acceleration = drive.pairs, drive.rim.acceleration
        self._torque = drive.torque or 0.0
        self._joints = {joint.name: joint for joint in robot.robot.movable_joints}
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else host.step_seconds
        self._node = host.node(robot, element)
        self._linear = self._angular = 0.0  # as commanded
        self._instructed = dict.fromkeys(
            (name for pair in self._pairs for name in (pair.left, pair.right)), 0.0
        )  # m/s, of the rims
        self._last = host.now
        first = self._pairs[0]
        self._encoder = WheelOdometry(first.separation, first.radius, first.radius)
        self._slip = SlipWatch(host, robot, first, tuple(self._instructed))
        self._from_world = int(number(element, "odometry_source")) == WORLD
        topics = topics_of(host, robot, element)
        host.subscription(robot, Twist, topics["command"], self._command, node=self._node, depth=1)
        wheels = [one for one in robot.robot.joints if one.name in self._instructed]
        has_wheels = boolean(element, "publish_wheel_tf")
        self._odometry = ClassicOdometry(
            host, robot, element, self._node, wheels if has_wheels else ()
        )

    def _command(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._node.resolve_topic_name("cmd_vel")):
            self._linear, self._angular = message.linear.x, message.angular.z

    def update(self) -> None:
        """Publish where the robot is, then turn the wheels."""
        if not self._from_world:
            positions, first = self._robot.joint_positions(), self._pairs[0]
            self._encoder.update(positions[first.left], positions[first.right], self._host.now)
        if self._odometry.is_wanted:
            self._publish()
        self._drive()
        self._slip.look()
        self._last = self._host.now

    def _publish(self) -> None:
        if self._from_world:
            self._odometry.publish_true()
            return
        wheels = self._encoder
        # The plugin gives the length of the velocity, which is never negative.
        speed = abs(wheels.linear), 0.0
        place, turned = (wheels.x, wheels.y, 0.0), of_yaw(wheels.heading)
        self._odometry.publish(place, turned, speed, wheels.angular)

    def _drive(self) -> None:
        is_free = math.isinf(self._acceleration)
        speeds = {} if is_free else self._robot.joint_velocities()
        most = self._acceleration * (self._host.now - self._last)
        motors = {}
        for pair in self._pairs:
            rims_of_pair = pair.speeds(self._linear, self._angular)
            wanted = dict(zip((pair.left, pair.right), rims_of_pair, strict=True))
            rims = {name: speeds.get(name, 0.0) * pair.radius for name in wanted}
            if is_free or all(abs(wanted[name] - rims[name]) < REACHED for name in wanted):
                given = wanted
            else:
                for name, rim in wanted.items():
                    change = min(most, max(-most, rim - rims[name]))
                    self._instructed[name] += change
                given = {name: self._instructed[name] for name in wanted}
            for name, rim in given.items():
                motors[name] = ode_motor(self._joints[name], rim / pair.radius, self._torque)
        self._robot.drive(motors)

    def reset(self) -> None:
        """Stand still at the origin of the encoder."""
        self._linear = self._angular = 0.0
        self._instructed = dict.fromkeys(self._instructed, 0.0)
        self._last = self._host.now
        self._encoder.reset()
        self._slip.reset()


def _read(kind: str, robot: RobotHandle, element: Element) -> DiffDrive:
    try:
        return read_drive(kind, values_of(element), robot.robot)
    except UnusableError as error:
        raise CannotWorkError(f"{error.why.reason}. {error.why.hint}") from None


class GzDiffDrive(GzDrive):
    """`gz-sim-diff-drive-system`."""

    _is_enabled = True

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        drive = _read(SIM, robot, element)
        super().__init__(host, robot, (drive.linear, drive.angular))
        self._sides = driven_joints(host, robot, element, *TWO_WHEELS)
        self._wheel_pair = pair = drive.pairs[0]
        self._odometry = WheelOdometry(pair.separation, pair.radius, pair.radius)
        driven = tuple(joint.name for side in self._sides for joint in side)
        self._slip = SlipWatch(host, robot, pair, driven)
        topics = topics_of(host, robot, element)
        self._topic = topics["command"]
        host.subscription(robot, Twist, self._topic, self._take)
        host.subscription(robot, Bool, topics["enable"], self._enable)
        self._publisher = DrivePublisher(host, robot, element)

    def _take(self, message: Any) -> None:
        if self._is_enabled:
            super()._take(message)

    def _enable(self, message: Any) -> None:
        self._is_enabled = message.data
        if not self._is_enabled:
            self._wanted = (0.0, 0.0)

    def _motors(self, speeds: tuple[float, ...]) -> dict[str, Motor]:
        pair = self._wheel_pair
        return limited_motors(self._sides, (rim / pair.radius for rim in pair.speeds(*speeds)))

    def _count(self, now: float) -> None:
        positions = self._robot.joint_positions()
        left, right = (positions[side[0].name] for side in self._sides)
        self._odometry.update(left, right, now)

    def update(self) -> None:
        """As in the base, and look whether the wheels slip."""
        super().update()
        self._slip.look()

    def reset(self) -> None:
        """Stand still at the origin of the odometry."""
        super().reset()
        self._is_enabled = True
        self._slip.reset()

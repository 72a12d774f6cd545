"""Differential drives: of Gazebo Classic and of Gazebo Sim.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_diff_drive.cpp (branch ros2);
gazebosim/gz-sim, src/systems/diff_drive/DiffDrive.cc; gazebosim/gz-math, src/SpeedLimiter.cc and
src/DiffDriveOdometry.cc. Neither stops when commands cease: the last one holds until the next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

from wsgen.model.transform import compose, invert
from wsgen.ros_nodes.simulator.elements import boolean, number, numbers
from wsgen.ros_nodes.simulator.host import CannotWorkError, Plugin
from wsgen.ros_nodes.simulator.messages import (
    can_follow_twist,
    in_heading,
    of_yaw,
    planar_covariance,
    set_pose,
    set_transform,
    set_transform_to,
    set_twist,
    yaw_of,
)
from wsgen.ros_nodes.simulator.plugins.gz_drive import (
    DrivePublisher,
    driven_joints,
    joint_names,
    length,
    limits,
)
from wsgen.ros_nodes.simulator.plugins.slip import SlipWatch, Wheels
from wsgen.ros_nodes.simulator.plugins.wheels import WheelOdometry
from wsgen.ros_nodes.simulator.timing import Timer, until_next
from wsgen.simulation.controllers import limited_motor
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from wsgen.model.devices import Element
    from wsgen.model.transform import Vector
    from wsgen.ros_nodes.simulator.host import Host, RobotHandle
    from wsgen.ros_nodes.simulator.messages import Quaternion

REACHED = 0.01  # m/s; Classic's plugin takes a speed that is so near for the wanted one
WORLD = 1  # odometry_source of Classic's plugin: where the robot is, instead of its wheels


class ClassicDiffDrive(Plugin):
    """`libgazebo_ros_diff_drive.so`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self._pairs = _classic_pairs(robot, element)
        self._torque = number(element, "max_wheel_torque", 5.0)
        self._acceleration = number(element, "max_wheel_acceleration", 0.0)
        rate = number(element, "update_rate", 100.0)
        self.period = 1 / rate if rate > 0 else host.step_seconds
        self._node = host.node(name=element.attributes.get("name"), ros=element.find("ros"))
        self._linear = self._angular = 0.0  # as commanded
        self._instructed = dict.fromkeys(
            (name for pair in self._pairs for name in (pair.left, pair.right)), 0.0
        )  # m/s, of the rims
        self._last = host.now
        first = self._pairs[0]
        self._encoder = WheelOdometry(first.separation, first.radius, first.radius)
        self._slip = SlipWatch(host, robot, first, tuple(self._instructed))
        self._from_world = number(element, "odometry_source", WORLD) == WORLD
        self._odometry_frame = element.get("odometry_frame", "odom")
        self._base_frame = element.get("robot_base_frame", "base_footprint")
        host.subscription(robot, Twist, "cmd_vel", self._command, node=self._node, depth=1)
        self._odometry = self._message(element)
        self._odometry_publisher = (
            host.publisher(robot, Odometry, "odom", node=self._node, depth=1)
            if boolean(element, "publish_odom", default=False)
            else None
        )
        self._has_odom_tf = boolean(element, "publish_odom_tf", default=False)
        self._has_wheel_tf = boolean(element, "publish_wheel_tf", default=False)
        self._tf = (
            host.publisher(robot, TFMessage, "/tf", node=self._node, depth=100)
            if self._has_odom_tf or self._has_wheel_tf
            else None
        )
        self._transforms = TFMessage(transforms=[TransformStamped()] if self._has_odom_tf else [])
        self._wheel_joints = [
            joint for joint in robot.robot.joints if joint.name in self._instructed
        ]

    def _message(self, element: Element) -> Any:
        message = Odometry(child_frame_id=self._base_frame)
        message.header.frame_id = self._odometry_frame
        covariance = planar_covariance(
            number(element, "covariance_x", 1e-5),
            number(element, "covariance_y", 1e-5),
            number(element, "covariance_yaw", 1e-3),
        )
        message.pose.covariance = covariance
        message.twist.covariance = covariance
        return message

    def _command(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._node.resolve_topic_name("cmd_vel")):
            self._linear, self._angular = message.linear.x, message.angular.z

    def update(self) -> None:
        """Publish where the robot is, then turn the wheels."""
        if not self._from_world:
            positions, first = self._robot.joint_positions(), self._pairs[0]
            self._encoder.update(positions[first.left], positions[first.right], self._host.now)
        wants_odometry = self._odometry_publisher is not None and (
            self._odometry_publisher.is_wanted
        )
        if wants_odometry or (self._tf is not None and self._tf.is_wanted):
            self._publish()
        self._drive()
        self._slip.look()
        self._last = self._host.now

    def _publish(self) -> None:
        stamp = self._host.stamp()
        xyz, xyzw, linear, angular = self._by_world() if self._from_world else self._by_wheels()
        if self._odometry_publisher is not None:
            self._odometry.header.stamp = stamp
            set_pose(self._odometry.pose.pose, xyz, xyzw)
            set_twist(self._odometry.twist.twist, (*linear, 0.0), (0.0, 0.0, angular))
            self._odometry_publisher.publish(self._odometry)
        if self._tf is None:
            return
        if self._has_odom_tf:
            message = self._transforms.transforms[0]
            message.header.stamp, message.header.frame_id = stamp, self._odometry_frame
            message.child_frame_id = self._base_frame
            set_transform(message.transform, xyz, xyzw)
            self._tf.publish(self._transforms)
        if self._has_wheel_tf:
            self._tf.publish(TFMessage(transforms=self._wheel_transforms(stamp)))

    def _by_world(self) -> tuple[Vector, Quaternion, tuple[float, float], float]:
        state = self._robot.state()
        linear, angular = self._robot.root_velocity()
        return state.xyz, state.xyzw, in_heading(yaw_of(state.xyzw), linear), angular[2]

    def _by_wheels(self) -> tuple[Vector, Quaternion, tuple[float, float], float]:
        wheels = self._encoder
        # The plugin gives the length of the velocity, which is never negative.
        speed = abs(wheels.linear), 0.0
        return (wheels.x, wheels.y, 0.0), of_yaw(wheels.heading), speed, wheels.angular

    def _wheel_transforms(self, stamp: Any) -> list[Any]:
        """From the robot to its wheels, each below the name of the link that carries it."""
        poses, made = self._robot.link_poses(), []
        from_world = invert(poses[self._robot.robot.root])
        for joint in self._wheel_joints:
            message = TransformStamped(child_frame_id=joint.child)
            message.header.stamp, message.header.frame_id = stamp, joint.parent
            set_transform_to(message.transform, compose(from_world, poses[joint.child]))
            made.append(message)
        return made

    def _drive(self) -> None:
        speeds = self._robot.joint_velocities() if self._acceleration else {}
        most = self._acceleration * (self._host.now - self._last)
        motors = {}
        for pair in self._pairs:
            half = self._angular * pair.separation / 2
            wanted = {pair.left: self._linear - half, pair.right: self._linear + half}
            rims = {name: speeds.get(name, 0.0) * pair.radius for name in wanted}
            if not self._acceleration or all(
                abs(wanted[name] - rims[name]) < REACHED for name in wanted
            ):
                given = wanted
            else:
                for name, rim in wanted.items():
                    change = min(most, max(-most, rim - rims[name]))
                    self._instructed[name] += change
                given = {name: self._instructed[name] for name in wanted}
            for name, rim in given.items():
                motors[name] = Motor(rim / pair.radius, self._torque)
        self._robot.drive(motors)

    def reset(self) -> None:
        """Stand still at the origin of the encoder."""
        self._linear = self._angular = 0.0
        self._instructed = dict.fromkeys(self._instructed, 0.0)
        self._last = self._host.now
        self._encoder.reset()
        self._slip.reset()

    def close(self) -> None:
        """End its node."""
        self._host.ros.forget_node(self._node)


def _classic_pairs(robot: RobotHandle, element: Element) -> list[Wheels]:
    left, right = (joint_names(robot, element, side) for side in ("left_joint", "right_joint"))
    count = max(1, round(number(element, "num_wheel_pairs", 1.0)))
    if len(left) != len(right) or len(left) != count:
        raise CannotWorkError(
            f"it names {len(left)} left and {len(right)} right joints for {count} pairs of wheels. "
            "Write one <left_joint> and one <right_joint> for each pair, and their number into "
            "<num_wheel_pairs>."
        )
    separations = [*numbers(element, "wheel_separation"), *[0.34] * count]
    diameters = [*numbers(element, "wheel_diameter"), *[0.15] * count]
    return [
        Wheels(one, other, separation, _radius(diameter))
        for one, other, separation, diameter in zip(
            left, right, separations[:count], diameters[:count], strict=True
        )
    ]


def _radius(diameter: float) -> float:
    if not diameter > 0:
        raise CannotWorkError(f"its <wheel_diameter> is {diameter:g}. Write a length in meters.")
    return diameter / 2


class GzDiffDrive(Plugin):
    """`gz-sim-diff-drive-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        self._left, self._right = driven_joints(robot, element, "left_joint", "right_joint")
        self._radius = length(element, "wheel_radius", 0.2)
        self._separation = length(element, "wheel_separation", 1.0)
        self._linear_limits = limits(element, "linear")
        self._angular_limits = limits(element, "angular")
        self._control = Timer(host.update_seconds, host.now)
        self._wheels = WheelOdometry(self._separation, self._radius, self._radius)
        names = self._left[0].name, self._right[0].name
        self._slip = SlipWatch(
            host,
            robot,
            Wheels(*names, self._separation, self._radius),
            tuple(joint.name for joint in (*self._left, *self._right)),
        )
        model = f"/model/{robot.entity}"
        self._topic = element.get("topic") or f"{model}/cmd_vel"
        host.subscription(robot, Twist, self._topic, self._command)
        host.subscription(robot, Bool, f"{model}/enable", self._enable)
        self._publisher = DrivePublisher(host, robot, element)
        self._begin()

    def _begin(self) -> None:
        self._is_enabled = True
        self._wanted = (0.0, 0.0)  # m/s, rad/s
        self._last = self._before = (0.0, 0.0)
        self._updated = self._host.now

    def _command(self, message: Any) -> None:
        if self._is_enabled and can_follow_twist(self._host, message, self._topic):
            self._wanted = message.linear.x, message.angular.z

    def _enable(self, message: Any) -> None:
        self._is_enabled = message.data
        if not self._is_enabled:
            self._wanted = (0.0, 0.0)

    def update(self) -> None:
        """Turn the wheels, and publish where the robot is by them."""
        now = self._host.now
        if self._control.is_due(now):
            self._drive()
        positions = self._robot.joint_positions()
        self._wheels.update(positions[self._left[0].name], positions[self._right[0].name], now)
        if self._publisher.timer.is_due(now):
            wheels = self._wheels
            place = wheels.x, wheels.y, wheels.heading
            self._publisher.publish(place, (wheels.linear, 0.0), wheels.angular)
        self._slip.look()
        self.period = until_next(now, self._control, self._publisher.timer)

    def _drive(self) -> None:
        seconds = self._host.now - self._updated or self._host.update_seconds
        self._updated = self._host.now
        linear, angular = (
            limits.next(wanted, last, before, seconds)
            for limits, wanted, last, before in zip(
                (self._linear_limits, self._angular_limits),
                self._wanted,
                self._last,
                self._before,
                strict=True,
            )
        )
        self._before, self._last = self._last, (linear, angular)
        half = angular * self._separation / 2
        self._robot.drive(
            {
                joint.name: limited_motor(joint, rim / self._radius)
                for side, rim in ((self._left, linear - half), (self._right, linear + half))
                for joint in side
            }
        )

    def reset(self) -> None:
        """Stand still at the origin of the odometry."""
        self._begin()
        self._wheels.reset()
        self._slip.reset()
        for timer in (self._control, self._publisher.timer):
            timer.reset(self._host.now)

"""What drives have in common: joints, limits, and odometry that they publish.

Sources: gazebosim/gz-sim, src/systems/diff_drive/DiffDrive.cc,
src/systems/ackermann_steering/AckermannSteering.cc and src/systems/mecanum_drive/MecanumDrive.cc;
ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_diff_drive.cpp,
gazebo_ros_ackermann_drive.cpp and gazebo_ros_planar_move.cpp (branch ros2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from wsgen.descriptions.urdf.diff_drive import UnusableError, read_bounds
from wsgen.live.nodes.simulator.elements import boolean, number, text, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.messages import (
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
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.model.transform import compose, invert
from wsgen.simulation.controllers import limited_motor

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.messages import Quaternion
    from wsgen.model.behavior import Bounds
    from wsgen.model.devices import Element
    from wsgen.model.robot import Joint
    from wsgen.model.transform import Vector
    from wsgen.simulation.engine import Motor


class DrivePublisher:
    """Publishes where the wheels say that a robot is, on two topics of Gazebo.

    Attributes:
        timer: When it does.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host = host
        frequency = number(element, "odom_publish_frequency")
        self.timer = Timer(1 / frequency if frequency > 0 else 0.0, host.now)
        topics = topics_of(host, robot, element)
        self._publisher = host.publisher(robot, Odometry, topics["odometry"])
        self._tf = host.publisher(robot, TFMessage, topics["tf"])
        self._odometry = Odometry(child_frame_id=text(element, "child_frame_id", robot))
        self._odometry.header.frame_id = text(element, "frame_id", robot)
        self._transforms = TFMessage(
            transforms=[TransformStamped(child_frame_id=self._odometry.child_frame_id)]
        )

    def publish(
        self, place: tuple[float, float, float], speed: tuple[float, float], turning: float
    ) -> None:
        """Say the place (x, y: m, heading: rad), the speed ahead and to the left, and rad/s."""
        wants_tf = self._tf.is_wanted
        if not (wants_tf or self._publisher.is_wanted):
            return
        message = self._odometry
        xyz, xyzw = (place[0], place[1], 0.0), of_yaw(place[2])
        message.header.stamp = self._host.stamp()
        set_pose(message.pose.pose, xyz, xyzw)
        set_twist(message.twist.twist, (*speed, 0.0), (0.0, 0.0, turning))
        self._publisher.publish(message)
        if wants_tf:
            transform = self._transforms.transforms[0]
            transform.header = message.header
            set_transform(transform.transform, xyz, xyzw)
            self._tf.publish(self._transforms)


class GzDrive(Plugin):
    """A drive of Gazebo Sim: follows commands within limits, says by its wheels where it is.

    A command is the speed ahead, m/s, that to the left where there are three, and the turn, rad/s.
    """

    _topic: str  # of commands
    _publisher: DrivePublisher | None = None  # None: it says nothing
    _odometry: Any  # of the kind of drive: `x`, `y` and `heading`, and the speeds of the base

    def __init__(
        self, host: Host, robot: RobotHandle, bounds: Sequence[Bounds], period: float | None = None
    ) -> None:
        """Begin; `bounds` are those of each speed, `period` of the control, s."""
        self._host, self._robot, self._bounds = host, robot, bounds
        self._control = Timer(period or host.update_seconds, host.now)
        self._begin()

    def _begin(self) -> None:
        self._wanted = self._last = self._before = (0.0,) * len(self._bounds)
        self._updated = self._host.now

    def _take(self, message: Any) -> None:
        if can_follow_twist(self._host, message, self._topic):
            linear, turn = message.linear, message.angular.z
            has_left = len(self._bounds) > 2  # noqa: PLR2004  speeds
            self._wanted = (linear.x, linear.y, turn) if has_left else (linear.x, turn)

    def _motors(self, speeds: tuple[float, ...]) -> dict[str, Motor]:
        """What the joints are to do for speeds of the base."""
        raise NotImplementedError

    def _count(self, now: float) -> None:
        """Take into the odometry how far the wheels have turned."""
        raise NotImplementedError

    def _speeds(self) -> tuple[tuple[float, float], float]:
        """The speed ahead and to the left, and the turn, by the odometry."""
        return (self._odometry.linear, 0.0), self._odometry.angular

    def update(self) -> None:
        """Turn the wheels, and publish where the robot is by them."""
        now, publisher, odometry = self._host.now, self._publisher, self._odometry
        if self._control.is_due(now):
            seconds = now - self._updated or self._control.period
            self._updated = now
            of_each = zip(self._bounds, self._last, self._wanted, self._before, strict=True)
            speeds = tuple(
                one.next(last, wanted, seconds, past) for one, last, wanted, past in of_each
            )
            self._before, self._last = self._last, speeds
            self._robot.drive(self._motors(speeds))
        timers = [self._control]
        if publisher is not None:
            self._count(now)
            if publisher.timer.is_due(now):
                publisher.publish((odometry.x, odometry.y, odometry.heading), *self._speeds())
            timers.append(publisher.timer)
        self.period = until_next(now, *timers)

    def reset(self) -> None:
        """Stand still at the origin of the odometry."""
        self._begin()
        self._odometry.reset()
        self._control.reset(self._host.now)
        if self._publisher is not None:
            self._publisher.timer.reset(self._host.now)


def limited_motors(sides: Iterable[Iterable[Joint]], speeds: Iterable[float]) -> dict[str, Motor]:
    """A motor for each joint, by the speeds (rad/s or m/s) of the groups that they are in."""
    return {
        joint.name: limited_motor(joint, speed)
        for side, speed in zip(sides, speeds, strict=True)
        for joint in side
    }


def driven_joints(
    host: Host, robot: RobotHandle, element: Element, *tags: str
) -> list[list[Joint]]:
    """Those of several tags, each of which must name one that the robot has; others are named.

    Raises:
        CannotWorkError: A tag names none that the robot has.
    """
    movable = {joint.name: joint for joint in robot.robot.movable_joints}
    found: list[list[Joint]] = []
    for tag in tags:
        names = [one.text for one in element.find_all(tag)]
        found.append([movable[name] for name in names if name in movable])
        for name in names:
            if name not in movable:
                host.warn(
                    f"`{robot.entity}`: the plugin `{element.attributes.get('filename', '')}` "
                    f"names the joint `{name}`, but the robot has no joint `{name}` that can turn. "
                    f"Write the names of its wheels' joints into <{tag}>."
                )
    missing = [f"<{tag}>" for tag, joints in zip(tags, found, strict=True) if not joints]
    if missing:
        raise CannotWorkError(f"the robot does not have its {' and '.join(missing)}.")
    return found


def length(element: Element, name: str) -> float:
    """A length in meters, above 0.

    Raises:
        CannotWorkError: It is not.
    """
    value = number(element, name)
    if not value > 0:
        raise CannotWorkError(f"its <{name}> is {value:g}. Write a length in meters.")
    return value


def values_of(element: Element) -> dict[str, tuple[str, ...]]:
    """The texts of its parameters."""
    found: dict[str, tuple[str, ...]] = {}
    for child in element.children:
        found[child.tag] = (*found.get(child.tag, ()), child.text)
    return found


def limits(element: Element) -> Bounds:
    """What speeds are allowed.

    Raises:
        CannotWorkError: One is not a number.
    """
    try:
        return read_bounds(values_of(element))
    except UnusableError as error:
        raise CannotWorkError(f"{error.why.reason}. {error.why.hint}") from None


class ClassicOdometry:
    """Publishes where a drive of Gazebo Classic says that its robot and its wheels are."""

    def __init__(
        self,
        host: Host,
        robot: RobotHandle,
        element: Element,
        node: Any,
        wheels: Iterable[Joint] = (),
    ) -> None:
        """Open the topics; `wheels` are those whose transforms are published."""
        self._host, self._robot, self._wheels = host, robot, tuple(wheels)
        self._has_tf = boolean(element, "publish_odom_tf")
        topics = topics_of(host, robot, element)
        found = (("odometry", Odometry, 1), ("tf", TFMessage, 100))
        self._publisher, self._tf = (  # None where the plugin is not to publish them
            host.publisher(robot, kind, topics[use], node=node, depth=depth)
            if use in topics
            else None
            for use, kind, depth in found
        )
        base = text(element, "robot_base_frame", robot)
        self._message = message = Odometry(child_frame_id=base)
        message.header.frame_id = text(element, "odometry_frame", robot)
        x, y, yaw = (number(element, f"covariance_{name}") for name in ("x", "y", "yaw"))
        message.pose.covariance = message.twist.covariance = planar_covariance(x, y, yaw)
        self._transforms = TFMessage(transforms=[TransformStamped(child_frame_id=base)])

    @property
    def is_wanted(self) -> bool:
        """Whether anybody reads it."""
        return any(one is not None and one.is_wanted for one in (self._publisher, self._tf))

    def publish_true(self) -> None:
        """Publish where the robot is in the world, and its velocity along its heading."""
        state = self._robot.state()
        linear, angular = self._robot.root_velocity()
        ahead = in_heading(yaw_of(state.xyzw), linear)
        self.publish(state.xyz, state.xyzw, ahead, angular[2])

    def publish(
        self, xyz: Vector, xyzw: Quaternion, speed: tuple[float, float], turning: float
    ) -> None:
        """Publish a place, the speed ahead and to the left (m/s), and the turning (rad/s)."""
        message = self._message
        message.header.stamp = self._host.stamp()
        set_pose(message.pose.pose, xyz, xyzw)
        set_twist(message.twist.twist, (*speed, 0.0), (0.0, 0.0, turning))
        if self._publisher is not None:
            self._publisher.publish(message)
        if self._tf is None or not self._tf.is_wanted:
            return
        if self._wheels:
            self._tf.publish(TFMessage(transforms=self._wheel_transforms(message.header.stamp)))
        if self._has_tf:
            transform = self._transforms.transforms[0]
            transform.header = message.header
            set_transform(transform.transform, xyz, xyzw)
            self._tf.publish(self._transforms)

    def _wheel_transforms(self, stamp: Any) -> list[Any]:
        """From the robot to its wheels, each below the name of the link that carries it."""
        poses, made = self._robot.link_poses(), []
        from_world = invert(poses[self._robot.robot.root])
        for joint in self._wheels:
            message = TransformStamped(child_frame_id=joint.child)
            message.header.stamp, message.header.frame_id = stamp, joint.parent
            set_transform_to(message.transform, compose(from_world, poses[joint.child]))
            made.append(message)
        return made

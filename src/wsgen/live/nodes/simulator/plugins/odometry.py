"""Where a robot is, by the simulation: Sim's odometry and pose publishers, Classic's p3d.

Sources: gazebosim/gz-sim, src/systems/odometry_publisher/OdometryPublisher.cc and
src/systems/pose_publisher/PosePublisher.cc; ros-simulation/gazebo_ros_pkgs,
gazebo_plugins/src/gazebo_ros_p3d.cpp (branch ros2).
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from wsgen.live.nodes.simulator.elements import boolean, number, text, topics_of, vector
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.messages import (
    in_heading,
    set_pose,
    set_transform,
    set_transform_to,
    set_twist,
    yaw_of,
)
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.model.transform import (
    Pose,
    compose,
    invert,
    multiply,
    quaternion_of_rpy,
    rotate,
    rotation_of_quaternion,
    rotation_of_rpy,
    rpy_of_rotation,
    transpose,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element
    from wsgen.model.transform import Vector

DIMENSIONS = (2, 3)
INERTIAL = ("/world", "world", "/map", "map")  # frames of p3d that are that of the world


class _Noise:
    """Normally distributed, the same in each run."""

    def __init__(self, deviation: float, name: str) -> None:
        self.deviation = deviation
        self._random = random.Random(name)  # noqa: S311  it is no secret

    def on(self, values: Vector) -> Vector:
        """The values with noise."""
        if not self.deviation:
            return values
        x, y, z = (value + self._random.gauss(0.0, self.deviation) for value in values)
        return x, y, z

    def covariance(self) -> list[float]:
        """Of a pose or twist, 6 by 6."""
        return [self.deviation**2 if place % 7 == 0 else 0.0 for place in range(36)]


def _offset(element: Element, *names: str) -> Pose:
    """Given by `xyz_offset` and `rpy_offset`; by older names, too."""
    values: list[Vector] = []
    for kind in ("xyz", "rpy"):
        name = next((f"{kind}_{one}" for one in names if element.get(f"{kind}_{one}")), "")
        x, y, z = vector(element, name or f"{kind}_{names[0]}")
        values.append((x, y, z))
    return Pose(xyz=values[0], rpy=values[1])


class OdometryPublisher(Plugin):
    """`gz-sim-odometry-publisher-system`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        frequency = number(element, "odom_publish_frequency")
        self.period = 1 / frequency if frequency > 0 else host.step_seconds
        self._dimensions = int(number(element, "dimensions"))
        if self._dimensions not in DIMENSIONS:
            raise CannotWorkError(f"its <dimensions> is {self._dimensions}. Write 2 or 3.")
        self._offset = _offset(element, "offset")
        self._noise = _Noise(number(element, "gaussian_noise"), robot.entity)
        topics = topics_of(host, robot, element)
        self._plain, self._covariant = (
            host.publisher(robot, Odometry, topics[use]) for use in ("odometry", "covariance")
        )
        self._tf = host.publisher(robot, TFMessage, topics["tf"])
        base = text(element, "robot_base_frame", robot)
        self._message = Odometry(child_frame_id=base)
        self._message.header.frame_id = text(element, "odom_frame", robot)
        self._message_with_covariance = Odometry(child_frame_id=base)
        covariance = self._noise.covariance()
        self._message_with_covariance.pose.covariance = covariance
        self._message_with_covariance.twist.covariance = covariance
        self._transforms = TFMessage(transforms=[TransformStamped(child_frame_id=base)])

    def update(self) -> None:
        """Publish where the robot is."""
        if not any(one.is_wanted for one in (self._plain, self._covariant, self._tf)):
            return
        state, message = self._robot.state(), self._message
        linear, angular = self._robot.root_velocity()
        xyz, xyzw = state.xyz, state.xyzw
        if self._offset != Pose():
            turned = rotation_of_quaternion(xyzw)
            pose = compose(Pose(xyz=xyz, rpy=rpy_of_rotation(turned)), self._offset)
            lever = tuple(b - a for a, b in zip(xyz, pose.xyz, strict=True))
            linear = _moved(linear, angular, (lever[0], lever[1], lever[2]))
            xyz, xyzw = pose.xyz, quaternion_of_rpy(pose.rpy)
        to_body = transpose(rotation_of_quaternion(xyzw))
        if self._dimensions == DIMENSIONS[0]:
            xyz = (xyz[0], xyz[1], 0.0)
            linear = (*in_heading(yaw_of(xyzw), linear), 0.0)
            angular = (0.0, 0.0, rotate(to_body, angular)[2])
        else:
            linear, angular = rotate(to_body, linear), rotate(to_body, angular)
        message.header.stamp = self._host.stamp()
        set_pose(message.pose.pose, xyz, xyzw)
        set_twist(message.twist.twist, self._noise.on(linear), self._noise.on(angular))
        self._plain.publish(message)
        if self._covariant.is_wanted:
            full = self._message_with_covariance
            full.header, full.pose.pose = message.header, message.pose.pose
            full.twist.twist = message.twist.twist
            self._covariant.publish(full)
        if self._tf.is_wanted:
            transform = self._transforms.transforms[0]
            transform.header = message.header
            set_transform(transform.transform, xyz, xyzw)
            self._tf.publish(self._transforms)


def _moved(linear: Vector, angular: Vector, lever: Vector) -> Vector:
    """The velocity of another point of a body."""
    a, b, c = angular
    x, y, z = lever
    return linear[0] + b * z - c * y, linear[1] + c * x - a * z, linear[2] + a * y - b * x


class GroundTruth(Plugin):
    """`libgazebo_ros_p3d.so`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else host.step_seconds
        links = [link.name for link in robot.robot.links]
        self._link = element.get("body_name")
        if self._link not in links:
            raise CannotWorkError(
                f"the robot has no link `{self._link}` in Gazebo, which merges links that fixed "
                f"joints join. Write one of these into <body_name>: {', '.join(links)}."
            )
        frame = text(element, "frame_name", robot)
        self._reference = frame if frame not in INERTIAL else None
        if self._reference is not None and self._reference not in links:
            host.warn(
                f"`{robot.entity}`: p3d takes the world for its <frame_name>: the robot has no "
                f"link `{frame}`."
            )
            self._reference = None
        self._offset = _offset(element, "offset", "offsets")
        self._noise = _Noise(number(element, "gaussian_noise"), robot.entity)
        self._node = host.node(robot, element)
        topic = topics_of(host, robot, element)["odometry"]
        self._publisher = host.publisher(robot, Odometry, topic, node=self._node, depth=5)
        self._message = Odometry(child_frame_id=self._link)
        self._message.header.frame_id = frame
        covariance = self._noise.covariance()
        self._message.pose.covariance = self._message.twist.covariance = covariance

    def update(self) -> None:
        """Publish where the link is."""
        if not self._publisher.is_wanted:
            return
        poses, velocities = self._robot.link_poses(), self._robot.link_velocities()
        pose, (linear, angular) = poses[self._link], velocities[self._link]
        if self._reference is not None:
            frame, (its_linear, its_angular) = poses[self._reference], velocities[self._reference]
            # The plugin turns velocities to the world, not from it; so do we.
            to_world = rotation_of_rpy(frame.rpy)
            linear, angular = (
                rotate(to_world, (a[0] - b[0], a[1] - b[1], a[2] - b[2]))
                for a, b in ((linear, its_linear), (angular, its_angular))
            )
            pose = compose(invert(frame), pose)
        x, y, z = (a + b for a, b in zip(pose.xyz, self._offset.xyz, strict=True))
        turned = multiply(rotation_of_rpy(self._offset.rpy), rotation_of_rpy(pose.rpy))
        message = self._message
        message.header.stamp = self._host.stamp()
        set_pose(message.pose.pose, (x, y, z), quaternion_of_rpy(rpy_of_rotation(turned)))
        set_twist(message.twist.twist, self._noise.on(linear), self._noise.on(angular))
        self._publisher.publish(message)


class PosePublisher(Plugin):
    """`gz-sim-pose-publisher-system`: poses of the links in their model, and of that in the world.

    Those of visuals, collisions and sensors are not published. <topic> is read from Gazebo Sim 8.12
    on. A static publisher has what no joint moves in relation to the root link.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        frequency = number(element, "update_frequency")
        self._every = Timer(1 / frequency if frequency > 0 else 0.0, host.now)
        frequency = number(element, "static_update_frequency", frequency)
        self._every_static = Timer(1 / frequency if frequency > 0 else 0.0, host.now)
        self._has_links = boolean(element, "publish_link_pose")
        nested = boolean(element, "publish_nested_model_pose")
        self._has_model = boolean(element, "publish_model_pose", default=nested)
        for kind in ("visual", "collision", "sensor"):
            if boolean(element, f"publish_{kind}_pose"):
                host.warn(
                    f"`{robot.entity}`: wsgen does not publish the poses of <publish_{kind}_pose>."
                )
        self._are_together = boolean(element, "use_pose_vector_msg")
        topics = topics_of(host, robot, element)
        message = TFMessage if self._are_together else TransformStamped
        uses = ("poses", "static") if self._are_together else ("pose", "single static")
        self._publisher, self._static = (
            host.publisher(robot, message, topics[use]) if use in topics else None for use in uses
        )
        self._movable = {
            link for joint in robot.robot.movable_joints for link in (joint.parent, joint.child)
        } - {robot.robot.root}

    def update(self) -> None:
        """Publish what is due."""
        now = self._host.now
        timers = [self._every]
        if self._static is None:
            if self._every.is_due(now):
                self._publish(self._publisher, is_wanted=lambda _: True)
        else:
            timers.append(self._every_static)
            if self._every_static.is_due(now):
                self._publish(self._static, is_wanted=lambda link: link not in self._movable)
            if self._every.is_due(now):
                self._publish(self._publisher, is_wanted=lambda link: link in self._movable)
        self.period = max(self._host.update_seconds, until_next(now, *timers))

    def _publish(self, publisher: Any, is_wanted: Callable[[str | None], bool]) -> None:
        """Publish the poses of the links that are wanted, and of the model, whose link is None."""
        if not publisher.is_wanted:
            return
        entity, root = self._robot.entity, self._robot.robot.root
        poses, stamp = self._robot.link_poses(), self._host.stamp()
        model = poses[root]
        placed: list[tuple[str, str, Pose]] = []
        if self._has_model and is_wanted(None):
            placed.append((self._host.world, entity, model))
        if self._has_links:
            from_world = invert(model)
            placed += [
                (entity, f"{entity}/{link}", compose(from_world, pose))
                for link, pose in poses.items()
                if is_wanted(link)
            ]
        transforms = []
        for frame, child, pose in placed:
            message = TransformStamped(child_frame_id=child)
            message.header.stamp, message.header.frame_id = stamp, frame
            set_transform_to(message.transform, pose)
            transforms.append(message)
        if not self._are_together:
            for message in transforms:
                publisher.publish(message)
        elif transforms:
            publisher.publish(TFMessage(transforms=transforms))

    def reset(self) -> None:
        """Begin again."""
        for timer in (self._every, self._every_static):
            timer.reset(self._host.now)

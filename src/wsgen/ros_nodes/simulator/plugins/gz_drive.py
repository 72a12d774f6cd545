"""What the drives of Gazebo Sim have in common: joints, limits, and odometry that they publish.

Sources: gazebosim/gz-sim, src/systems/diff_drive/DiffDrive.cc,
src/systems/ackermann_steering/AckermannSteering.cc and src/systems/mecanum_drive/MecanumDrive.cc.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from wsgen.ros_nodes.simulator.elements import number
from wsgen.ros_nodes.simulator.host import CannotWorkError
from wsgen.ros_nodes.simulator.messages import of_yaw, set_pose, set_transform, set_twist
from wsgen.ros_nodes.simulator.plugins.wheels import Limits
from wsgen.ros_nodes.simulator.timing import Timer

if TYPE_CHECKING:
    from wsgen.model.devices import Element
    from wsgen.model.robot import Joint
    from wsgen.ros_nodes.simulator.host import Host, RobotHandle


class DrivePublisher:
    """Publishes where the wheels say that a robot is, on two topics of Gazebo.

    Attributes:
        timer: When it does.
    """

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host = host
        frequency = number(element, "odom_publish_frequency", 50.0)
        self.timer = Timer(1 / frequency if frequency > 0 else 0.0, host.now)
        model = f"/model/{robot.entity}"
        topic = element.get("odom_topic") or f"{model}/odometry"
        self._publisher = host.publisher(robot, Odometry, topic)
        topic = element.get("tf_topic") or f"{model}/tf"
        self._tf = host.publisher(robot, TFMessage, topic)
        self._odometry = Odometry(
            child_frame_id=element.get("child_frame_id") or f"{robot.entity}/{robot.robot.root}"
        )
        self._odometry.header.frame_id = element.get("frame_id") or f"{robot.entity}/odom"
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


def joint_names(robot: RobotHandle, element: Element, tag: str) -> list[str]:
    """The joints that elements with a tag name.

    Raises:
        CannotWorkError: The robot does not have one of them.
    """
    movable = {joint.name for joint in robot.robot.movable_joints}
    names = [found.text for found in element.find_all(tag)]
    for name in names:
        if name not in movable:
            raise CannotWorkError(
                f"the robot has no joint `{name}` that can turn. Write the names of its wheels' "
                f"joints into <{tag}>."
            )
    return names


def driven_joints(robot: RobotHandle, element: Element, *tags: str) -> list[list[Joint]]:
    """Those of several tags, each of which must name one.

    Raises:
        CannotWorkError: A tag names none, or one that the robot does not have.
    """
    joints = {joint.name: joint for joint in robot.robot.movable_joints}
    names = [joint_names(robot, element, tag) for tag in tags]
    if not all(names):
        missing = [f"<{tag}>" for tag, found in zip(tags, names, strict=True) if not found]
        raise CannotWorkError(f"it names no {' and no '.join(missing)}.")
    return [[joints[name] for name in found] for found in names]


def length(element: Element, name: str, default: float) -> float:
    """A length in meters, above 0.

    Raises:
        CannotWorkError: It is not.
    """
    value = number(element, name, default)
    if not value > 0:
        raise CannotWorkError(f"its <{name}> is {value:g}. Write a length in meters.")
    return value


def limits(element: Element, motion: str = "") -> Limits:
    """What speeds are allowed; a key without the kind of motion is for both kinds."""

    def bound(side: str, what: str) -> float:
        default = -math.inf if side == "min" else math.inf
        both = number(element, f"{side}_{what}", default)
        return number(element, f"{side}_{motion}_{what}", both) if motion else both

    return Limits(
        slowest=bound("min", "velocity"),
        fastest=bound("max", "velocity"),
        braking=bound("min", "acceleration"),
        acceleration=bound("max", "acceleration"),
        least_jerk=bound("min", "jerk"),
        jerk=bound("max", "jerk"),
    )

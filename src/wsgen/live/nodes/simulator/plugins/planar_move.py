"""Robots that move by command, whatever drives them: Classic's planar move, Sim's velocities.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_planar_move.cpp (branch
ros2); gazebosim/gz-sim, src/systems/velocity_control/VelocityControl.cc.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import TransformStamped, Twist
from tf2_msgs.msg import TFMessage

from wsgen.live.nodes.simulator.elements import number, topics_of, vector
from wsgen.live.nodes.simulator.host import Plugin
from wsgen.live.nodes.simulator.messages import (
    can_follow_twist,
    in_heading,
    set_pose,
    set_transform,
    set_twist,
    yaw_of,
)
from wsgen.live.nodes.simulator.plugins.drives import (
    classic_odometry,
    classic_publishers,
)
from wsgen.live.nodes.simulator.timing import Timer, until_next
from wsgen.model.transform import rotate, rotation_of_quaternion

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element


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
        self._node = host.node(name=element.attributes.get("name"), ros=element.find("ros"))
        self._command = (0.0, 0.0, 0.0)  # m/s, m/s, rad/s
        topics = topics_of(host, robot, element)
        host.subscription(robot, Twist, topics["command"], self._take, node=self._node, depth=1)
        self._publisher, self._tf = classic_publishers(host, robot, element, self._node)
        self._odometry = classic_odometry(robot, element)
        self._transforms = TFMessage(
            transforms=[TransformStamped(child_frame_id=self._odometry.child_frame_id)]
        )

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
            self._publish()
        self.period = until_next(now, self._control, self._publishing)

    def _publish(self) -> None:
        message, state = self._odometry, self._robot.state()
        linear, angular = self._robot.root_velocity()
        message.header.stamp = self._host.stamp()
        set_pose(message.pose.pose, state.xyz, state.xyzw)
        ahead, left = in_heading(yaw_of(state.xyzw), linear)
        set_twist(message.twist.twist, (ahead, left, 0.0), (0.0, 0.0, angular[2]))
        if self._publisher is not None:
            self._publisher.publish(message)
        if self._tf is not None:
            transform = self._transforms.transforms[0]
            transform.header = message.header
            set_transform(transform.transform, state.xyz, state.xyzw)
            self._tf.publish(self._transforms)

    def reset(self) -> None:
        """Stand still."""
        self._command = (0.0, 0.0, 0.0)
        for timer in (self._control, self._publishing):
            timer.reset(self._host.now)

    def close(self) -> None:
        """End its node."""
        self._host.ros.forget_node(self._node)


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

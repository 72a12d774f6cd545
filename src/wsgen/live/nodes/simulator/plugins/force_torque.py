"""`libgazebo_ros_ft_sensor.so`: what the child link of a joint exerts on the joint.

Source: ros-simulation/gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_ft_sensor.cpp (branch ros2);
gazebosim/gazebo-classic, gazebo/physics/ode/ODEJoint.cc (`GetForceTorque`, whose `body2Force` is
seen from the child link, about its origin in URDF). Without <update_rate> it publishes in each
step; here no more often than other plugins are updated.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from geometry_msgs.msg import WrenchStamped

from wsgen.live.nodes.simulator.elements import number, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.model.transform import rotate, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element


class ClassicForceTorque(Plugin):
    """The plugin, of a joint."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        self._host, self._robot = host, robot
        if element.get("body_name"):
            raise CannotWorkError("wsgen does not measure a <body_name>. Name a <joint_name>.")
        name = element.get("joint_name")
        joint = next((one for one in robot.robot.joints if one.name == name), None)
        if joint is None:
            raise CannotWorkError(
                f"the robot has no joint `{name}`, or sdformat lumps it. Write the <joint_name> of "
                "a joint that moves, or keep it: <gazebo reference="
                f'"{name}"><preserveFixedJoint>true</preserveFixedJoint></gazebo>.'
            )
        if element.find("frame_name") is not None:
            host.warn(
                f"`{robot.entity}`: its force-torque sensor ignores the <frame_name> of a joint."
            )
        self._joint = joint
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else None
        self._deviation = number(element, "gaussian_noise")
        self._random = random.Random(f"{robot.entity}/{name}")  # noqa: S311  it is no secret
        self._node = host.node(name=element.attributes.get("name"), ros=element.find("ros"))
        topic = topics_of(host, robot, element)["wrench"]
        self._publisher = host.publisher(robot, WrenchStamped, topic, node=self._node, depth=1)
        self._message = WrenchStamped()
        self._message.header.frame_id = joint.child.rpartition("::")[2]
        robot.joint_wrench(name)  # engines measure from now on

    def update(self) -> None:
        """Publish, where somebody listens."""
        if not self._publisher.is_wanted:
            return
        message, joint = self._message, self._joint
        message.header.stamp = self._host.stamp()
        to_child = transpose(rotation_of_rpy(self._robot.link_poses()[joint.child].rpy))
        for part, vector in zip(
            (message.wrench.force, message.wrench.torque),
            self._robot.joint_wrench(joint.name),
            strict=True,
        ):
            part.x, part.y, part.z = (
                self._random.gauss(0.0, self._deviation) - value
                for value in rotate(to_child, vector)
            )
        self._publisher.publish(message)

    def reset(self) -> None:
        """Nothing: what was measured before does not matter."""

    def close(self) -> None:
        """End its node."""
        self._host.ros.forget_node(self._node)

"""What is published of joints: their states, and what the child link of one exerts on it.

Joint state publishers are those of Gazebo Classic and of Gazebo Sim: ros-simulation/
gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_joint_state_publisher.cpp (branch ros2);
gazebosim/gz-sim, src/systems/joint_state_publisher/JointStatePublisher.cc, and of gazebosim/ros_gz
the conversion of gz.msgs.Model.

Forces: `libgazebo_ros_ft_sensor.so`, gazebo_plugins/src/gazebo_ros_ft_sensor.cpp (branch
ros2); gazebosim/gazebo-classic, gazebo/physics/ode/ODEJoint.cc (`GetForceTorque`, whose
`body2Force` is seen from the child link, about its origin in URDF). Without <update_rate> it
publishes in each step; here no more often than other plugins are updated.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import JointState

from wsgen.live.nodes.simulator.elements import number, topics_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.model.transform import rotate, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.topics import Publisher
    from wsgen.model.devices import Element
    from wsgen.model.robot import Joint, Robot


class _JointStates(Plugin):
    """Publishes positions and velocities of joints."""

    _publisher: Publisher

    def __init__(
        self, host: Host, robot: RobotHandle, element: Element, *, with_efforts: bool
    ) -> None:
        self._host, self._robot = host, robot
        self._with_efforts = with_efforts
        there = [joint.name for joint in self._joints(robot.robot)]
        named = [found.text for found in element.find_all("joint_name")]
        for name in named:
            if name not in there:
                host.warn(
                    f"`{robot.entity}`: the joint state publisher names the joint `{name}`, which "
                    "the robot does not have or which is fixed."
                )
        self._message = JointState(name=self._chosen(named, there))

    def _joints(self, robot: Robot) -> Iterable[Joint]:
        """Those that it can publish."""
        return robot.movable_joints

    def _chosen(self, named: Sequence[str], there: Sequence[str]) -> list[str]:
        """Those that it publishes, in the order of its messages."""
        return [name for name in named if name in there]

    def update(self) -> None:
        """Publish them."""
        if not self._publisher.is_wanted:
            return
        message, names = self._message, self._message.name
        message.header.stamp = self._host.stamp()
        positions, velocities = self._robot.joint_positions(), self._robot.joint_velocities()
        message.position = [positions.get(name, 0.0) for name in names]
        message.velocity = [velocities.get(name, 0.0) for name in names]
        if self._with_efforts:
            efforts = self._robot.joint_efforts()
            message.effort = [efforts.get(name, 0.0) for name in names]
        self._publisher.publish(message)


class ClassicJointStates(_JointStates):
    """`libgazebo_ros_joint_state_publisher.so`."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        super().__init__(host, robot, element, with_efforts=False)
        if element.find("joint_name") is None or not self._message.name:
            raise CannotWorkError("it does not name a joint of the robot. Write <joint_name>s.")
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else host.step_seconds
        self._node = host.node(robot, element)
        topic = topics_of(host, robot, element)["states"]
        self._publisher = host.publisher(robot, JointState, topic, node=self._node, depth=1000)


class GzJointStates(_JointStates):
    """`gz-sim-joint-state-publisher-system`: has a set of joints, and fixed ones in it."""

    def __init__(self, host: Host, robot: RobotHandle, element: Element) -> None:
        super().__init__(host, robot, element, with_efforts=True)
        rate = number(element, "update_rate")
        # Gazebo publishes at every step without a rate, 1 kHz, which costs every node in Python a
        # tenth of a core.
        self.period = 1 / rate if rate > 0 else max(GZ_PERIOD, host.step_seconds)
        topic = topics_of(host, robot, element)["states"]
        self._publisher = host.publisher(robot, JointState, topic)

    def _joints(self, robot: Robot) -> Iterable[Joint]:
        return robot.joints_in_gazebo

    def _chosen(self, named: Sequence[str], there: Sequence[str]) -> list[str]:
        return [name for name in there if name in named or not named]


GZ_PERIOD = 0.01  # s, simulated


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
        self._node = host.node(robot, element)
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

"""Force-torque sensors of joints.

Gazebo Sim publishes gz.msgs.Wrench on `/world/…/joint/JOINT/sensor/NAME/forcetorque` or <topic>
(gazebosim/gz-sim, src/systems/force_torque/ForceTorque.cc; gazebosim/gz-sensors,
src/ForceTorqueSensor.cc). Gazebo Classic's sensor has no topic of ROS; ros2_control reads it, and
the plugin `gazebo_ros_ft_sensor` measures a joint by itself (../plugins/force_torque.py).

What the child link exerts on the parent link is measured (SDF's `child_to_parent`), about the
origin of the sensor (in Gazebo Classic: of the joint) and in the frame of the child, or as <frame>
and <measure_direction> say.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import WrenchStamped

from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Noise, Sensor, put, rotation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import MountedSensor

    Floats = NDArray[np.float64]

FRAMES = ("child", "parent", "sensor")
DIRECTIONS = {"child_to_parent": -1.0, "parent_to_child": 1.0}


class JointLoad(Sensor):
    """What a joint carries, as a force-torque sensor of it measures."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        joint = next((one for one in robot.robot.joints if one.name == sensor.frame), None)
        if joint is None:
            raise CannotWorkError(
                f"it is on the link `{sensor.frame}`. Put it on a joint: "
                '<gazebo reference="JOINT"> in a URDF.'
            )
        self._joint = joint
        element = sensor.element
        self._frame = element.get("force_torque/frame", FRAMES[0]) or FRAMES[0]
        direction = element.get("force_torque/measure_direction") or "child_to_parent"
        if self._frame not in FRAMES or direction not in DIRECTIONS:
            raise CannotWorkError(
                f"its <frame> is `{self._frame}` and its <measure_direction> `{direction}`. Write "
                f"{' or '.join(FRAMES)}, and {' or '.join(DIRECTIONS)}."
            )
        self._sign = DIRECTIONS[direction]
        random = np.random.default_rng(self.seed)
        self._noises = [
            Noise(element.find(f"force_torque/{what}/{axis}/noise"), random)
            for what in ("force", "torque")
            for axis in "xyz"
        ]
        robot.joint_wrench(joint.name)  # engines measure from now on

    def measure(self) -> tuple[Floats, Floats]:
        """The force (N) and the torque (N m)."""
        force, torque = map(np.array, self.robot.joint_wrench(self._joint.name))
        poses, pose = self.robot.link_poses(), self.pose()
        if self.host.simulator != "classic":
            torque = torque + np.cross(np.array(poses[self._joint.child].xyz) - pose.xyz, force)
        links = {"child": self._joint.child, "parent": self._joint.parent}
        seen_from = poses.get(links.get(self._frame, ""), pose)
        turn = rotation(seen_from).T * self._sign
        values = np.concatenate((turn @ force, turn @ torque))
        measured = np.array(
            [noise.apply(value) for noise, value in zip(self._noises, values, strict=True)]
        )
        return measured[:3], measured[3:]


class ForceTorque(JointLoad):
    """The sensor with its topic."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self._publisher: Any = None
        if host.simulator == "classic":
            list(self.classic_plugins(()))
            self.period = NEVER
        else:
            self._publisher = host.publisher(robot, WrenchStamped, self.topic("/forcetorque"))

    def scoped_name(self, delimiter: str) -> str:
        """World, models, joint and sensor, each with its kind before it."""
        name = super().scoped_name(delimiter)
        link = self.sensor.link.rpartition("::")[2]
        return name.replace(
            delimiter.join(("", "link", link, "")),
            delimiter.join(("", "joint", self.sensor.frame.rpartition("::")[2], "")),
        )

    @property
    def gz_frame(self) -> str:
        """The name of the sensor, or the one that it says."""
        own = f"{self.robot.entity}/{self.sensor.frame}/{self.sensor.name}".replace("::", "/")
        written = super().gz_frame
        default = f"{self.robot.entity}::{self.sensor.link}::{self.sensor.name}"
        return own if written == default.replace("::", "/") else written

    def update(self) -> None:
        """Publish what the joint carries, if somebody wants it."""
        if self._publisher is None or not self._publisher.is_wanted:
            return
        message = WrenchStamped()
        message.header.stamp = self.host.stamp()
        message.header.frame_id = self.gz_frame
        force, torque = self.measure()
        put(message.wrench.force, force)
        put(message.wrench.torque, torque)
        self._publisher.publish(message)

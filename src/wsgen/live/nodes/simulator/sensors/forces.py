"""Contact sensors, and force-torque sensors of joints.

Gazebo Classic's `libgazebo_ros_bumper.so` publishes gazebo_msgs/ContactsState on `bumper_states`,
in the frame `world` or <frame_name>, also while nothing touches (ros-simulation/gazebo_ros_pkgs,
branch ros2, gazebo_plugins/src/gazebo_ros_bumper.cpp and
gazebo_ros/include/gazebo_ros/conversions/gazebo_msgs.hpp). Gazebo Sim publishes
ros_gz_interfaces/Contacts on the <topic> in <contact>, else `/world/…/sensor/NAME/contact`, while
something touches (gazebosim/gz-sim, src/systems/contact/Contact.cc).

Forces are those along the normal; friction is not in them. They are those of the last step, where
Gazebo Classic has a state for each step since the last message. In Gazebo Classic they are seen
from the link, with torques about its center of mass (tests/classic/test_sensors.py).

Gazebo Sim publishes gz.msgs.Wrench on `/world/…/joint/JOINT/sensor/NAME/forcetorque` or <topic>
(gazebosim/gz-sim, src/systems/force_torque/ForceTorque.cc; gazebosim/gz-sensors,
src/ForceTorqueSensor.cc). Gazebo Classic's sensor has no topic of ROS; ros2_control reads it, and
the plugin `gazebo_ros_ft_sensor` measures a joint by itself (../plugins/force_torque.py).

What the child link exerts on the parent link is measured (SDF's `child_to_parent`), about the
origin of the sensor (in Gazebo Classic: of the joint) and in the frame of the child, or as <frame>
and <measure_direction> say.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import Vector3, Wrench, WrenchStamped

from wsgen.live.nodes.simulator.elements import text
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import (
    NEVER,
    Noise,
    OfGazeboSim,
    Sensor,
    put,
    rotation,
    sensor_qos,
)
from wsgen.live.nodes.simulator.sensors.touching import collision_names, first_collisions, touched
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.sensors.touching import Touched
    from wsgen.model.devices import MountedSensor
    from wsgen.simulation.engine import Contact

    Floats = NDArray[np.float64]


BUMPER = ("gazebo_ros_bumper",)
COLLISION = 5  # of ros_gz_interfaces/Entity


class ContactSensor(Sensor):
    """A bumper."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        contact = self.of("contact")
        link = robot.robot.link(sensor.link)
        names = collision_names(link, is_urdf=robot.description is not None)
        wanted = [one.text for one in contact.find_all("collision")]
        own = [name for name in names if name in wanted]
        if not own:
            host.warn(
                f"`{robot.entity}`: the contact sensor `{sensor.name}` is for the collision "
                f"`{', '.join(wanted)}`, which `{link.name}` does not have: it feels nothing. Its "
                f"collisions: {', '.join(names) or 'none'}."
            )
        self._own = own[0] if own else None
        self.outputs: list[tuple[Any, str]] = []
        self._messages: Any
        if host.simulator == "classic":
            for plugin in self.classic_plugins(BUMPER):
                from gazebo_msgs import msg  # noqa: PLC0415  of Gazebo Classic alone

                self._messages = msg
                publisher = host.publisher(
                    robot,
                    msg.ContactsState,
                    "bumper_states",
                    node=self.classic_node(plugin),
                    qos=sensor_qos(plugin, "bumper_states"),
                )
                self.outputs.append((publisher, text(plugin, "frame_name", robot)))
        else:
            from ros_gz_interfaces import msg  # noqa: PLC0415  of Gazebo Sim alone

            self._messages = msg
            topic = self.topic("/contact", contact.get("topic"))
            self.outputs.append((host.publisher(robot, msg.Contacts, topic), ""))
        if not self.outputs:
            self.period = NEVER

    def update(self) -> None:
        """Publish what touches, if somebody wants it."""
        wanted = [output for output in self.outputs if output[0].is_wanted]
        if not wanted:
            return
        found: list[Touched] = []
        if self._own is not None:
            contacts = self.robot.contacts()
            names = first_collisions(
                {
                    entity: (one.robot, one.description is not None)
                    for entity, one in self.host.robots.items()
                    if any(contact.other_entity == entity for contact in contacts)
                }
            )
            found = touched(contacts, self.sensor.link, self._own, self.robot.entity, names)
        for publisher, frame in wanted:
            if self.host.simulator == "classic":
                message = self._messages.ContactsState()
                message.header.frame_id = frame
                message.states = [self._state(one) for one in found]
            else:
                if not found:
                    continue
                message = self._messages.Contacts()
                message.contacts = [self._contact(one) for one in found]
            message.header.stamp = self.host.stamp()
            publisher.publish(message)

    def _state(self, found: Touched) -> Any:
        state = self._messages.ContactState()
        state.collision1_name, state.collision2_name = found.own, found.other
        state.info = f"{len(found.points)} points"
        state.wrenches = [self._wrench(point) for point in found.points]
        for part, axis in itertools.product(("force", "torque"), "xyz"):
            total = sum(getattr(getattr(wrench, part), axis) for wrench in state.wrenches)
            setattr(getattr(state.total_wrench, part), axis, total)
        state.contact_positions = [_vector(point.point) for point in found.points]
        state.contact_normals = [_vector(point.normal) for point in found.points]
        state.depths = [point.depth for point in found.points]
        return state

    def _wrench(self, contact: Contact) -> Any:
        """The force, and the torque about the center of mass, in the frame of the link."""
        link = self.robot.robot.link(self.sensor.link)
        pose = self.robot.link_poses()[link.name]
        center = compose(pose, link.inertial.pose_in_link) if link.inertial else pose
        turn = rotation(pose).T
        force = contact.force * (turn @ contact.normal)
        arm = turn @ np.subtract(contact.point, center.xyz)
        return Wrench(force=_vector(force), torque=_vector(np.cross(arm, force)))

    def _contact(self, found: Touched) -> Any:
        contact = self._messages.Contact()
        for entity, name in ((contact.collision1, found.own), (contact.collision2, found.other)):
            entity.name, entity.type = name, COLLISION
        contact.positions = [_vector(point.point) for point in found.points]
        contact.normals = [_vector(point.normal) for point in found.points]
        contact.depths = [point.depth for point in found.points]
        for point in found.points:
            wrench = self._messages.JointWrench()
            wrench.body_1_wrench.force = _force(point)
            contact.wrenches.append(wrench)
        return contact


def _vector(numbers: Iterable[float]) -> Any:
    x, y, z = map(float, numbers)
    return Vector3(x=x, y=y, z=z)


def _force(contact: Contact) -> Any:
    x, y, z = contact.normal
    return _vector((contact.force * x, contact.force * y, contact.force * z))


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


class ForceTorque(OfGazeboSim, JointLoad):
    """The sensor with its topic."""

    message = WrenchStamped

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self.open("/forcetorque")

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

    def fill(self, message: Any) -> None:
        """As in the base."""
        force, torque = self.measure()
        put(message.wrench.force, force)
        put(message.wrench.torque, torque)

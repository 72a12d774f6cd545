"""Contact sensors.

Gazebo Classic's `libgazebo_ros_bumper.so` publishes gazebo_msgs/ContactsState on `bumper_states`,
in the frame `world` or <frame_name>, also while nothing touches (ros-simulation/gazebo_ros_pkgs,
branch ros2, gazebo_plugins/src/gazebo_ros_bumper.cpp and
gazebo_ros/include/gazebo_ros/conversions/gazebo_msgs.hpp). Gazebo Sim publishes
ros_gz_interfaces/Contacts on the <topic> in <contact>, else `/world/…/sensor/NAME/contact`, while
something touches (gazebosim/gz-sim, src/systems/contact/Contact.cc).

Forces are those along the normal; friction is not in them. They are those of the last step, where
Gazebo Classic has a state for each step since the last message. In Gazebo Classic they are seen
from the link, with torques about its center of mass (tests/classic/test_sensors.py).
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import Vector3, Wrench

from wsgen.live.nodes.simulator.elements import text
from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor, rotation, sensor_qos
from wsgen.live.nodes.simulator.sensors.touching import (
    collision_names,
    first_collisions,
    touched,
)
from wsgen.model.transform import compose

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.sensors.touching import Touched
    from wsgen.model.devices import MountedSensor
    from wsgen.simulation.engine import Contact

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

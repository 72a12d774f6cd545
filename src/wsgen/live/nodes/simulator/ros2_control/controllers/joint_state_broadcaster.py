"""`/joint_states` and `/dynamic_joint_states`.

Source: ros-controls/ros2_controllers, joint_state_broadcaster/src/joint_state_broadcaster.cpp, of
its branches humble, iron, jazzy and kilted.
"""

from __future__ import annotations

import math
from array import array

from sensor_msgs.msg import JointState

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import OF_JOINTS
from wsgen.live.nodes.simulator.ros2_control.unordered import unordered

UNKNOWN = math.nan


class JointStateBroadcaster(Controller):
    """Publishes the states of joints at each update.

    They are in the order of the alphabet where those of the URDF are published, in that of the
    interfaces otherwise; in Humble and Iron, and in `/dynamic_joint_states`, in that of the map in
    which the real one has them: with a few joints mostly that of the interfaces.
    """

    states = None

    def configure(self) -> None:
        """Read the parameters, open both topics."""
        parameters = self.parameters
        joints, kinds = parameters.texts("joints"), parameters.texts("interfaces")
        self._are_all = not (joints and kinds)
        if self._are_all:
            self.info(
                "'joints' or 'interfaces' parameter is empty. "
                "All available state interfaces will be published"
            )
            self.states = None
        else:
            self.info(
                "Publishing state interfaces defined in 'joints' and 'interfaces' parameters."
            )
            self.states = tuple(f"{joint}/{kind}" for joint in joints for kind in kinds)
        self._kind_of = {}
        for kind in OF_JOINTS:
            mapped = parameters.text(f"map_interface_to_joint_state.{kind}", kind)
            self._kind_of[kind if kind in kinds else mapped] = kind
        self._filters = parameters.flag("use_urdf_to_filter", default=True) and self._are_all
        self._extra = parameters.texts("extra_joints")
        frame = "" if self.is_former else "base_link"
        prefix = "~/" if parameters.flag("use_local_topics") else ""
        self._message = JointState()
        self._message.header.frame_id = parameters.text("frame_id", frame)
        self._publisher = self.publisher(JointState, f"{prefix}joint_states")
        self._dynamic = None
        if parameters.flag("publish_dynamic_joint_states", default=True):
            from control_msgs.msg import DynamicJointState  # noqa: PLC0415  if it is wanted

            self._dynamic = self.publisher(DynamicJointState, f"{prefix}dynamic_joint_states")

    def activate(self) -> None:
        """Find the joints."""
        names = tuple(self.interfaces.states) if self.states is None else self.states
        if not names:
            message = "No state interfaces found to publish."
            raise ControllerError(message)
        self._of_part: dict[str, dict[str, str]] = {}  # part -> kind -> interface
        for name in names:
            part, _, kind = name.rpartition("/")
            self._of_part.setdefault(part, {})[self._kind_of.get(kind, kind)] = name
        extra = [name for name in self._extra if name not in self._of_part]
        parts = dict.fromkeys(name.rpartition("/")[0] for name in reversed(names))
        in_map = unordered(dict.fromkeys((*parts, *extra)))
        joints = [
            part
            for part in (in_map if self.is_former else self._of_part)
            if any(one in self._of_part.get(part, ()) for one in OF_JOINTS)
        ]
        if self._filters and not self.is_former:
            joints = sorted(joint for joint in joints if joint in self.joints)
        self._in_map = [  # with the interfaces of each, none of those that only the parameters name
            (part, unordered(reversed(self._of_part.get(part, OF_JOINTS[::-1])))) for part in in_map
        ]
        self._message.name = [*joints, *extra]
        zeros = [0.0] * len(extra)
        self._columns = [
            (kind, [self._of_part[joint].get(kind) for joint in joints], zeros)
            for kind in OF_JOINTS
        ]

    def update(self, now: float, elapsed: float) -> None:  # noqa: ARG002  it only publishes
        """Publish, where somebody listens."""
        states = self.interfaces.states
        if self._publisher.is_wanted:
            message = self._message
            message.header.stamp = self.ros.time(now)
            for kind, names, zeros in self._columns:
                values = [UNKNOWN if name is None else states[name] for name in names]
                setattr(message, kind, array("d", values + zeros))
            self._publisher.publish(message)
        if self._dynamic is not None and self._dynamic.is_wanted:
            self._publish_dynamic(now)

    def _publish_dynamic(self, now: float) -> None:
        from control_msgs.msg import DynamicJointState, InterfaceValue  # noqa: PLC0415  see above

        states = self.interfaces.states
        message = DynamicJointState()
        message.header.stamp = self.ros.time(now)
        message.header.frame_id = self._message.header.frame_id
        for part, kinds in self._in_map:
            names = self._of_part.get(part, {})
            values = [states[names[kind]] if kind in names else 0.0 for kind in kinds]
            message.joint_names.append(part)
            message.interface_values.append(InterfaceValue(interface_names=kinds, values=values))
        assert self._dynamic is not None  # noqa: S101  it was asked
        self._dynamic.publish(message)

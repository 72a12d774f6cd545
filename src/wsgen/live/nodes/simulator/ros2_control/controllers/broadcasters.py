"""Controllers that publish the states of joints and sensors."""

from __future__ import annotations

import math
from array import array

from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import Imu, JointState

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import FORCE_TORQUE, IMU, OF_JOINTS, unordered

UNKNOWN = math.nan


class JointStateBroadcaster(Controller):
    """Publishes the states of joints at each update: `/joint_states`, `/dynamic_joint_states`.

    Source: ros-controls/ros2_controllers, joint_state_broadcaster/src/joint_state_broadcaster.cpp,
    of its branches humble, iron, jazzy and kilted.

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


class ForceTorqueSensorBroadcaster(Controller):
    """Publishes `~/wrench` at each update.

    Source: ros-controls/ros2_controllers, force_torque_sensor_broadcaster/src.
    """

    def configure(self) -> None:
        """Read the parameters, open the topic."""
        parameters = self.parameters
        sensor = parameters.text("sensor_name")
        named = {kind: parameters.text(f"interface_names.{kind}") for kind in FORCE_TORQUE}
        if not sensor and not any(named.values()):
            message = (
                "'sensor_name' or at least one 'interface_names.[force|torque].[x|y|z]' parameter "
                "has to be specified."
            )
            raise ControllerError(message)
        if sensor and any(named.values()):
            message = (
                "both 'sensor_name' and 'interface_names.[force|torque].[x|y|z]' parameters can "
                "not be specified together."
            )
            raise ControllerError(message)
        self._names = {kind: f"{sensor}/{kind}" for kind in FORCE_TORQUE} if sensor else named
        self.states = tuple(name for name in self._names.values() if name)
        self._offset, self._factor = (
            {kind: parameters.number(f"{name}.{kind}", default) for kind in FORCE_TORQUE}
            for name, default in (("offset", 0.0), ("multiplier", 1.0))
        )
        if any(name.startswith("sensor_filter_chain.") for name in parameters.values):
            self.warn_once("wsgen does not apply the parameter 'sensor_filter_chain'.")
        self._message = WrenchStamped()
        self._message.header.frame_id = parameters.text("frame_id")
        self._publisher = self.publisher(WrenchStamped, "~/wrench")

    def update(self, now: float, elapsed: float) -> None:  # noqa: ARG002  it only publishes
        """Publish, where somebody listens."""
        if not self._publisher.is_wanted:
            return
        message = self._message
        message.header.stamp = self.ros.time(now)
        for kind, name in self._names.items():
            part, _, axis = kind.partition(".")
            value = self.interfaces.states[name] if name else float("nan")
            value = (value + self._offset[kind]) * self._factor[kind]
            setattr(getattr(message.wrench, part), axis, value)
        self._publisher.publish(message)


COVARIANCES = ("orientation", "angular_velocity", "linear_acceleration")


class ImuSensorBroadcaster(Controller):
    """Publishes `~/imu` at each update.

    Source: ros-controls/ros2_controllers, imu_sensor_broadcaster/src/imu_sensor_broadcaster.cpp.
    """

    def configure(self) -> None:
        """Read the parameters, open the topic."""
        parameters = self.parameters
        name = parameters.text("sensor_name")
        if not name:
            message = "'sensor_name' parameter was empty"
            raise ControllerError(message)
        self.states = self._names = tuple(f"{name}/{kind}" for kind in IMU)
        self._message = Imu()
        self._message.header.frame_id = parameters.text("frame_id")
        for channel in COVARIANCES:
            values = parameters.numbers(f"static_covariance_{channel}", [0.0] * 9)
            covariance = getattr(self._message, f"{channel}_covariance")
            for index, value in enumerate(values[:9]):
                covariance[index] = value
        if any(parameters.number(f"rotation_offset.{one}") for one in ("roll", "pitch", "yaw")):
            self.warn_once("wsgen does not apply the parameter 'rotation_offset'.")
        self._publisher = self.publisher(Imu, "~/imu")

    def update(self, now: float, elapsed: float) -> None:  # noqa: ARG002  it only publishes
        """Publish, where somebody listens."""
        if not self._publisher.is_wanted:
            return
        states, message = self.interfaces.states, self._message
        message.header.stamp = self.ros.time(now)
        x, y, z, w, *rest = (states[name] for name in self._names)
        turn = message.orientation
        turn.x, turn.y, turn.z, turn.w = x, y, z, w
        for vector, values in (
            (message.angular_velocity, rest[:3]),
            (message.linear_acceleration, rest[3:]),
        ):
            vector.x, vector.y, vector.z = values
        self._publisher.publish(message)

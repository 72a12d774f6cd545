"""A force-torque sensor of ros2_control as messages.

Source: ros-controls/ros2_controllers, force_torque_sensor_broadcaster/src.
"""

from __future__ import annotations

from geometry_msgs.msg import WrenchStamped

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import FORCE_TORQUE


class ForceTorqueSensorBroadcaster(Controller):
    """Publishes `~/wrench` at each update."""

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

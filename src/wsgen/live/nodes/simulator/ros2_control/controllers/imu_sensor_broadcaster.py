"""An IMU of ros2_control as messages.

Source: ros-controls/ros2_controllers, imu_sensor_broadcaster/src/imu_sensor_broadcaster.cpp.
"""

from __future__ import annotations

from sensor_msgs.msg import Imu

from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import IMU

COVARIANCES = ("orientation", "angular_velocity", "linear_acceleration")


class ImuSensorBroadcaster(Controller):
    """Publishes `~/imu` at each update."""

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

"""IMUs.

Gazebo Classic's `libgazebo_ros_imu_sensor.so` publishes a sensor_msgs/Imu on `~/out` in the frame
of the link or <frame_name>; the orientation is that in the world unless
<initial_orientation_as_reference> says otherwise (ros-simulation/gazebo_ros_pkgs, branch ros2,
gazebo_plugins/src/gazebo_ros_imu_sensor.cpp). Gazebo Sim publishes on <topic>, else
`/world/…/sensor/NAME/imu`; the orientation is against the one at the beginning unless a
<localization> says otherwise (gazebosim/gz-sensors, src/ImuSensor.cc; gazebosim/gz-sim,
src/systems/imu/Imu.cc). Either has variances of gyroscope and accelerometer on the diagonals of
the covariances, and zeros for the orientation.

The acceleration is the mean since the last measurement; Gazebo's is that of the last step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from sensor_msgs.msg import Imu as ImuMessage

from wsgen.live.nodes.simulator.elements import boolean
from wsgen.live.nodes.simulator.sensors.inertial import CHANNELS, InertialUnit, reference_of
from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor, put, rotation, sensor_qos
from wsgen.model.transform import quaternion_of_rpy, rpy_of_rotation

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element, MountedSensor
    from wsgen.model.transform import Matrix

IMU_SENSOR = ("gazebo_ros_imu_sensor",)


class Imu(Sensor):
    """An inertial measurement unit."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self.outputs: list[tuple[Any, str]] = []
        imu = sensor.element.find("imu")
        self._has_orientation = True
        reference = None
        if host.simulator == "classic":
            for plugin in self.classic_plugins(IMU_SENSOR):
                self._open_classic(plugin)
                if not boolean(plugin, "initial_orientation_as_reference"):
                    reference = np.eye(3)
        else:
            reference = reference_of(imu)
            if imu is not None:
                self._has_orientation = boolean(imu, "enable_orientation", default=True)
            publisher = host.publisher(robot, ImuMessage, self.topic("/imu"))
            self.outputs.append((publisher, self.gz_frame))
        self.unit = InertialUnit(
            imu,
            np.random.default_rng(self.seed),
            gravity=host.gravity,
            reference=rotation(self.pose()) if reference is None else reference,
        )
        if not self.outputs:
            self.period = NEVER

    def _open_classic(self, plugin: Element) -> None:
        publisher = self.host.publisher(
            self.robot,
            ImuMessage,
            "~/out",
            node=self.classic_node(plugin),
            qos=sensor_qos(plugin, "~/out"),
        )
        self.outputs.append((publisher, self.classic_frame(plugin)))

    def reset(self) -> None:
        """Begin again."""
        self.unit.forget(time=True)

    def update(self) -> None:
        """Measure, if somebody wants it."""
        is_wanted = any(publisher.is_wanted for publisher, _ in self.outputs)
        if not is_wanted or not self.pose().is_finite:  # the robot has exploded
            self.unit.forget()
            return
        measured = self.unit.measure(self.pose(), *self.velocity(), self.host.now)
        for publisher, frame in self.outputs:
            message = ImuMessage()
            message.header.stamp = self.host.stamp()
            message.header.frame_id = frame
            quaternion = message.orientation
            if self._has_orientation:
                rows: Matrix = tuple(map(tuple, measured.orientation.tolist()))  # type: ignore[assignment]
                turned = quaternion_of_rpy(rpy_of_rotation(rows))
                quaternion.x, quaternion.y, quaternion.z, quaternion.w = turned
            put(message.angular_velocity, measured.turning)
            put(message.linear_acceleration, measured.acceleration)
            for channel in CHANNELS:
                covariance = getattr(message, f"{channel}_covariance")
                for place, noise in zip((0, 4, 8), self.unit.noises[channel], strict=True):
                    covariance[place] = noise.variance
            publisher.publish(message)

"""IMUs as hardware of ros2_control.

Source: the readings of IMUs in gazebo_ros2_control/src/gazebo_system.cpp and
gz_ros2_control/src/gz_system.cpp: those of the sensor that has the name of the <sensor> in
<ros2_control>.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.transform import quaternion_of_rpy, rpy_of_rotation
from wsgen.ros_nodes.simulator.ros2_control.hardware import IMU
from wsgen.ros_nodes.simulator.sensors.inertial import InertialUnit, reference_of
from wsgen.ros_nodes.simulator.sensors.mounting import Sensor, rotation

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.model.devices import MountedSensor
    from wsgen.model.transform import Matrix
    from wsgen.ros_nodes.simulator.host import Host, RobotHandle
    from wsgen.ros_nodes.simulator.ros2_control.hardware import Component, Interfaces


class ImuHardware(Sensor):
    """Writes what an IMU measures into the states of its interfaces, at the rate of the sensor."""

    def __init__(
        self, host: Host, robot: RobotHandle, sensor: MountedSensor, interfaces: Interfaces
    ) -> None:
        super().__init__(host, robot, sensor)
        imu = sensor.element.find("imu")
        reference = reference_of(imu)
        self._unit = InertialUnit(
            imu,
            np.random.default_rng(self.seed),
            gravity=host.gravity,
            reference=rotation(self.pose()) if reference is None else reference,
        )
        self._states = interfaces.states
        self._next = host.now
        self.update()

    def update(self) -> None:
        """Measure, if it is due."""
        if self.host.now < self._next:
            return
        self._next += self.rated_period
        measured = self._unit.measure(self.pose(), *self.velocity(), self.host.now)
        rows: Matrix = tuple(map(tuple, measured.orientation.tolist()))  # type: ignore[assignment]
        values = (
            *quaternion_of_rpy(rpy_of_rotation(rows)),
            *measured.turning.tolist(),
            *measured.acceleration.tolist(),
        )
        for kind, value in zip(IMU, values, strict=True):
            name = f"{self.sensor.name}/{kind}"
            if name in self._states:
                self._states[name] = value

    def reset(self) -> None:
        """Begin again."""
        self._unit.forget(time=True)
        self._next = self.host.now


def imus_of(
    host: Host, robot: RobotHandle, components: Iterable[Component], interfaces: Interfaces
) -> list[ImuHardware]:
    """The IMUs that <ros2_control> names; states of sensors that are none are taken away."""
    mounted = {one.name: one for one in robot.devices.sensors if one.kind == "imu"}
    found = []
    for component in components:
        for part in component.sensors if component.is_simulated else ():
            sensor = mounted.get(part.name)
            if sensor is not None:
                found.append(ImuHardware(host, robot, sensor, interfaces))
                continue
            host.warn(
                f"`{robot.entity}`: Skipping sensor in the URDF named '{part.name}' which is not "
                "in the gazebo model, or is no IMU."
            )
            for kind in part.states:
                interfaces.states.pop(f"{part.name}/{kind}", None)
    return found

"""IMUs and force-torque sensors as hardware of ros2_control.

Source: the readings of sensors in gazebo_ros2_control/src/gazebo_system.cpp and
gz_ros2_control/src/gz_system.cpp: those of the sensor that has the name of the <sensor> in
<ros2_control>.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.ros2_control.hardware import FORCE_TORQUE, IMU
from wsgen.live.nodes.simulator.sensors.forces import JointLoad
from wsgen.live.nodes.simulator.sensors.motion import InertialUnit, reference_of
from wsgen.live.nodes.simulator.sensors.mounting import Sensor, rotation
from wsgen.model.transform import quaternion_of_rpy, rpy_of_rotation

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.ros2_control.hardware import Component, Interfaces
    from wsgen.model.devices import MountedSensor
    from wsgen.model.transform import Matrix


class SensorHardware(Sensor):
    """Writes what it measures into the states of its interfaces, at the rate of the sensor."""

    kinds: tuple[str, ...]  # of the states

    def __init__(
        self, host: Host, robot: RobotHandle, sensor: MountedSensor, interfaces: Interfaces
    ) -> None:
        super().__init__(host, robot, sensor)
        self._states, self._next = interfaces.states, host.now
        self.prepare()
        self.update()

    def prepare(self) -> None:
        """Read what it needs to measure."""

    def values(self) -> Iterable[float]:
        """What it measures now, in the order of its kinds."""
        raise NotImplementedError

    def update(self) -> None:
        """Measure, if it is due."""
        if self.host.now < self._next:
            return
        self._next += self.rated_period
        for kind, value in zip(self.kinds, self.values(), strict=True):
            name = f"{self.sensor.name}/{kind}"
            if name in self._states:
                self._states[name] = float(value)

    def reset(self) -> None:
        """Begin again."""
        self._next = self.host.now


class ImuHardware(SensorHardware):
    """An IMU."""

    kinds = IMU

    def prepare(self) -> None:
        """As in the base."""
        imu = self.sensor.element.find("imu")
        reference = reference_of(imu)
        self._unit = InertialUnit(
            imu,
            np.random.default_rng(self.seed),
            gravity=self.host.gravity,
            reference=rotation(self.pose()) if reference is None else reference,
        )

    def values(self) -> Iterable[float]:
        """As in the base."""
        measured = self._unit.measure(self.pose(), *self.velocity(), self.host.now)
        rows: Matrix = tuple(map(tuple, measured.orientation.tolist()))  # type: ignore[assignment]
        return (
            *quaternion_of_rpy(rpy_of_rotation(rows)),
            *measured.turning.tolist(),
            *measured.acceleration.tolist(),
        )

    def reset(self) -> None:
        """Begin again."""
        self._unit.forget(time=True)
        super().reset()


class ForceTorqueHardware(SensorHardware, JointLoad):
    """What a joint carries."""

    kinds = FORCE_TORQUE

    def values(self) -> Iterable[float]:
        """As in the base."""
        return np.concatenate(self.measure())


HARDWARE: dict[str, type[SensorHardware]] = {
    "imu": ImuHardware,
    "force_torque": ForceTorqueHardware,
}


def sensors_of(
    host: Host, robot: RobotHandle, components: Iterable[Component], interfaces: Interfaces
) -> list[SensorHardware]:
    """The sensors that <ros2_control> names; states of those that are not there are taken away."""
    mounted = {one.name: one for one in robot.devices.sensors if one.kind in HARDWARE}
    found: list[SensorHardware] = []
    for component in components:
        for part in component.sensors if component.is_simulated else ():
            sensor = mounted.get(part.name)
            problem = (
                "which is not in the gazebo model, or is neither an IMU nor a force-torque sensor."
            )
            if sensor is not None:
                try:
                    found.append(HARDWARE[sensor.kind](host, robot, sensor, interfaces))
                    continue
                except CannotWorkError as error:
                    problem = f"which does not work: {error}"
            host.warn(
                f"`{robot.entity}`: Skipping sensor in the URDF named '{part.name}' {problem}"
            )
            for kind in part.states:
                interfaces.states.pop(f"{part.name}/{kind}", None)
    return found

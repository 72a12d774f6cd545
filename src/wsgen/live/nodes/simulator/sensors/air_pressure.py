"""Air pressure sensors, of Gazebo Sim alone.

On <topic>, else `/world/…/sensor/NAME/air_pressure`, as sensor_msgs/FluidPressure, Pa, by the
standard atmosphere (gazebosim/gz-sensors, src/AirPressureSensor.cc).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from sensor_msgs.msg import FluidPressure

from wsgen.live.nodes.simulator.elements import number
from wsgen.live.nodes.simulator.sensors.atmosphere import pressure_at
from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor
from wsgen.live.nodes.simulator.sensors.noise import Noise

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import MountedSensor


class AirPressure(Sensor):
    """A barometer."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        element = sensor.element
        self._noise = Noise(
            element.find("air_pressure/pressure/noise"), np.random.default_rng(self.seed)
        )
        self._altitude = number(element, "air_pressure/reference_altitude", 0.0)
        self._publisher: Any = None
        if host.simulator == "classic":
            list(self.classic_plugins(()))
            self.period = NEVER
        else:
            self._publisher = host.publisher(robot, FluidPressure, self.topic("/air_pressure"))

    def update(self) -> None:
        """Publish the pressure, if somebody wants it."""
        if self._publisher is None or not self._publisher.is_wanted:
            return
        message = FluidPressure()
        message.header.stamp = self.host.stamp()
        message.header.frame_id = self.gz_frame
        true = pressure_at(self._altitude + self.pose().xyz[2])
        message.fluid_pressure = float(self._noise.apply(np.array(true)))
        message.variance = self._noise.variance
        self._publisher.publish(message)

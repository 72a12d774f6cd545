"""Magnetometers, of Gazebo Sim alone.

On <topic>, else `/world/…/sensor/NAME/magnetometer`, as sensor_msgs/MagneticField, in the frame of
the sensor: the <magnetic_field> of the world, T (gazebosim/gz-sensors, src/MagnetometerSensor.cc).
The tables of the field of Earth are not used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from sensor_msgs.msg import MagneticField

from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor, put, rotation
from wsgen.live.nodes.simulator.sensors.noise import Noise
from wsgen.model.devices import numbers_of

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import MountedSensor

FIELD = (5.5645e-6, 22.8758e-6, -42.3884e-6)  # T, SDF's default


class Magnetometer(Sensor):
    """A magnetometer."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        written = host.surroundings.get("magnetic_field")
        numbers = [] if written is None else numbers_of(written.text)
        self._field = np.array(numbers if len(numbers) == len(FIELD) else FIELD)
        random = np.random.default_rng(self.seed)
        self._noises = [
            Noise(sensor.element.find(f"magnetometer/{axis}/noise"), random) for axis in "xyz"
        ]
        self._publisher: Any = None
        if host.simulator == "classic":
            list(self.classic_plugins(()))
            self.period = NEVER
        else:
            self._publisher = host.publisher(robot, MagneticField, self.topic("/magnetometer"))

    def update(self) -> None:
        """Publish the field, if somebody wants it."""
        if self._publisher is None or not self._publisher.is_wanted:
            return
        message = MagneticField()
        message.header.stamp = self.host.stamp()
        message.header.frame_id = self.gz_frame
        own = rotation(self.pose()).T @ self._field
        measured = [noise.apply(part) for noise, part in zip(self._noises, own, strict=True)]
        put(message.magnetic_field, np.array(measured))
        self._publisher.publish(message)

"""Altimeters, of Gazebo Sim alone: ROS 2 has no plugin of Gazebo Classic for them.

On <topic>, else `/world/…/sensor/NAME/altimeter`, as ros_gz_interfaces/Altimeter: the height
against the one at the beginning, and its change (gazebosim/gz-sensors, src/AltimeterSensor.cc;
gazebosim/gz-sim, src/systems/altimeter/Altimeter.cc).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor
from wsgen.live.nodes.simulator.sensors.noise import Noise

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import MountedSensor


class Altimeter(Sensor):
    """An altimeter."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        random = np.random.default_rng(self.seed)
        self._noises = [
            Noise(sensor.element.find(f"altimeter/{what}/noise"), random)
            for what in ("vertical_position", "vertical_velocity")
        ]
        self._reference = self.pose().xyz[2]
        self._publisher: Any = None
        if host.simulator == "classic":
            list(self.classic_plugins(()))
            self.period = NEVER
            return
        from ros_gz_interfaces.msg import Altimeter as Message  # noqa: PLC0415  of Gazebo Sim alone

        self._message = Message
        self._publisher = host.publisher(robot, Message, self.topic("/altimeter"))

    def update(self) -> None:
        """Publish how high it is, if somebody wants it."""
        if self._publisher is None or not self._publisher.is_wanted:
            return
        height, climb = self.pose().xyz[2] - self._reference, self.velocity()[0][2]
        message = self._message()
        message.header.stamp = self.host.stamp()
        message.header.frame_id = self.gz_frame
        message.vertical_position = float(self._noises[0].apply(np.array(height)))
        message.vertical_velocity = float(self._noises[1].apply(np.array(climb)))
        message.vertical_reference = self._reference
        self._publisher.publish(message)

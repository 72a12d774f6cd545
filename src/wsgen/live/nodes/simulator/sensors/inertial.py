"""What an IMU measures of how it moves. No ROS in here.

Source: gazebosim/gz-sensors, src/ImuSensor.cc.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.live.nodes.simulator.elements import vector
from wsgen.live.nodes.simulator.sensors.mounting import Noise, rotation
from wsgen.model.transform import rotation_of_rpy

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.devices import Element
    from wsgen.model.transform import Pose, Vector

    Floats = NDArray[np.float64]

# The reference for the orientation by <localization>, seen from the world, whose x is east.
REFERENCES: dict[str, Vector] = {
    "ENU": (0.0, 0.0, 0.0),
    "NED": (math.pi, 0.0, math.pi / 2),
    "NWU": (0.0, 0.0, math.pi / 2),
}
CHANNELS = ("angular_velocity", "linear_acceleration")


class Measured(NamedTuple):
    """What an IMU measures."""

    orientation: Floats  # 3 by 3, of the sensor against the reference
    turning: Floats  # rad/s, in the frame of the sensor
    acceleration: Floats  # m/s², likewise; at rest what holds it up: gravity, upwards


class InertialUnit:
    """Measures how it moves.

    Attributes:
        noises: Of the three axes, by channel.
    """

    def __init__(
        self,
        imu: Element | None,
        random: np.random.Generator,
        *,
        gravity: Vector,
        reference: Floats,
    ) -> None:
        """Begin; `imu` is the <imu>, `reference` what orientations are against, 3 by 3.

        Raises:
            CannotWorkError: A number of it is none.
        """
        self.noises = {
            channel: [
                Noise(None if imu is None else imu.find(f"{channel}/{axis}/noise"), random)
                for axis in "xyz"
            ]
            for channel in CHANNELS
        }
        self._gravity = np.array(gravity)
        self._reference = reference
        self._before: tuple[float, Floats] | None = None  # s, m/s: when last measured
        self._measured_at: float | None = None

    def forget(self, *, time: bool = False) -> None:
        """Have no velocity to compare the next one with, and with `time` no drift either."""
        self._before = None
        if time:
            self._measured_at = None

    def measure(self, pose: Pose, linear: Floats, angular: Floats, now: float) -> Measured:
        """What it measures at a time (s).

        Pose and velocities (m/s, rad/s) are its own, seen from the world.
        """
        to_world = rotation(pose)
        acceleration = np.zeros(3)
        if self._before is not None and now > self._before[0]:
            acceleration = (linear - self._before[1]) / (now - self._before[0])
        elapsed = 0.0 if self._measured_at is None else max(0.0, now - self._measured_at)
        self._before, self._measured_at = (now, linear), now
        turning = self._noisy("angular_velocity", to_world.T @ angular, elapsed)
        felt = to_world.T @ (acceleration - self._gravity)
        felt = self._noisy("linear_acceleration", felt, elapsed)
        return Measured(self._reference.T @ to_world, turning, felt)

    def _noisy(self, channel: str, true: Floats, elapsed: float) -> Floats:
        noises = self.noises[channel]
        if not any(noise.is_there for noise in noises):
            return true
        parts = zip(noises, true, strict=True)
        return np.array([float(noise.apply(np.array(part), elapsed)) for noise, part in parts])


def reference_of(imu: Element | None) -> Floats | None:
    """The reference of orientations in Gazebo Sim, seen from the world; None: the first one."""
    frame = None if imu is None else imu.find("orientation_reference_frame")
    if frame is None:
        return None
    named = frame.get("localization", "CUSTOM")
    if named in REFERENCES:
        return np.array(rotation_of_rpy(REFERENCES[named]))
    custom = frame.find("custom_rpy")
    parent = "" if custom is None else custom.attributes.get("parent_frame", "")
    if named != "CUSTOM" or parent != "world":
        return None
    roll, pitch, yaw = vector(frame, "custom_rpy", (0.0, 0.0, 0.0))
    return np.array(rotation_of_rpy((roll, pitch, yaw)))

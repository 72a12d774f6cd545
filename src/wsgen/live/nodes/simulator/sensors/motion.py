"""What an IMU measures, and where places in a world are on Earth, with the air there. No ROS.

Source: gazebosim/gz-sensors, src/ImuSensor.cc.

Source: gazebosim/gz-math, src/SphericalCoordinates.cc. Gazebo Sim takes its frame LOCAL2, Gazebo
Classic (gazebo, gazebo/common/SphericalCoordinates.cc) LOCAL: there x goes west while the heading
is 0, which is why worlds for it have a heading of 180 degrees. The air is that of the standard
atmosphere (gazebosim/gz-sensors, src/AirPressureSensor.cc).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.live.nodes.simulator.elements import number, vector
from wsgen.live.nodes.simulator.sensors.mounting import Noise, rotation
from wsgen.model.transform import rotation_of_rpy
from wsgen.text.values import dataclass

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


LARGE, SMALL = 6378137.0, 6356752.314245  # m, the half axes of WGS 84
SQUARED = 1.0 - (SMALL / LARGE) ** 2  # of the first eccentricity
ROUNDS = 5  # of the iteration for the latitude: less than a nanometer


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where on Earth the origin of a world is, and how it lies there."""

    latitude: float  # rad
    longitude: float  # rad
    elevation: float  # m, above the ellipsoid
    heading: float = 0.0  # rad, of the world's x axis from east

    def place(self, xyz: Vector) -> tuple[float, float, float]:
        """Latitude and longitude (degrees) and elevation (m) of a place in the world (m)."""
        return _geodetic(self._ecef() + self._axes() @ self.east_north_up(xyz))

    def east_north_up(self, xyz: Vector) -> Floats:
        """A vector of the world along east, north and up."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x, y, z = xyz
        return np.array([x * cos + y * sin, -x * sin + y * cos, z])

    def _ecef(self) -> Floats:
        sin, cos = math.sin(self.latitude), math.cos(self.latitude)
        curve = LARGE / math.sqrt(1.0 - SQUARED * sin * sin)
        out = (curve + self.elevation) * cos
        return np.array(
            [
                out * math.cos(self.longitude),
                out * math.sin(self.longitude),
                ((1.0 - SQUARED) * curve + self.elevation) * sin,
            ]
        )

    def _axes(self) -> Floats:
        """East, north and up, as columns."""
        sin_a, cos_a = math.sin(self.latitude), math.cos(self.latitude)
        sin_o, cos_o = math.sin(self.longitude), math.cos(self.longitude)
        return np.array(
            [
                [-sin_o, -sin_a * cos_o, cos_a * cos_o],
                [cos_o, -sin_a * sin_o, cos_a * sin_o],
                [0.0, cos_a, sin_a],
            ]
        )


def read_origin(element: Element | None, simulator: str) -> Origin | None:
    """What <spherical_coordinates> says; None without it.

    Raises:
        CannotWorkError: A number of it is none.
    """
    if element is None:
        return None
    heading = math.radians(number(element, "heading_deg", 0.0))
    return Origin(
        latitude=math.radians(number(element, "latitude_deg", 0.0)),
        longitude=math.radians(number(element, "longitude_deg", 0.0)),
        elevation=number(element, "elevation", 0.0),
        heading=-heading - math.pi if simulator == "classic" else heading,
    )


def _geodetic(ecef: Floats) -> tuple[float, float, float]:
    x, y, z = ecef.tolist()
    out = math.hypot(x, y)
    latitude = math.atan2(z, out * (1.0 - SQUARED))
    for _ in range(ROUNDS):
        sin = math.sin(latitude)
        curve = LARGE / math.sqrt(1.0 - SQUARED * sin * sin)
        latitude = math.atan2(z + SQUARED * curve * sin, out)
    sin, cos = math.sin(latitude), math.cos(latitude)
    curve = LARGE / math.sqrt(1.0 - SQUARED * sin * sin)
    elevation = out * cos + z * sin - curve * (1.0 - SQUARED * sin * sin)
    return math.degrees(latitude), math.degrees(math.atan2(y, x)), elevation


GAS_CONSTANT = 8314.32 / 28.9644  # J/(kg K), of air
PULL = 9.80665  # m/s²
SEA_PRESSURE = 101325.0  # Pa, and at that temperature:
SEA_TEMPERATURE = 288.15  # K
LAPSE = 0.0065  # K/m
EARTH = 6356766.0  # m


def pressure_at(altitude: float) -> float:
    """The pressure at an altitude (m), Pa."""
    height = EARTH * altitude / (EARTH + altitude)
    temperature = SEA_TEMPERATURE - LAPSE * height
    # Where the formula has no air any more, it has no pressure.
    share: float = (max(temperature, 0.0) / SEA_TEMPERATURE) ** (PULL / (LAPSE * GAS_CONSTANT))
    return SEA_PRESSURE * share

"""From places in a world to places on Earth, and the air there. No ROS in here.

Source: gazebosim/gz-math, src/SphericalCoordinates.cc. Gazebo Sim takes its frame LOCAL2, Gazebo
Classic (gazebo, gazebo/common/SphericalCoordinates.cc) LOCAL: there x goes west while the heading
is 0, which is why worlds for it have a heading of 180 degrees. The air is that of the standard
atmosphere (gazebosim/gz-sensors, src/AirPressureSensor.cc).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.live.nodes.simulator.elements import number
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.devices import Element
    from wsgen.model.transform import Vector

    Floats = NDArray[np.float64]


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

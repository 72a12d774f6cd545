"""A differential drive as Gazebo's plugins have it. SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """How fast a speed may be and change; m/s and m/s², or rad/s and rad/s²."""

    slowest: float = -math.inf
    fastest: float = math.inf
    braking: float = -math.inf  # the lowest acceleration
    acceleration: float = math.inf

    def next(self, speed: float, wanted: float, seconds: float) -> float:
        """The speed after so many seconds of going from one to the wanted one."""
        target = min(self.fastest, max(self.slowest, wanted))
        most, least = speed + self.acceleration * seconds, speed + self.braking * seconds
        return min(most, max(least, target))


@dataclass(frozen=True, kw_only=True)
class WheelPair:
    """Two wheels on one axle."""

    left: str  # joint
    right: str  # joint
    separation: float  # m, between the wheels
    radius: float  # m

    def speeds(self, linear: float, angular: float) -> tuple[float, float]:
        """How fast the rims of the left and the right wheel are for these (m/s), in m/s."""
        half = angular * self.separation / 2
        return linear - half, linear + half


@dataclass(frozen=True, kw_only=True)
class DiffDrive:
    """What a diff drive plugin was told."""

    generation: str  # the simulator that has the plugin: "classic" or "gz"
    pairs: tuple[WheelPair, ...]
    torque: float | None = None  # N m, of each wheel; None: what the limits of the joints say
    linear: Bounds = field(default_factory=Bounds)
    angular: Bounds = field(default_factory=Bounds)
    rim: Bounds = field(default_factory=Bounds)  # of each wheel's rim

"""Positions and orientations."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Pose:
    """A frame seen from another one, as URDF, SDF and the spawners write it."""

    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)  # rad; fixed-axis roll, pitch, yaw

    @property
    def is_finite(self) -> bool:
        """Whether no number is infinite or not-a-number."""
        return all(math.isfinite(number) for number in (*self.xyz, *self.rpy))


IDENTITY = Pose()

"""The one door to DART."""

from __future__ import annotations

from dartpy import collision, dynamics, simulation, utils
from dartpy.math import Isometry3

__all__ = ["Isometry3", "collision", "dynamics", "simulation", "utils"]

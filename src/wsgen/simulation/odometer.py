"""Measures how far a robot has come, as its behaviors are described."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.transform import rotation_of_quaternion
from wsgen.simulation.simulate import is_finite

if TYPE_CHECKING:
    from wsgen.simulation.engine import State


class Odometer:
    """How far a robot has come since it began.

    Attributes:
        moved: m, m, rad: of the root link's frame, along x and y of where it was, and how far it
            has turned, whole turns included.
        is_finite: Whether all states were; if not, `moved` is what was measured before.
    """

    def __init__(self, start: State) -> None:
        self.is_finite = is_finite(start)
        self._xyz = start.xyz
        self._heading = self._last = heading_of(start) if self.is_finite else 0.0
        self.moved = (0.0, 0.0, 0.0)  # m, m, rad

    def go(self, state: State) -> None:
        """Take in where it is an update later."""
        self.is_finite = self.is_finite and is_finite(state)
        if not self.is_finite:
            return
        heading = heading_of(state)
        turned = self.moved[2] + math.remainder(heading - self._last, math.tau)
        self._last = heading
        east, north = state.xyz[0] - self._xyz[0], state.xyz[1] - self._xyz[1]
        sin, cos = math.sin(self._heading), math.cos(self._heading)
        self.moved = (cos * east + sin * north, cos * north - sin * east, turned)


def heading_of(state: State) -> float:
    """Of the root link's x axis on the ground, rad."""
    rotation = rotation_of_quaternion(state.xyzw)
    return math.atan2(rotation[1][0], rotation[0][0])

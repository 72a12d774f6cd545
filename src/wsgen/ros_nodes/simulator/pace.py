"""How simulated time goes with that of the clock on the wall."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

BEHIND = 0.25  # s; what a machine is late by more is not made up for


class Pace:
    """Says how long to wait, so that simulated seconds take as long as they should.

    Attributes:
        rate: Simulated seconds a second; None: as many as possible.
        lost: Seconds that the machine was too slow by, and that were not made up for.
    """

    def __init__(self, rate: float | None, clock: Callable[[], float] = time.monotonic) -> None:
        self.rate = rate
        self.lost = 0.0
        self._clock = clock
        self._wall = clock()
        self._simulated = 0.0

    def begin(self, simulated: float) -> None:
        """It is that time (s) now: after a pause, or after a reset."""
        self._wall = self._clock()
        self._simulated = simulated

    def early(self, simulated: float) -> float:
        """How many seconds are left until it should be that time."""
        if self.rate is None:
            return 0.0
        due = self._wall + (simulated - self._simulated) / self.rate
        left = due - self._clock()
        if left < -BEHIND:
            self.lost -= left
            self._wall -= left
            return 0.0
        return max(0.0, left)

"""When the parts of a plugin are due, and how simulated time goes with that of the clock."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


TINY = 1e-9  # s; what sums of steps are off


def following(due: float, period: float, now: float) -> float:
    """When it is due next; what was missed is not made up for."""
    return due + period if due + period > now else now + period


class Timer:
    """Something that a plugin does every so often, in simulated time."""

    def __init__(self, period: float, now: float = 0.0) -> None:
        """`period` is in seconds; 0: at every update."""
        self.period = period
        self.next = now

    def is_due(self, now: float) -> bool:
        """Whether it is time for it; if so, the next time is a period later."""
        if now < self.next - TINY:
            return False
        self.next = following(self.next, self.period, now)
        return True

    def reset(self, now: float) -> None:
        """Begin again."""
        self.next = now


def until_next(now: float, *timers: Timer) -> float:
    """Seconds until the first of them is due."""
    return max(0.0, min(timer.next for timer in timers) - now)


BEHIND = 0.25  # s; what a machine is late by more is not made up for
LOOK_EVERY = 5.0  # s of the clock
SLOW = 0.9  # of the rate; less than this is reported


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
        self._looked = (self._wall, 0.0)

    def begin(self, simulated: float) -> None:
        """It is that time (s) now: after a pause, or after a reset."""
        self._wall = self._clock()
        self._simulated = simulated
        self._looked = (self._wall, simulated)

    def rate_reached(self, simulated: float) -> float | None:
        """The rate of the last `LOOK_EVERY` seconds, where it is clearly lower than it should be.

        None of any other time.
        """
        now, (wall, before) = self._clock(), self._looked
        if self.rate is None or now < wall + LOOK_EVERY:
            return None
        self._looked = (now, simulated)
        reached = (simulated - before) / (now - wall)
        return reached if reached < SLOW * self.rate else None

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

"""How fast a simulation runs, in words."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

RATE_OVER = 1.0  # s, wall-clock


class Speedometer:
    """Measures simulated time against that of a clock, over the last second."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._moments: deque[tuple[float, float]] = deque()  # wall-clock and simulated s

    def begin(self) -> None:
        """Forget what was: the simulation stood still, or has begun again."""
        self._moments.clear()

    def describe(self, simulated: float, *, is_running: bool) -> str:
        """Say in Markdown how far it is and how fast it runs now."""
        return f"**{simulated:.2f} s** simulated{self._rate(simulated, is_running=is_running)}"

    def _rate(self, simulated: float, *, is_running: bool) -> str:
        if not is_running:
            self.begin()
            return ", paused"
        now = self._clock()
        if self._moments and simulated < self._moments[-1][1]:  # it was reset
            self.begin()
        self._moments.append((now, simulated))
        while len(self._moments) > 2 and now - self._moments[1][0] > RATE_OVER:  # noqa: PLR2004
            self._moments.popleft()
        began, before = self._moments[0]
        if now - began < RATE_OVER / 2:
            return ""
        return f", {(simulated - before) / (now - began):.2g} × real time"

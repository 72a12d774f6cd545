"""Virtual time: what happens after what, without waiting.

Events of the same moment keep their order. A process that ends by itself ends `PROCESS_TIME`
after it was started; one that runs for ever "ends" only when nothing else is left to happen, so
that what waits for its end is found too.
"""

from __future__ import annotations

import heapq
import itertools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.event import Event

PROCESS_TIME = 0.001  # s
NEVER = float("inf")


class Timeline:
    """The events to come."""

    def __init__(self) -> None:
        self.now = 0.0  # s since the launch
        self.cause = "launch"  # of what happens at this moment
        self._order = itertools.count()
        self._coming: list[tuple[float, int, Event]] = []

    def post(self, event: Event, *, delay: float = 0.0) -> None:
        """Let the event happen after a delay in seconds; `NEVER` means last of all."""
        if event.wsgen_cause is None:
            event.wsgen_cause = self.cause
        heapq.heappush(self._coming, (self.now + max(0.0, delay), next(self._order), event))

    def next(self) -> Event | None:
        """Move on to the next event, if there is one."""
        if not self._coming:
            return None
        time, _, event = heapq.heappop(self._coming)
        if time != NEVER:
            self.now = time
        self.cause = event.wsgen_cause or "launch"
        return event

    def clear(self) -> None:
        """Drop what was to come, as a shutdown does."""
        self._coming.clear()

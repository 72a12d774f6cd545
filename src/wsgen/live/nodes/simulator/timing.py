"""When the parts of a plugin are due."""

from __future__ import annotations

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

"""How often messages come, as `ros2 topic hz` computes and prints it."""

from __future__ import annotations

import math
from collections import deque

DEFAULT_WINDOW = 10_000  # messages


class Rates:
    """The times between the messages of one topic, seconds."""

    def __init__(self, window: int = DEFAULT_WINDOW) -> None:
        self._times: deque[float] = deque(maxlen=window)
        self._last: float | None = None
        self._is_new = False

    def take(self, now: float) -> bool:
        """Note a message; False where the time has gone back, and all was forgotten."""
        if self._last is not None and now < self._last:
            self._times.clear()
            self._last = now
            return False
        if self._last is not None:
            self._times.append(now - self._last)
            self._is_new = True
        self._last = now
        return True

    def row(self) -> tuple[str, str, str, str, str] | None:
        """Rate, shortest and longest time, deviation, number; None where nothing is new."""
        if not self._is_new:
            return None
        self._is_new = False
        times = list(self._times)
        mean = sum(times) / len(times)
        deviation = math.sqrt(sum((time - mean) ** 2 for time in times) / len(times))
        return (
            f"{1.0 / mean if mean > 0 else 0.0:.3f}",
            f"{min(times):.3f}",
            f"{max(times):.3f}",
            f"{deviation:.5f}",
            str(len(times)),
        )


HEADER = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


def one_topic(row: tuple[str, str, str, str, str]) -> str:
    """The text for a topic that is measured alone."""
    rate, shortest, longest, deviation, window = row
    return (
        f"average rate: {rate}\n\tmin: {shortest}s max: {longest}s std dev: {deviation}s "
        f"window: {window}"
    )


def table(rows: list[tuple[str, ...]]) -> str:
    """The text for several topics, each row with the topic first."""
    widths = [max(map(len, column)) for column in zip(HEADER, *rows, strict=True)]
    lines = [
        "   ".join(text.center(width) for text, width in zip(HEADER, widths, strict=True)),
        "=" * (sum(widths) + 3 * (len(widths) - 1)),
        *(
            "   ".join(text.ljust(width) for text, width in zip(row, widths, strict=True))
            for row in rows
        ),
    ]
    return "\n".join(lines) + "\n"

"""The events of a live launch: those that are due now, and those that time brings.

Time is that of the clock, or of the simulator, which is asked for it.
"""

from __future__ import annotations

import heapq
import itertools
import json
import socket
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.simulation.live_scene import short_name, socket_path

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


LONGEST_WAIT = 0.5  # s; what ends without a signal is noticed after it
PUMP_SECONDS = 0.02  # the longest time that events keep the output of processes waiting
POLL_SECONDS = 0.05  # between two looks at the time of the simulation


class ScheduledCall:
    """A function that is called at a time, and is no event of launch."""

    wsgen_cause: str | None = "launch"

    def __init__(
        self, call: Callable[[], object], is_void: Callable[[], bool] | None = None
    ) -> None:
        self.call = call
        self._is_void = is_void

    @property
    def wsgen_is_void(self) -> bool:
        """Whether it need not be called any more."""
        return self._is_void is not None and self._is_void()


class _Simulated(NamedTuple):
    """An event that waits for the time of the simulation."""

    due: float  # s, simulated
    event: Any


class LiveTimeline:
    """As the timeline of a plan, on which real time passes.

    Args:
        wait: Waits for what happens outside, so many seconds at most, and posts its events.
        is_busy: Whether anything runs whose end is yet to come.
        simulated_now: The time of the simulation in seconds; None where it has not begun.
    """

    def __init__(
        self,
        wait: Callable[[float], None],
        is_busy: Callable[[], bool],
        simulated_now: Callable[[], float | None],
    ) -> None:
        self.cause = "launch"  # of plans
        self._wait = wait
        self._is_busy = is_busy
        self._simulated_now = simulated_now
        self._order = itertools.count()
        self._coming: list[tuple[float, int, Any]] = []
        self._simulated: list[_Simulated] = []
        self._begun = time.monotonic()
        self._pumped = 0.0

    @property
    def now(self) -> float:
        """Seconds since the launch."""
        return time.monotonic() - self._begun

    def post(self, event: Any, *, delay: float = 0.0, is_simulated: bool = False) -> None:
        """Let the event happen after a delay in seconds."""
        if event.wsgen_cause is None:
            event.wsgen_cause = self.cause
        now = self._simulated_now() if is_simulated and delay > 0.0 else None
        if is_simulated and delay > 0.0:
            # Before the simulation begins its time is zero.
            self._simulated.append(_Simulated(due=(now or 0.0) + delay, event=event))
        else:
            due = time.monotonic() + max(0.0, delay)
            heapq.heappush(self._coming, (due, next(self._order), event))

    def next(self) -> Any | None:
        """Wait for the next event; None where nothing can bring one any more."""
        while True:
            now = time.monotonic()
            if now - self._pumped > PUMP_SECONDS:
                self._pumped = now
                self._wait(0.0)
            self._drop_void()
            if self._coming and self._coming[0][0] <= now:
                _, _, event = heapq.heappop(self._coming)
                if isinstance(event, ScheduledCall):
                    event.call()
                    continue
                self.cause = event.wsgen_cause or "launch"
                return event
            if not self._coming and not self._simulated and not self._is_busy():
                return None
            seconds = LONGEST_WAIT
            if self._coming:
                seconds = min(seconds, self._coming[0][0] - now)
            if self._simulated:
                seconds = min(seconds, POLL_SECONDS)
                self._take_simulated()
            self._wait(max(0.0, seconds))
            self._pumped = time.monotonic()

    @property
    def starts_more(self) -> bool:
        """Whether events of the launch are to come, which may start processes."""
        return bool(self._simulated) or any(
            not isinstance(event, ScheduledCall) for _, _, event in self._coming
        )

    def cancel(self, is_canceled: Callable[[Any], bool]) -> None:
        """Drop events that are to come."""
        self._coming = [entry for entry in self._coming if not is_canceled(entry[-1])]
        heapq.heapify(self._coming)
        self._simulated = [entry for entry in self._simulated if not is_canceled(entry.event)]

    def clear(self) -> None:
        """Drop nothing: what runs is yet to end."""

    def _drop_void(self) -> None:
        if any(entry[-1].wsgen_is_void for entry in self._coming):
            self.cancel(lambda event: event.wsgen_is_void)
        self._simulated = [one for one in self._simulated if not one.event.wsgen_is_void]

    def _take_simulated(self) -> None:
        now = self._simulated_now()
        if now is None:
            return
        for one in [one for one in self._simulated if one.due <= now]:
            self._simulated.remove(one)
            self.post(one.event)


SECONDS = 0.2  # wall-clock, for an answer


class SimulatedTime:
    """The time of the simulator in the folder of a live run, asked by one connection."""

    def __init__(self, folder: Path) -> None:
        self._path = socket_path(folder)
        self._socket: socket.socket | None = None
        self._stream: Any = None

    def now(self) -> float | None:
        """Seconds of the simulation; None where the simulator is not there or does not answer."""
        try:
            if self._socket is None:
                self._connect()
            self._stream.write(b'{"do": "state"}\n')
            self._stream.flush()
            return float(json.loads(self._stream.readline())["seconds"])
        except (OSError, ValueError, TypeError, KeyError):
            self.close()  # a late answer would be that to the next question
        return None

    def close(self) -> None:
        """End the connection."""
        if self._stream is not None:
            with suppress(OSError):
                self._stream.close()
        if self._socket is not None:
            self._socket.close()
        self._socket = self._stream = None

    def _connect(self) -> None:
        made = self._socket = socket.socket(socket.AF_UNIX)
        made.settimeout(SECONDS)
        with short_name(self._path) as name:
            made.connect(name)
        self._stream = made.makefile("rwb")

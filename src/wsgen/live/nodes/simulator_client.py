"""The time of the simulator of a live run, where no bridge brings /clock to ROS; what it was."""

from __future__ import annotations

import time
from bisect import bisect_right
from typing import TYPE_CHECKING

from wsgen.simulation.live_runs import SimulatorClient, SimulatorError

if TYPE_CHECKING:
    from pathlib import Path


ASK_SECONDS = 0.005  # wall-clock, between two questions
MOST_TIMES = 200_000  # that are kept: 1000 s of a /clock
PATIENCE_SECONDS = 1.0  # wall-clock, for an answer: a simulator that hangs must not hold others


class SimulatorTime:
    """What the simulator of a live run says by its socket, asked again after `ASK_SECONDS`."""

    def __init__(self, folder: Path) -> None:
        """Ask the simulator of a live run, as soon as it is there.

        Args:
            folder: Of the run.
        """
        self._client = SimulatorClient(folder, patience=PATIENCE_SECONDS)
        self._next = 0.0  # wall-clock, of the next question
        self._nanoseconds = 0

    def nanoseconds(self) -> int:
        """What it said last; 0 before it is there."""
        now = time.monotonic()
        if now >= self._next:
            try:
                if self._client.connect(0.0):
                    self._nanoseconds = round(self._client.ask("state")["seconds"] * 1e9)
            except (SimulatorError, OSError, ValueError, KeyError):  # it has ended, or is stopped
                self._client.close()
            self._next = time.monotonic() + ASK_SECONDS
        return self._nanoseconds

    def close(self) -> None:
        """End the connection."""
        self._client.close()


class SimulatedTimes:
    """What the simulated time was when a message was sent; the wall-clock says when that was."""

    def __init__(self) -> None:
        self._sent: list[int] = []  # ns since 1970, rising
        self._times: list[int] = []  # ns

    def note(self, sent: int, simulated: int) -> None:
        """Note the simulated time from then on.

        What the simulator was asked before is forgotten where a message of /clock had waited.
        """
        while self._sent and self._sent[-1] > sent:
            self._sent.pop()
            self._times.pop()
        self._sent.append(sent)
        self._times.append(simulated)
        if len(self._sent) > MOST_TIMES:
            del self._sent[: MOST_TIMES // 2], self._times[: MOST_TIMES // 2]

    def reach(self, sent: int) -> bool:
        """Whether a later time than that is noted, or that one."""
        return bool(self._sent) and self._sent[-1] >= sent

    def at(self, sent: int) -> int:
        """The simulated time at that of the wall-clock; 0 where none is known."""
        before = bisect_right(self._sent, sent)
        return self._times[max(0, before - 1)] if self._times else 0

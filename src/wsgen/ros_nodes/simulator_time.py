"""The time of a simulator whose /clock no bridge brings to ROS."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from wsgen.ros_nodes.simulator_client import SimulatorClient, SimulatorError

if TYPE_CHECKING:
    from pathlib import Path

ASK_SECONDS = 0.005  # wall-clock, between two questions
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

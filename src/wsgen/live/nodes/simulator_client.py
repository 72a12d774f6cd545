"""What programs of a launch file ask of the simulator of their live run.

It says its time, too, where no bridge brings /clock to ROS, and what it was.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import time
from bisect import bisect_right
from typing import TYPE_CHECKING, Any

from wsgen.simulation.live_runs import short_name, socket_path

if TYPE_CHECKING:
    from pathlib import Path


LOOK_EVERY = 0.05  # s, for the socket


class SimulatorError(Exception):
    """The simulator refuses a command; `hint` is what to do."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class SimulatorEndedError(SimulatorError):
    """It does not answer any more."""

    def __init__(self) -> None:
        super().__init__("The simulator has ended.", "Read what it printed before.")


class SimulatorClient:
    """A connection to the simulator."""

    def __init__(self, folder: Path | None = None, *, patience: float | None = None) -> None:
        """Connect to that of a live run, later.

        Args:
            folder: Of the run; None: of that which this process then has, see `find_simulator`.
            patience: How long to wait for an answer, s; afterwards it has ended.
        """
        self._folder = folder
        self._patience = patience
        self._socket: socket.socket | None = None
        self._stream: Any = None

    def connect(self, seconds: float) -> bool:
        """Wait for the simulator, no longer than that; gives whether it is there."""
        last = time.monotonic() + seconds
        while self._socket is None:
            made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                with short_name(socket_path(self._found_folder())) as name:
                    made.connect(name)
            except (FileNotFoundError, ConnectionRefusedError):
                made.close()
                if time.monotonic() >= last:
                    return False
                time.sleep(LOOK_EVERY)
            else:
                made.settimeout(self._patience)
                self._socket, self._stream = made, made.makefile("rwb")
        return True

    def _found_folder(self) -> Path:
        """Raise FileNotFoundError where no live run is there."""
        if self._folder is not None:
            return self._folder
        from wsgen.simulation.live_runs import find_simulator  # noqa: PLC0415  some need no search

        found = find_simulator(os.environ)
        if found is None:
            raise FileNotFoundError
        return found

    def ask(self, do: str, **values: Any) -> dict[str, Any]:
        """Have the simulator do something; gives its answer.

        Raises:
            SimulatorError: It cannot do it.
            SimulatorEndedError: It has ended.
        """
        try:
            self._stream.write(json.dumps({"do": do, **values}).encode() + b"\n")
            self._stream.flush()
            line = self._stream.readline()
        except OSError:
            line = b""
        if not line:
            raise SimulatorEndedError
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise SimulatorError(str(answer["error"]), str(answer.get("hint", "")))
        return answer

    def wait_until_it_ends(self) -> None:
        """Wait as long as the simulator is there."""
        try:
            while self._stream.readline():
                pass
        except OSError:
            pass

    def interrupt(self) -> None:
        """End the connection for a thread that waits for an answer."""
        if (waited_for := self._socket) is not None:
            with contextlib.suppress(OSError):
                waited_for.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End the connection, and what goes with it."""
        if self._socket is not None:
            with contextlib.suppress(OSError):  # what is not sent yet
                self._stream.close()
            self._socket.close()
            self._socket = None


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

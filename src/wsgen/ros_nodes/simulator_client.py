"""What programs of a launch file tell the simulator of their live run."""

from __future__ import annotations

import json
import os
import socket
import time
from pathlib import Path
from typing import Any

from wsgen.simulation.live_scene import FOLDER_VARIABLE, short_name, socket_path

LOOK_EVERY = 0.05  # s, for the socket


class SimulatorError(Exception):
    """The simulator does not do what it was told; `hint` is what to do."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def live_folder() -> Path:
    """The folder of the live run that this process belongs to.

    Raises:
        SimulatorError: It belongs to none.
    """
    folder = os.environ.get(FOLDER_VARIABLE)
    if not folder:
        raise SimulatorError(
            f"This program has no simulator: {FOLDER_VARIABLE} is not set.",
            "Start it with `wsgen launch PACKAGE FILE --run`.",
        )
    return Path(folder)


class SimulatorClient:
    """A connection to the simulator."""

    def __init__(self, folder: Path) -> None:
        self._path = socket_path(folder)
        self._socket: socket.socket | None = None
        self._stream: Any = None

    def connect(self, seconds: float) -> bool:
        """Wait for the simulator, no longer than that; gives whether it is there."""
        last = time.monotonic() + seconds
        while self._socket is None:
            made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                with short_name(self._path) as name:
                    made.connect(name)
            except (FileNotFoundError, ConnectionRefusedError):
                made.close()
                if time.monotonic() >= last:
                    return False
                time.sleep(LOOK_EVERY)
            else:
                self._socket, self._stream = made, made.makefile("rwb")
        return True

    def ask(self, do: str, **values: Any) -> dict[str, Any]:
        """Have the simulator do something; gives its answer.

        Raises:
            SimulatorError: It cannot do it, or it has ended.
        """
        try:
            self._stream.write(json.dumps({"do": do, **values}).encode() + b"\n")
            self._stream.flush()
            line = self._stream.readline()
        except OSError:
            line = b""
        if not line:
            raise SimulatorError("The simulator has ended.", "Read what it printed before.")
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

    def close(self) -> None:
        """End the connection, and what goes with it."""
        if self._socket is not None:
            self._stream.close()
            self._socket.close()
            self._socket = None

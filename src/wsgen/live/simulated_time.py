"""Ask the simulator of a live run for its time."""

from __future__ import annotations

import json
import socket
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.simulation.live_scene import short_name, socket_path

if TYPE_CHECKING:
    from pathlib import Path

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

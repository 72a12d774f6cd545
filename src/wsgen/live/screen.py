"""What a live run writes: to the terminal by a thread, so that nobody waits for it, and to logs."""

from __future__ import annotations

import logging
import os
import re
import select
import threading
import time
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import BinaryIO

    from wsgen.live.journal import JournalWriter

MOST_WAITING = 1 << 20  # bytes for the screen; when they are reached, processes wait
LARGEST_LOG = 64 << 20  # bytes of one file
SECONDS_AT_END = 2.0  # for what still waits, where nobody reads it
LOOK_EVERY = 0.05  # s, for whether somebody does
COLORS = {"WARNING": "\x1b[33m", "ERROR": "\x1b[31m", "CRITICAL": "\x1b[31m", "DEBUG": "\x1b[32m"}
PLAIN = "\x1b[0m"
_ESCAPES = re.compile(rb"\x1b\[[0-9;?]*[A-Za-z]")
LOG_FOLDER = "ROS_LOG_DIR"  # a variable


class Screen:
    """Standard output, written by a thread."""

    def __init__(self, descriptor: int, *, is_colored: bool) -> None:
        self.is_colored = is_colored
        self._descriptor = descriptor
        self._waiting: deque[bytes] = deque()
        self._size = 0
        self._is_broken = False
        self._is_closed = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def is_full(self) -> bool:
        """Whether as much waits as may wait."""
        return self._size >= MOST_WAITING

    def write(self, line: bytes) -> None:
        """Write a line after those that wait."""
        with self._changed:
            if not self._is_broken:
                self._waiting.append(line + b"\n")
                self._size += len(line) + 1
                self._changed.notify()

    def close(self, seconds: float = SECONDS_AT_END) -> None:
        """Write what waits; it is given up when nobody has read for so long."""
        with self._changed:
            self._is_closed = True
            self._changed.notify()
        room = select.poll()
        room.register(self._descriptor, select.POLLOUT)
        end = time.monotonic() + seconds
        while self._thread.is_alive() and time.monotonic() < end:
            self._thread.join(LOOK_EVERY)
            if room.poll(0):  # on a busy machine it is the thread that takes its time
                end = time.monotonic() + seconds

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._waiting and not self._is_closed:
                    self._changed.wait()
                if not self._waiting:
                    return
                data = b"".join(self._waiting)
                self._waiting.clear()
            try:
                self._write_all(data)
            except OSError:  # nobody reads it any more
                self._is_broken = True
            with self._changed:
                self._size -= len(data)
                if self._is_broken:
                    self._waiting.clear()
                    self._size = 0

    def _write_all(self, data: bytes) -> None:
        rest = memoryview(data)
        while rest:
            rest = rest[self._write_some(rest) :]

    def _write_some(self, data: memoryview) -> int:
        try:
            return os.write(self._descriptor, data)
        except BlockingIOError:  # another process has made it non-blocking
            waiting = select.poll()
            waiting.register(self._descriptor, select.POLLOUT)
            waiting.poll()
            return 0


class LogFiles:
    """The log of a launch, and those of processes that want their own; without a folder, none."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._streams: dict[str, BinaryIO] = {}
        self._sizes: dict[str, int] = {}

    def write(self, name: str, line: bytes) -> None:
        """Write a line into a file of the folder, while it is not too large."""
        if self.folder is None:
            return
        size = self._sizes.get(name, 0)
        if size > LARGEST_LOG:
            return
        if size + len(line) > LARGEST_LOG:
            line = b"The log ends here: it would become too large."
            size = LARGEST_LOG
        try:
            if name not in self._streams:
                self._streams[name] = (self.folder / name).open("ab")
            self._streams[name].write(_ESCAPES.sub(b"", line) + b"\n")
        except OSError:  # a full disk ends no robot
            self._sizes[name] = LARGEST_LOG + 1
        else:
            self._sizes[name] = size + len(line) + 1

    def close(self) -> None:
        """Close the files."""
        for stream in self._streams.values():
            with suppress(OSError):
                stream.close()
        self._streams.clear()

    def flush(self) -> None:
        """Let others read what was written."""
        for stream in self._streams.values():
            with suppress(OSError):
                stream.flush()


def make_log_folder(environment: Mapping[str, str], pid: int) -> Path | None:
    """Make the folder for the logs of a launch, where `ros2 launch` makes its own.

    None where it cannot be made.
    """
    base = log_base(environment)
    now = time.time()
    stamp = time.strftime("%Y-%m-%d-%H-%M-%S", time.localtime(now))
    folder = base / f"{stamp}-{int(now % 1 * 1e6):06d}-{os.uname().nodename}-{pid}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            return None
        latest = base / "latest"
        if latest.is_symlink():
            latest.unlink()
        if not latest.exists():
            latest.symlink_to(folder)
    except OSError:
        return folder if folder.is_dir() else None
    return folder


def log_base(environment: Mapping[str, str]) -> Path:
    """The folder for the logs of all launches."""
    home = environment.get("ROS_HOME") or Path("~", ".ros").expanduser()
    return Path(environment.get(LOG_FOLDER) or Path(home, "log")).expanduser()


class ScreenHandler(logging.Handler):
    """Python's loggers of launch, in the format of `ros2 launch`."""

    def __init__(
        self, screen: Screen, logs: LogFiles, journal: JournalWriter | None = None
    ) -> None:
        super().__init__()
        self._screen = screen
        self._logs = logs
        self._journal = journal

    def emit(self, record: logging.LogRecord) -> None:
        """Write one message."""
        line = f"[{record.levelname}] [{record.name}]: {record.getMessage()}"
        data = line.encode("utf-8", "replace")
        color = COLORS.get(record.levelname, "") if self._screen.is_colored else ""
        self._screen.write(color.encode() + data + PLAIN.encode() if color else data)
        self._logs.write("launch.log", f"{record.created:.7f} ".encode() + data)
        if self._journal is not None:
            self._journal.printed("launch", [data])

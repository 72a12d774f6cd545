"""A process that a live launch has started, and what it prints.

What is written goes to the terminal by a thread, so that nobody waits for it, and to logs.
"""

from __future__ import annotations

import logging
import os
import re
import select
import signal
import threading
import time
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.live.journal import OTHER
from wsgen.live.python_failures import LastTraceback, missing_module, missing_name, newer_numpy

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Mapping, Sequence
    from typing import BinaryIO

    from wsgen.launching.live import Start
    from wsgen.live.forked_nodes import ForkedNode
    from wsgen.live.journal import JournalWriter
    from wsgen.live.python_failures import Frame

    Begin = Callable[[Mapping[str, str], Sequence[int]], subprocess.Popen[bytes] | ForkedNode]


READ = 1 << 16  # bytes at once
LONGEST_LINE = 1 << 16  # bytes; what is longer is cut into several
PRINTED_A_SECOND = 1 << 18  # bytes that a process may print for long
PRINTED_AT_ONCE = 1 << 21  # bytes that it may print without waiting
A_LINE = 50  # bytes more that a line counts, for what is written before it
MOST_CACHED = 1 << 24  # bytes that are kept for the launch file
STDOUT, STDERR = 1, 2
STREAMS = {STDOUT: "stdout", STDERR: "stderr"}
# Signals that ask a process to end, whatever its exit code is then. Others may be for its handler.
ENDING = frozenset({signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM, signal.SIGKILL})
DESTINATIONS = ("screen", "log", "own_log")
_ALIASES: dict[str, dict[str, set[str]]] = {
    "screen": {"both": {"screen"}},
    "log": {"both": {"log"}, "stderr": {"screen"}},
    "both": {"both": {"log", "screen"}},
    "own_log": {name: {"own_log"} for name in ("both", "stdout", "stderr")},
    "full": {
        "both": {"screen", "log", "own_log"},
        "stdout": {"own_log"},
        "stderr": {"own_log"},
    },
}


def destinations(config: Mapping[str, object] | str) -> dict[str, frozenset[str]]:
    """Where the output goes, by "stdout", "stderr" and "both", as launch reads it.

    Raises:
        ValueError: It is none of the words of launch.
    """
    if isinstance(config, str):
        if config not in _ALIASES:
            raise ValueError(
                f'{config} is not a valid standard output config i.e. "screen", "log" or "both"'
            )
        found: Mapping[str, object] = _ALIASES[config]
    else:
        found = config
    result = {name: frozenset[str]() for name in ("both", "stdout", "stderr")}
    for source, wanted in found.items():
        if source not in result:
            raise ValueError(
                f'{source} is not a valid output source i.e. "stdout", "stderr" or "both"'
            )
        names = frozenset([wanted] if isinstance(wanted, str) else wanted)  # type: ignore[call-overload]  # checked below
        for name in names:
            if name not in DESTINATIONS:
                raise ValueError(
                    f'{name} is not a valid output destination i.e. "screen", "log" or "own_log"'
                )
        result[source] = names
    return result


class Causes(NamedTuple):
    """What a Python program has printed of why it has ended."""

    missing_module: str | None  # whose absence has ended it
    missing_name: str | None  # what to say of a message that a package does not have
    newer_numpy: str | None  # the release of NumPy that refused what it did
    frames: tuple[Frame, ...]  # of its tracebacks, the innermost one first


class LineFormat:
    """What is written of a line; a format of the launch file that fails is replaced."""

    def __init__(self, name: str, start: Start) -> None:
        self.name = name
        self._form = start.output_format
        self._action = start.action

    def shown(self, line: bytes) -> bytes:
        """A line as it is written."""
        if self._form is not None:
            text = line.decode(errors="replace")
            try:
                return self._form.format(line=text, this=self._action).encode("utf-8", "replace")
            except Exception as error:  # noqa: BLE001  it calls what the launch file has
                self._notify(error)
        return b"[%s] %s" % (self.name.encode(), line)

    def _notify(self, error: Exception) -> None:
        reason = f"{type(error).__name__}: {error}"
        text = f"output_format {self._form!r} fails ({reason}); lines are '[{self.name}] LINE'"
        self._form = None
        logging.getLogger(self.name).error("%s", text)


class Output:
    """One stream of a process: its lines go where they are wanted."""

    def __init__(  # noqa: PLR0913  where lines go
        self,
        form: LineFormat,
        stream: int,
        *,
        start: Start,
        screen: Screen,
        logs: LogFiles,
        journal: JournalWriter | None = None,
    ) -> None:
        self.stream = stream
        self._journal = journal
        self._form = form
        self._start = start
        self._screen = screen
        self._logs = logs
        self._rest = b""
        self._unheard = b""  # of a line, that nobody who listens has heard
        wanted = destinations(start.output)
        own = STREAMS[stream]
        self._to = wanted["both"] | wanted[own]
        self._files = [f"{form.name}-{own}.log"] if "own_log" in wanted[own] else []
        self._files += [f"{form.name}.log"] if "own_log" in wanted["both"] else []
        self._traceback = LastTraceback()
        self.cached: deque[bytes] = deque()
        self._cached_size = 0

    def take(self, data: bytes) -> None:
        """Write the whole lines of what was read, and keep the rest."""
        if self._start.is_cached and self._cached_size < MOST_CACHED:
            self.cached.append(data)
            self._cached_size += len(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        if self.stream == STDERR:
            self._traceback.take(b"\n".join(lines))
        while len(self._rest) > LONGEST_LINE:
            lines.append(self._rest[:LONGEST_LINE])
            self._rest = self._rest[LONGEST_LINE:]
        if lines:
            self._write([line.rstrip(b"\r") for line in lines])

    def hear(self, data: bytes, *, is_last: bool = False) -> bytes:
        """What those who listen hear: whole lines, as programs print them that do not flush."""
        lines, found, self._unheard = (self._unheard + data).rpartition(b"\n")
        if is_last:
            found, self._unheard = found + self._unheard, b""
        return lines + found

    def finish(self) -> None:
        """Write what has no line break."""
        if self._rest:
            self._write([self._rest])
            self._rest = b""

    def causes(self) -> Causes:
        """Why the process has ended, by its last traceback; asked when it has."""
        said = self._traceback.said()
        return Causes(
            missing_module=missing_module(said),
            missing_name=missing_name(said),
            newer_numpy=newer_numpy(said),
            frames=tuple(self._traceback.innermost_first()),
        )

    def text(self) -> str:
        """What was printed, where it is kept."""
        return b"".join(self.cached).decode(errors="replace")

    def _write(self, lines: list[bytes]) -> None:
        if self._journal is not None:
            self._journal.printed(self._form.name, lines)
        shown = [self._form.shown(line) for line in lines]
        if "screen" in self._to:
            self._screen.write(b"\n".join(shown))
        files = [*(["launch.log"] if "log" in self._to else []), *self._files]
        if files:
            stamp = f"{time.time():.7f} ".encode()
            stamped = b"\n".join([stamp + line for line in shown])
            for file in files:
                self._logs.write(file, stamped)


class Budget:
    """How much a process may print: it waits when it has printed more than others can use."""

    def __init__(self) -> None:
        self._left = float(PRINTED_AT_ONCE)
        self._time = time.monotonic()
        self.was_exceeded = False

    def spend(self, data: bytes) -> bool:
        """Count what was read; whether that is now too much for the first time."""
        self._refill()
        self._left -= len(data) + A_LINE * data.count(b"\n")
        first = self._left < 0.0 and not self.was_exceeded
        self.was_exceeded |= first
        return first

    @property
    def is_spent(self) -> bool:
        """Whether the process has to wait."""
        self._refill()
        return self._left < 0.0

    def _refill(self) -> None:
        now = time.monotonic()
        self._left = min(PRINTED_AT_ONCE, self._left + (now - self._time) * PRINTED_A_SECOND)
        self._time = now


class RunningProcess:
    """A started process with the output that it has yet to print.

    It leads a session of its own, so that signals reach what it has started, too. Its standard
    input stays open and empty, as that of a process of `ros2 launch`.

    Raises:
        OSError: It cannot be started.
    """

    def __init__(  # noqa: PLR0913  what a process has
        self,
        begin: Begin,
        *,
        start: Start,
        name: str,
        environment: Mapping[str, str],
        screen: Screen,
        logs: LogFiles,
        journal: JournalWriter | None = None,
    ) -> None:
        self.start = start
        self.name = name
        self.shown = name  # as `ros2 launch` would show its command line
        self.role = OTHER  # as the journal has it
        self.respawn: Callable[[], None] = _do_nothing
        self.budget = Budget()
        self.is_ending = False  # it was asked to end, and gets stronger signals if it does not
        self._signals: set[int] = set()  # that it was sent
        self.outputs: dict[int, Output] = {}  # by the descriptor that is read
        form = LineFormat(name, start)
        outputs = [
            Output(form, stream, start=start, screen=screen, logs=logs, journal=journal)
            for stream in (STDOUT, STDERR)
        ]
        ends: list[int] = []
        try:
            for output in outputs:
                ours, theirs = _open_terminal() if start.emulates_tty else os.pipe()
                ends.append(theirs)
                self.outputs[ours] = output
                os.set_blocking(ours, False)
            self.child = begin(environment, ends)
        except BaseException:
            self.close()
            raise
        finally:
            for end in ends:
                os.close(end)
        self.pid = self.child.pid

    def read(self, descriptor: int) -> bytes | None:
        """Read what one stream has; None at its end, b"" where nothing waits."""
        try:
            return os.read(descriptor, READ) or None
        except BlockingIOError:
            return b""
        except OSError:  # of a terminal whose other side is closed
            return None

    def drain(self, take: Callable[[int, bytes], None]) -> None:
        """Read what is left after the end; what it has started may still hold the streams."""
        for descriptor in list(self.outputs):
            left = PRINTED_AT_ONCE
            while left > 0 and (data := self.read(descriptor)):
                left -= len(data)
                take(descriptor, data)

    def causes(self) -> Causes:
        """Why it has ended, by what it has printed; asked before its streams are closed."""
        (found,) = (one.causes() for one in self.outputs.values() if one.stream == STDERR)
        return found

    def send_signal(self, number: int) -> None:
        """Send a signal to the process and to what it has started."""
        self._signals.add(number)
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)

    def is_end_wanted(self, code: int) -> bool:
        """Whether it was asked to end: by launch, or by a signal that the launch file sends."""
        return self.is_ending or not ENDING.isdisjoint(self._signals) or -code in self._signals

    def close(self) -> None:
        """Close its streams."""
        for descriptor in self.outputs:
            os.close(descriptor)
        self.outputs.clear()
        child = getattr(self, "child", None)
        if child is not None and child.stdin is not None:
            with suppress(OSError):
                child.stdin.close()


def _do_nothing() -> None:
    """A process that is not respawned."""


def _open_terminal() -> tuple[int, int]:
    import pty  # noqa: PLC0415  seldom wanted

    return pty.openpty()


def signal_number(number: str | int) -> int:
    """The number of a signal that a launch file names.

    Raises:
        RequestError: No signal is called so.
    """
    if isinstance(number, int):
        return number
    try:
        return signal.Signals[number]
    except KeyError as error:
        raise RequestError(
            f"No signal is called {number!r}.", hint="Name one of those of `kill -l`: SIGINT"
        ) from error


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

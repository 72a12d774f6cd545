"""A process that a live launch has started, and what it prints."""

from __future__ import annotations

import logging
import os
import signal
import time
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.live.journal import OTHER
from wsgen.live.python_failures import LastTraceback, missing_module, missing_name, newer_numpy

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.launching.live import Start
    from wsgen.live.forked_nodes import ForkedNode
    from wsgen.live.journal import JournalWriter
    from wsgen.live.python_failures import Frame
    from wsgen.live.screen import LogFiles, Screen

    # Starts it in a session of its own, with its environment, its output and its errors.
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

"""A process that a live launch has started, and what it prints."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import time
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING

from wsgen.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.launch.live import Start
    from wsgen.live.screen import LogFiles, Screen

READ = 1 << 16  # bytes at once
LONGEST_LINE = 1 << 16  # bytes; what is longer is cut into several
PRINTED_A_SECOND = 1 << 18  # bytes that a process may print for long
PRINTED_AT_ONCE = 1 << 21  # bytes that it may print without waiting
A_LINE = 50  # bytes more that a line counts, for what is written before it
MOST_CACHED = 1 << 24  # bytes that are kept for the launch file
STDOUT, STDERR = 1, 2
STREAMS = {STDOUT: "stdout", STDERR: "stderr"}
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
                self._tell(error)
        return b"[%s] %s" % (self.name.encode(), line)

    def _tell(self, error: Exception) -> None:
        reason = f"{type(error).__name__}: {error}"
        text = f"output_format {self._form!r} fails ({reason}); lines are '[{self.name}] LINE'"
        self._form = None
        logging.getLogger(self.name).error("%s", text)


class Output:
    """One stream of a process: its lines go where they are wanted."""

    def __init__(
        self,
        form: LineFormat,
        stream: int,
        *,
        start: Start,
        screen: Screen,
        logs: LogFiles,
    ) -> None:
        self.stream = stream
        self._form = form
        self._start = start
        self._screen = screen
        self._logs = logs
        self._rest = b""
        self._unheard = b""  # of a line, that nobody who listens has been told
        wanted = destinations(start.output)
        own = STREAMS[stream]
        self._to = wanted["both"] | wanted[own]
        self._files = [f"{form.name}-{own}.log"] if "own_log" in wanted[own] else []
        self._files += [f"{form.name}.log"] if "own_log" in wanted["both"] else []
        self.cached: deque[bytes] = deque()
        self._cached_size = 0

    def take(self, data: bytes) -> None:
        """Write the whole lines of what was read, and keep the rest."""
        if self._start.is_cached and self._cached_size < MOST_CACHED:
            self.cached.append(data)
            self._cached_size += len(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        while len(self._rest) > LONGEST_LINE:
            lines.append(self._rest[:LONGEST_LINE])
            self._rest = self._rest[LONGEST_LINE:]
        if lines:
            self._write([line.rstrip(b"\r") for line in lines])

    def hear(self, data: bytes, *, is_last: bool = False) -> bytes:
        """What those who listen are told: whole lines, as programs print them that do not flush."""
        lines, found, self._unheard = (self._unheard + data).rpartition(b"\n")
        if is_last:
            found, self._unheard = found + self._unheard, b""
        return lines + found

    def finish(self) -> None:
        """Write what has no line break."""
        if self._rest:
            self._write([self._rest])
            self._rest = b""

    def text(self) -> str:
        """What was printed, where it is kept."""
        return b"".join(self.cached).decode(errors="replace")

    def _write(self, lines: list[bytes]) -> None:
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
        command: Sequence[str],
        *,
        start: Start,
        name: str,
        environment: Mapping[str, str],
        screen: Screen,
        logs: LogFiles,
        is_shell: bool = False,
    ) -> None:
        self.start = start
        self.name = name
        self.shown = " ".join(command)  # as `ros2 launch` would show it
        self.respawn: Callable[[], None] = _do_nothing
        self.budget = Budget()
        self.is_ending = False  # it was told to end
        self.outputs: dict[int, Output] = {}  # by the descriptor that is read
        form = LineFormat(name, start)
        outputs = [
            Output(form, stream, start=start, screen=screen, logs=logs)
            for stream in (STDOUT, STDERR)
        ]
        ends: list[int] = []
        try:
            for output in outputs:
                ours, theirs = _open_terminal() if start.emulates_tty else os.pipe()
                ends.append(theirs)
                self.outputs[ours] = output
                os.set_blocking(ours, False)
            self.child = subprocess.Popen(
                " ".join(command) if is_shell else list(command),
                shell=is_shell,
                stdin=subprocess.PIPE,
                stdout=ends[0],
                stderr=ends[1],
                cwd=start.folder,
                env=dict(environment),
                start_new_session=True,
            )
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

    def send_signal(self, number: int) -> None:
        """Send a signal to the process and to what it has started."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)

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

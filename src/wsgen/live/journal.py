"""What happens in a live run: who starts, what they print, how they end.

The launch service writes it into a file, and the process that has started the run reads it. Each
line is a JSON array that begins with what has happened:

    ["started", NAME, PID, NODE, ROLE]       NODE: its full name or null; ROLE: see below
    ["line", NAME, TEXT]                     of a process, or of launch itself
    ["ended", NAME, CODE, IS_WANTED]         IS_WANTED: it was asked to
    ["left_out", WHAT, WHY]
"""

from __future__ import annotations

import json
from collections import deque
from contextlib import suppress
from dataclasses import field
from typing import TYPE_CHECKING, Any

from wsgen.isolation.codec import decode, encode
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from io import RawIOBase
    from pathlib import Path


FILE = "journal"  # in the live folder
LARGEST = 256 << 20  # bytes; what is printed after that is not kept
# Roles: a spawner brings something and ends; a standard program is one of ROS, or wsgen's in the
# place of one of ROS or Gazebo; others are the user's.
SIMULATOR, SPAWNER, STANDARD, OTHER = "simulator", "spawner", "standard", ""
LAUNCH = "launch"  # the name under which launch itself prints
# What programs that are not the user's say where all is well, such as what they begin to do.
_USUAL = lazy_pattern(r"\[(?:INFO|DEBUG)\]")
LONGEST_LINE = 2000  # characters
KEPT_LINES = 400  # of all processes, and of each one


class JournalWriter:
    """Writes the journal of a live folder."""

    def __init__(self, folder: Path) -> None:
        """Begin it."""
        self._stream: RawIOBase = (folder / FILE).open("ab", buffering=0)
        self._size = 0
        self._unwritten = b""  # where the disk is full

    def close(self) -> None:
        """End it."""
        self._flush()
        self._stream.close()

    def started(self, name: str, pid: int, node: str | None, role: str) -> None:
        """Note that a process was started."""
        self._write("started", name, pid, node, role)

    def printed(self, name: str, lines: list[bytes]) -> None:
        """Note lines that a process has printed."""
        if self._size < LARGEST:
            for line in lines:
                self._write("line", name, line.decode(errors="replace")[:LONGEST_LINE])

    def ended(self, name: str, code: int, *, is_wanted: bool) -> None:
        """Note the end of a process; the code of a signal is minus its number."""
        self._write("ended", name, code, is_wanted)

    def left_out(self, what: str, why: str) -> None:
        """Note what does not run here."""
        self._write("left_out", what, why)

    def _write(self, *values: object) -> None:
        data = json.dumps(values).encode() + b"\n"
        self._unwritten += data
        self._flush()
        # Of what was printed, a line is left out as a whole; who starts and ends is written later.
        if values[0] == "line" and len(self._unwritten) >= len(data):
            self._unwritten = self._unwritten[: -len(data)]

    def _flush(self) -> None:
        with suppress(OSError):  # a full disk ends no robot
            while self._unwritten:
                written = self._stream.write(self._unwritten) or 0
                self._unwritten = self._unwritten[written:]
                self._size += written


@dataclass(kw_only=True)
class KnownProcess:
    """A process of a live run, as its journal has it."""

    name: str  # NAME-NUMBER, as launch calls it
    pid: int
    node: str | None  # its full name, if the launch file gives it one
    role: str
    code: int | None = None  # None: it runs; minus the number of the signal that has ended it
    is_wanted: bool = False  # it was asked to end
    lines: deque[str] = field(default_factory=lambda: deque(maxlen=KEPT_LINES))  # the last ones

    @property
    def has_failed(self) -> bool:
        """Whether it has ended by itself, with an error."""
        return self.code not in {None, 0} and not self.is_wanted


class Journal:
    """Reads a journal while it is written.

    Attributes:
        processes: By name; of one that was started again the last one.
        lines: The last ones of all, "[NAME] LINE".
        important: Those of the user's programs, and what others warn of or fail with.
        left_out: What does not run here, with the reason.
    """

    def __init__(self, folder: Path) -> None:
        self.processes: dict[str, KnownProcess] = {}
        self.lines: deque[str] = deque(maxlen=KEPT_LINES)
        self.important: deque[str] = deque(
            maxlen=KEPT_LINES
        )  # others would push them out of `lines`
        self.left_out: dict[str, str] = {}
        self.failed: list[KnownProcess] = []
        self._path = folder / FILE
        self._offset = 0
        self._rest = b""

    def read(self) -> None:
        """Take in what has happened since."""
        try:
            with self._path.open("rb") as stream:
                stream.seek(self._offset)
                data = stream.read()
        except FileNotFoundError:
            return
        self._offset += len(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            word, *values = json.loads(line)
            getattr(self, f"_{word}")(*values)

    def _started(self, name: str, pid: int, node: str | None, role: str) -> None:
        self.processes[name] = KnownProcess(name=name, pid=pid, node=node, role=role)

    def _line(self, name: str, text: str) -> None:
        line = f"[{name}] {text}"
        self.lines.append(line)
        process = self.processes.get(name)
        if process is not None:
            process.lines.append(text)
        is_of_user = name != LAUNCH if process is None else process.role == OTHER
        if is_of_user or not _USUAL.search(text):
            self.important.append(line)

    def _ended(self, name: str, code: int, is_wanted: Any) -> None:
        process = self.processes.get(name)
        if process is None:
            return
        process.code, process.is_wanted = code, is_wanted
        if process.has_failed:
            self.failed.append(process)

    def _left_out(self, what: str, why: str) -> None:
        self.left_out[what] = why


FAILED_FILE = "failed.json"  # in the live folder: a list of `FailedProgram`


@dataclass(frozen=True, kw_only=True)
class FailedProgram:
    """What is known of one."""

    name: str  # as the launch file calls it
    place: str | None = None  # in its source, where that was reported: "line 2 of "
    "src/rover/driver.py"
    is_built: bool = True  # what is corrected there has to be installed
    missing_module: str | None = None  # whose absence has ended it
    is_of_user: bool = True  # it is none of ROS, and none of wsgen


class Failures:
    """Notes them while the run goes on.

    Args:
        folder: That of the run.
    """

    def __init__(self, folder: Path) -> None:
        self._file = folder / FAILED_FILE
        self._programs: dict[str, FailedProgram] = {}  # by the name of the process

    def add(self, process: str, program: FailedProgram) -> None:
        """Note one."""
        self._programs[process] = program
        self._write()

    def remove(self, process: str) -> None:
        """Forget one that was started again, and has ended well."""
        if self._programs.pop(process, None) is not None:
            self._write()

    def _write(self) -> None:
        with suppress(OSError):  # a hint depends on it, no more
            self._file.write_text(encode([*self._programs.values()]), encoding="utf-8")


def read_failures(folder: Path) -> tuple[FailedProgram, ...]:
    """Those of the run of a folder."""
    try:
        text = (folder / FAILED_FILE).read_text(encoding="utf-8")
        return decode(json.loads(text), tuple[FailedProgram, ...])
    except (OSError, ValueError):  # none, or on a full disk
        return ()

"""What a live run takes of the machine: a ROS domain, shared memory, CPU time.

Fast DDS keeps its queues in files of /dev/shm: a segment of each process, one for each port, a
semaphore for each of these, and locks (`_el`, `_sl`) that say who uses them. It removes what is its
own when a process ends by itself; what is killed leaves it there.

A simulator without brakes would leave nodes behind that get too little CPU time. So whoever has
simulated time pass waits until nodes have dealt with what has come: until all their threads sleep.
"""

from __future__ import annotations

import fcntl
import os
import socket
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotReadableError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping


# Up to 101, all ports of a domain are below those that Linux gives to programs that ask for any.
# People choose low ones.
DOMAINS = range(101, 0, -1)
FIRST_PORT, PORTS = 7400, 250  # of domain 0; of each domain (DDSI-RTPS 2.2, 9.6.1.1)
LOCK = "\0wsgen-ros-domain-{}"  # a name of a socket that is no file; it is free when nobody has it
UDP = (Path("/proc/net/udp"), Path("/proc/net/udp6"))


class Domain(NamedTuple):
    """A domain that is taken."""

    number: int
    lock: int  # a descriptor; the domain is taken as long as a process has it open


@contextmanager
def take_domain() -> Iterator[Domain]:
    """Take a domain; other runs of wsgen on this machine, also of other users, take others.

    Those whose ports somebody uses are left out: ROS programs that do not know of the lock.

    Raises:
        NotReadableError: All are taken.
    """
    used = _used_ports()
    for number in DOMAINS:
        first = FIRST_PORT + PORTS * number
        if not used.isdisjoint(range(first, first + PORTS)):
            continue
        lock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            lock.bind(LOCK.format(number))
        except OSError:  # somebody has it
            lock.close()
            continue
        with lock:
            yield Domain(number, lock.fileno())
        return
    raise NotReadableError(
        f"All {len(DOMAINS)} ROS domains of this machine are in use.",
        hint="End ROS programs that are not needed, or run fewer tests at a time.",
    )


def _used_ports() -> set[int]:
    """The UDP ports that some process has."""
    ports = set()
    for file in UDP:
        with suppress(OSError):
            for line in file.read_text(encoding="ascii").splitlines()[1:]:
                ports.add(int(line.split()[1].rpartition(":")[2], 16))
    return ports


SHARED_MEMORY = Path("/dev/shm")  # noqa: S108  where the system has it
SEGMENTS = ("fastdds_", "fastrtps_")  # as newer and older releases name them
SEMAPHORE = "sem."
LOCKS = ("_el", "_sl")


def remove_left_behind(since: float, folder: Path = SHARED_MEMORY) -> None:
    """Remove the files of Fast DDS that are newer than `since`, and that no process uses.

    Args:
        since: Seconds since the epoch; others may have left behind what is older.
        folder: Where shared memory is.
    """
    found = [path for path in _files(folder) if _is_newer(path, since)]
    if not found:
        return
    used = _used_segments(folder)
    for path in found:
        if _segment(path.name) not in used and not _is_locked(folder, _segment(path.name)):
            with suppress(OSError):
                path.unlink()


def _files(folder: Path) -> list[Path]:
    with suppress(OSError):
        return [
            path
            for path in folder.iterdir()
            if path.name.removeprefix(SEMAPHORE).startswith(SEGMENTS)
        ]
    return []


def _is_newer(path: Path, since: float) -> bool:
    try:
        status = path.stat()
    except OSError:
        return False
    return status.st_uid == os.getuid() and status.st_mtime >= since


def _segment(name: str) -> str:
    """The segment that a file belongs to."""
    name = name.removeprefix(SEMAPHORE).removesuffix("_mutex")
    for lock in LOCKS:
        name = name.removesuffix(lock)
    return name


def _is_locked(folder: Path, segment: str) -> bool:
    """Whether a process of another container, which this one does not see, uses a segment."""
    for lock in LOCKS:
        try:
            descriptor = os.open(folder / f"{segment}{lock}", os.O_RDWR)
        except FileNotFoundError:
            continue
        except PermissionError:  # it is of another user, who may use it
            return True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return True
        finally:
            os.close(descriptor)
    return False


def _used_segments(folder: Path) -> set[str]:
    """The segments that processes have in their memory, or whose files they have open."""
    used: set[str] = set()
    start = f"{folder}/"
    for process in Path("/proc").iterdir():
        if not process.name.isdecimal():
            continue
        # What is opened, mapped and closed meanwhile is in one of them in this order.
        with suppress(OSError):
            for descriptor in (process / "fd").iterdir():
                with suppress(OSError):
                    target = str(descriptor.readlink())
                    if target.startswith(start):
                        used.add(_segment(target.removeprefix(start)))
        with suppress(OSError):
            for line in (process / "maps").read_text(encoding="utf-8", errors="replace").split():
                if line.startswith(start):
                    used.add(_segment(line.removeprefix(start)))
    return used


LONGEST = 0.2  # s of CPU time, that a process is waited for at a time
LONGEST_WAIT = 2.0  # s of the clock, the same where others have the cores
BETWEEN = 0.0005  # s, between two looks; a thread that wakes another one may sleep meanwhile
LOOKS = 2  # in a row, in which all must sleep
# s of CPU time that a process may take without being seen asleep; then it is one that never sleeps.
MOST = 4.0
CLOCK_SHARE = LONGEST / LONGEST_WAIT  # what a second of waiting counts where it gets no CPU time
IDLE = 0.2  # of a core; a process that imports modules takes more
AT_WORK = (b"R", b"D")  # it computes, or waits for a core or a disk
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")


class Activity:
    """Waits for processes; one that never sleeps is waited for no longer."""

    def __init__(self) -> None:
        self._sleepless: dict[int, float] = {}  # by pid: s of CPU time since it was seen asleep

    def wait_until_idle(self, pids: Iterable[int], with_others: int | None = None) -> None:
        """Wait until all threads of processes sleep, or have had `LONGEST` of CPU time.

        What the clock says would not do: on a busy machine a process waits longer for a core than
        it works.

        Args:
            pids: The processes.
            with_others: The process whose main thread does not count.
        """
        watched = [pid for pid in pids if not self._is_sleepless(pid)]
        begun, looks = time.monotonic(), 0
        before: dict[int, float] = {}  # their CPU time when they were found at work
        busy: list[int] = []
        while looks < LOOKS:
            busy = [pid for pid in watched if is_at_work(pid)]
            waits_for = busy
            if not busy and with_others is not None and is_at_work(with_others, with_main=False):
                waits_for = [with_others]
            for pid in waits_for:
                before.setdefault(pid, cpu_seconds(pid) or 0.0)
            looks = 0 if waits_for else looks + 1
            waited = time.monotonic() - begun
            if waited >= LONGEST_WAIT or (
                waited >= LONGEST and all(_cpu_used(pid, before) >= LONGEST for pid in waits_for)
            ):
                break
            time.sleep(BETWEEN)
        waited = time.monotonic() - begun
        for pid in watched:
            if pid in busy:
                used = max(_cpu_used(pid, before), CLOCK_SHARE * waited)
                self._sleepless[pid] = self._sleepless.get(pid, 0.0) + used
            else:
                self._sleepless[pid] = 0.0

    def _is_sleepless(self, pid: int) -> bool:
        """Whether a process has worked for long, and does so still.

        One that has imported its modules sleeps again.
        """
        return self._sleepless.get(pid, 0.0) >= MOST and is_at_work(pid)


class CpuTimes:
    """Which processes take little CPU time."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[float, float]] = {}  # by pid: the clock, and CPU time, s

    def idle(self, pids: Iterable[int]) -> set[int]:
        """Those of the processes that have taken little since the last call."""
        idle = set()
        for pid in pids:
            used, now = cpu_seconds(pid), time.monotonic()
            if used is None:
                continue
            before = self._known.get(pid)
            if before is not None and used - before[1] < IDLE * (now - before[0]):
                idle.add(pid)
            self._known[pid] = (now, used)
        return idle


def _cpu_used(pid: int, before: Mapping[int, float]) -> float:
    """The CPU time of a process since then, s; enough of it for one that has ended."""
    now = cpu_seconds(pid)
    return LONGEST if now is None else now - before[pid]


def is_at_work(pid: int, *, with_main: bool = True) -> bool:
    """Whether a thread of a process computes or waits for a core; not of one that has ended."""
    folder = f"/proc/{pid}/task"
    with suppress(OSError):
        for thread in os.listdir(folder):  # noqa: PTH208  texts cost half as much
            if not with_main and thread == str(pid):
                continue
            with suppress(OSError), open(f"{folder}/{thread}/stat", "rb") as stream:  # noqa: PTH123
                if stream.read(256).rpartition(b") ")[2][:1] in AT_WORK:
                    return True
    return False


def cpu_seconds(pid: int) -> float | None:
    """The CPU time that a process has taken, s; None where it has ended."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as stream:  # noqa: PTH123  as above
            values = stream.read().rpartition(b") ")[2].split()
    except OSError:
        return None
    return (int(values[11]) + int(values[12])) / CLOCK_TICKS

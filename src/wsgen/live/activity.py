"""Which processes are at work, as Linux sees their threads.

A simulator without brakes would leave nodes behind that get too little CPU time. So whoever has
simulated time pass waits until nodes have dealt with what has come: until all their threads sleep.
"""

from __future__ import annotations

import os
import time
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

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
                waited >= LONGEST and all(_used(pid, before) >= LONGEST for pid in waits_for)
            ):
                break
            time.sleep(BETWEEN)
        waited = time.monotonic() - begun
        for pid in watched:
            if pid in busy:
                used = max(_used(pid, before), CLOCK_SHARE * waited)
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


def _used(pid: int, before: Mapping[int, float]) -> float:
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

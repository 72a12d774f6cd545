"""The process between wsgen and a child: it limits and ends all that the child starts.

A child may start processes that leave its group and its session. Linux hands what loses its parent
to the guard, so that it finds all of them: those whose CPU time counts, and those to end. A child
that kills its parent kills its guard, not wsgen.

Elsewhere than on Linux there is no guard: the system limits the CPU time of each process by
itself, and a process that leaves the child's group outlives it.
"""

from __future__ import annotations

import os
import resource
import signal
import time
from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn

from wsgen.isolation.parent_death import hold

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator


PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
FIRST_FIELD = 3  # of /proc/PID/stat behind the name of the program
PARENT, FIRST_TIME, LAST_TIME = 4, 14, 17  # fields of /proc/PID/stat, counted from 1
SHORTEST_WAIT = 0.05  # s between two looks at the CPU time
SECONDS_TO_END = 5.0  # wall-clock, for processes that have SIGKILL coming
WATCHED = (signal.SIGCHLD, signal.SIGTERM)


def adopt_orphans() -> None:
    """Become the parent of each descendant that loses its own."""
    try:
        import ctypes  # noqa: PLC0415  an interpreter may have been built without
    except ImportError:  # what leaves the child's group then escapes
        return
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def stand_guard(parent_death_pipe: int, cpu_seconds: float) -> None:
    """Fork; return in the child, the leader of a session, and guard it in this process.

    When the child ends, the guard ends what the child has started, then itself in the same way.
    It does so, too, when the parent-death pipe or a SIGTERM says that nobody waits, and, by
    SIGXCPU, when child and descendants have used that much CPU time.
    """
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_BLOCK, WATCHED)
    hold(parent_death_pipe, signal.SIGTERM)
    adopt_orphans()
    own_parent_death_pipe, own_end = os.pipe()
    pid = os.fork()
    if pid != 0:
        _end_like(_watch(pid, cpu_seconds))
    os.setsid()
    os.close(own_end)
    os.close(parent_death_pipe)
    hold(own_parent_death_pipe, signal.SIGKILL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, WATCHED)


def end_guard(pid: int) -> None:
    """Have a guard end its child and itself, even if it was stopped."""
    for number in (signal.SIGTERM, signal.SIGCONT):
        with suppress(ProcessLookupError):
            os.kill(pid, number)


def kill_children(spared: Collection[int] = ()) -> None:
    """Send SIGKILL to all children of this process but these."""
    own_pid = os.getpid()
    for pid, fields in _read_processes():
        if int(fields[PARENT - FIRST_FIELD]) == own_pid and pid not in spared:
            with suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)


def _watch(pid: int, cpu_seconds: float) -> int:
    """Wait until the child ends or has to; end all; gives its exit code, negative for a signal."""
    code, next_look = None, 0.0
    while code is None and not _reap_orphans(pid):
        # What wakes this process in between must not put the look off.
        event = signal.sigtimedwait(WATCHED, max(0.0, next_look - time.monotonic()))
        if event is not None and event.si_signo == signal.SIGTERM:
            code = -signal.SIGTERM
        elif time.monotonic() >= next_look:
            left = cpu_seconds - _descendants_cpu_seconds()
            code = -signal.SIGXCPU if left < 0.0 else None
            # As long as this they cannot use up what is left on all cores.
            wait = max(SHORTEST_WAIT, left / (os.cpu_count() or 1))
            next_look = time.monotonic() + wait
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)
    status = _end_children(pid)
    return os.waitstatus_to_exitcode(status) if code is None else code


def _reap_orphans(pid: int) -> bool:
    """Reap what has ended, but for the child, whose status is still wanted; whether that has."""
    while ended := os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if ended.si_pid == pid:
            return True
        os.waitpid(ended.si_pid, 0)
    return False


def _end_children(pid: int) -> int:
    """End and reap all children, also those that come from others; gives the status of this one."""
    end = time.monotonic() + SECONDS_TO_END  # for what this user may not kill
    status_of_child = 0
    while time.monotonic() < end:
        try:
            reaped, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            break
        if reaped == pid:
            status_of_child = status
        elif reaped == 0:
            kill_children()
            signal.sigtimedwait({signal.SIGCHLD}, SHORTEST_WAIT)
    return status_of_child


def _end_like(code: int) -> NoReturn:
    """End this process as another one has ended."""
    if code < 0:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, WATCHED)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    os._exit(code)


def _descendants_cpu_seconds() -> float:
    """The CPU time of all processes below this one, and of those that have been waited for."""
    family = {os.getpid()}
    processes = dict(_read_processes())
    ticks, grown = 0, True
    while grown:
        grown = False
        for pid in [
            pid for pid, fields in processes.items() if int(fields[PARENT - FIRST_FIELD]) in family
        ]:
            times = processes.pop(pid)[FIRST_TIME - FIRST_FIELD : LAST_TIME + 1 - FIRST_FIELD]
            ticks += sum(map(int, times))
            family.add(pid)
            grown = True
    reaped = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ticks / os.sysconf("SC_CLK_TCK") + reaped.ru_utime + reaped.ru_stime


def _read_processes() -> Iterator[tuple[int, list[str]]]:
    """The number of every process and what /proc/PID/stat says behind its name."""
    for name in os.listdir("/proc"):  # noqa: PTH208  many
        if name.isdecimal():
            with suppress(OSError), open(f"/proc/{name}/stat", "rb") as stream:  # noqa: PTH123
                yield int(name), stream.read().rpartition(b")")[2].decode().split()

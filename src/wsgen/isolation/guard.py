"""The guard, a process between wsgen and a child: it limits and ends all that the child starts.

A child may start processes that leave its group and its session. Linux makes the guard the parent
of every process that loses its own, so the guard finds all of them, counts their CPU time and ends
them. A child that kills its parent kills its guard, not wsgen.

Other systems than Linux have no guard, see `wsgen.isolation.child`: a process that leaves the
child's group outlives the child.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import time
from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn

from wsgen.errors import EXIT_STOPPED
from wsgen.isolation.system import end_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator


PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
FIRST_FIELD = 3  # of /proc/PID/stat behind the name of the program
PARENT, FIRST_TIME, LAST_TIME = 4, 14, 17  # fields of /proc/PID/stat, counted from 1
SHORTEST_WAIT = 0.05  # s between two checks of the CPU time
SECONDS_STOPPED = 1.0  # wall-clock, that a child may be stopped: nobody is there to continue it
SECONDS_TO_END = 5.0  # wall-clock, for processes after SIGKILL
WATCHED = (signal.SIGCHLD, signal.SIGTERM)


def adopt_orphans() -> None:
    """Become the parent of each descendant that loses its own."""
    try:
        import ctypes  # noqa: PLC0415  an interpreter may have been built without
    except ImportError:  # processes that leave the child's group then escape
        return
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def stand_guard(
    parent_death_pipe: int, cpu_seconds: float, at_end: Callable[[], None] | None = None
) -> None:
    """Fork; return in the child, the leader of a session, and guard it in this process.

    When the child ends, the guard ends all processes that the child started, then itself with the
    same status. It also ends them when its parent ends or sends SIGTERM, and, with SIGXCPU, when
    they exceed the CPU time. `at_end` is called in the guard when all have ended.
    """
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_BLOCK, WATCHED)
    end_with_parent(parent_death_pipe, signal.SIGTERM)
    adopt_orphans()
    own_parent_death_pipe, own_end = os.pipe()
    pid = os.fork()
    if pid != 0:
        code = _watch(pid, cpu_seconds)
        if at_end is not None:
            with suppress(Exception):  # the status of the child is more important
                at_end()
        _end_like(code)
    os.setsid()
    os.close(own_end)
    os.close(parent_death_pipe)
    end_with_parent(own_parent_death_pipe, signal.SIGKILL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, WATCHED)


def end_guard(pid: int) -> None:
    """Make a guard end its child and itself, even if it was stopped."""
    for number in (signal.SIGTERM, signal.SIGCONT):
        with suppress(ProcessLookupError):
            os.kill(pid, number)


def kill_children(spared: Collection[int] = ()) -> None:
    """Send SIGKILL to all children of this process except `spared`."""
    own_pid = os.getpid()
    for pid, fields in _read_processes():
        if int(fields[PARENT - FIRST_FIELD]) == own_pid and pid not in spared:
            with suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)


def _watch(pid: int, cpu_seconds: float) -> int:
    """Wait for the child's end or a limit; end all; return its exit code, or minus the signal."""
    code, next_check = None, time.monotonic() + _least_wall_clock(cpu_seconds)
    while code is None and not _reap_orphans(pid):
        # Other signals must not delay the next check.
        event = _wait(next_check - time.monotonic())
        if event is not None and event.si_signo == signal.SIGTERM:
            code = -signal.SIGTERM
        elif math.isfinite(cpu_seconds) and _is_stopped(pid):
            is_notified = signal.sigtimedwait({signal.SIGTERM}, SECONDS_STOPPED) is not None
            code = -signal.SIGTERM if is_notified else -signal.SIGSTOP if _is_stopped(pid) else None
        elif time.monotonic() >= next_check:
            left = cpu_seconds - _descendants_cpu_seconds()
            code = -signal.SIGXCPU if left < 0.0 else None
            next_check = time.monotonic() + _least_wall_clock(left)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)
    status = _end_children(pid)
    return os.waitstatus_to_exitcode(status) if code is None else code


def _wait(seconds: float) -> signal.struct_siginfo | None:
    """Wait for a signal; None where none came. Without end where the CPU time is not limited."""
    if math.isinf(seconds):
        return signal.sigwaitinfo(WATCHED)
    return signal.sigtimedwait(WATCHED, max(0.0, seconds))


def _least_wall_clock(cpu_seconds: float) -> float:
    """For how long nothing can use up so much CPU time, even on all cores; s, wall-clock."""
    return max(SHORTEST_WAIT, cpu_seconds / (os.cpu_count() or 1))


def _is_stopped(pid: int) -> bool:
    """Whether a signal has stopped the child, or the child itself."""
    try:
        return os.waitid(os.P_PID, pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None
    except ChildProcessError:  # it has ended, and is yet to be reaped
        return False


def _reap_orphans(pid: int) -> bool:
    """Reap ended processes except the child, whose status is needed later; whether it has ended."""
    while ended := os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if ended.si_pid == pid:
            return True
        os.waitpid(ended.si_pid, 0)
    return False


def _end_children(pid: int) -> int:
    """End and reap all children, also adopted ones; return the status of `pid`."""
    end = time.monotonic() + SECONDS_TO_END  # some may be processes that this user may not kill
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
    """End this process with the status of another one."""
    if code == -signal.SIGSTOP:  # which would not end it
        code = EXIT_STOPPED
    if code < 0:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, WATCHED)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    os._exit(code)


def _descendants_cpu_seconds() -> float:
    """Add up the CPU time of all descendants of this process, reaped ones included."""
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
    """Yield the id of every process, and the fields of /proc/PID/stat after its name."""
    for name in os.listdir("/proc"):  # noqa: PTH208  many
        if name.isdecimal():
            with suppress(OSError), open(f"/proc/{name}/stat", "rb") as stream:  # noqa: PTH123
                yield int(name), stream.read().rpartition(b")")[2].decode().split()

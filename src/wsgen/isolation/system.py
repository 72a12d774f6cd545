"""What the operating system offers to child processes; tests take it away here.

The parent-death pipe ends a child process when its parent ends. Whatever ends the parent, also
kill -9, the system closes its end of the pipe. Linux then sends a signal to the child's whole
process group, however busy it is. Elsewhere a thread of the child notices. A child that is started
gets the pipe as its standard input, as every system allows.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Iterator


SHARED_MEMORY = "/dev/shm"  # noqa: S108  folders in it are made as any temporary ones
ROOM_IN_MEMORY, LINKS_IN_MEMORY = 256 * 2**20, 100_000  # bytes and files that must be free
CHOSEN = frozenset(("TMPDIR", "TEMP", "TMP"))  # variables by which users choose another folder


def has_guards() -> bool:
    """Whether children are forked, and have guards (`wsgen.isolation.guard`): only on Linux."""
    return sys.platform == "linux"


def can_fork() -> bool:
    """Whether this process can be forked: on Linux, while it has one thread."""
    # A lock that another thread holds during the fork would never be released in the child.
    return has_guards() and len(os.listdir("/proc/self/task")) == 1  # noqa: PTH208  quicker


def can_inherit() -> bool:
    """Whether a child gets open files of its parent: not on Windows."""
    return os.name == "posix"


def memory_folder() -> str | None:
    """A folder whose files are in memory, on Linux; None where files are to be elsewhere.

    It has room, and programs in it can be run.
    """
    if not has_guards() or not CHOSEN.isdisjoint(os.environ):
        return None
    try:
        found = os.statvfs(SHARED_MEMORY)
    except OSError:
        return None
    has_room = found.f_bavail * found.f_frsize > ROOM_IN_MEMORY
    has_files = not found.f_files or found.f_favail > LINKS_IN_MEMORY
    is_usable = not found.f_flag & (os.ST_NOEXEC | os.ST_RDONLY)
    is_writable = os.access(SHARED_MEMORY, os.W_OK | os.X_OK)
    return SHARED_MEMORY if has_room and has_files and is_usable and is_writable else None


def end_tree(pid: int, number: int | None = None) -> None:
    """End a process that leads its group, and what it has started.

    Args:
        pid: The id of the process.
        number: The signal to send; None for SIGKILL. Windows, which has no such signals, ends the
            process at once, and what it has started only if the process still runs.
    """
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL if number is None else number)
    else:
        import subprocess  # noqa: PLC0415  children on Linux do without

        with suppress(OSError):
            command = ["taskkill", "/F", "/T", "/PID", str(pid)]
            subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        with suppress(OSError):  # it has ended
            os.kill(pid, signal.SIGTERM)  # Windows ends it, whatever it does


@contextmanager
def open_parent_death_pipe() -> Iterator[int]:
    """Open a pipe; yield the descriptor to pass to the child.

    Leaving the context closes both ends here: a child that still runs gets its signal.
    """
    for_child, ours = os.pipe()
    try:
        yield for_child
    finally:
        os.close(for_child)
        os.close(ours)


def take_parent_death_pipe() -> int:
    """Return the pipe that is the standard input of this process; that becomes empty."""
    parent_death_pipe = os.dup(0)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    return parent_death_pipe


def end_with_parent(parent_death_pipe: int, number: int) -> None:
    """Have this process's group get the signal `number` when the parent ends.

    The child, the leader of its group, calls it.
    """
    if sys.platform != "linux":
        end_with_parent_by_thread(parent_death_pipe, number)
        return
    import fcntl  # noqa: PLC0415  Windows has none

    fcntl.fcntl(parent_death_pipe, fcntl.F_SETSIG, number)
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
    try:
        has_ended = os.read(parent_death_pipe, 1) == b""  # before the lines above
    except BlockingIOError:
        return
    if has_ended:
        end_tree(0, number)


def end_with_parent_by_thread(parent_death_pipe: int, number: int | None = None) -> None:
    """Do the same on every system, if the child lets its threads run; see `end_tree`."""

    def wait() -> None:
        os.read(parent_death_pipe, 1)  # nobody writes
        end_tree(os.getpid(), number)

    _thread.start_new_thread(wait, ())


def require_linux(what: str, instead: str) -> None:
    """Refuse what runs nodes where their processes could not be ended for certain.

    Args:
        what: Its name, with which the message begins.
        instead: What can be done elsewhere, a sentence.

    Raises:
        NotFoundError: This is not Linux.
    """
    if not has_guards():
        raise NotFoundError(
            f"{what} needs Linux: processes are ended with all that they have started by what "
            "Linux alone has.",
            hint=f"{instead} On Windows use the Windows Subsystem for Linux.",
        )

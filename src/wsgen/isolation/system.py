"""What the operating system offers to child processes; tests take it away here."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

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

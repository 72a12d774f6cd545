"""What the operating system offers to child processes; tests take it away here."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress


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

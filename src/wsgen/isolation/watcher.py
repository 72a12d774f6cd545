"""The limits of a child that has no guard: a thread of the child checks them.

What the child starts counts when the child has waited for it. Code that holds the lock of the
interpreter holds up the thread, too: it ends at the limit of CPU time of the system (macOS), or at
that of wall-clock time.
"""

from __future__ import annotations

import _thread
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

try:
    import resource
except ImportError:  # on Windows
    resource = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable


SECONDS_BETWEEN_CHECKS = 0.05
RESIDENT_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes, of `ru_maxrss`


def watch(request: dict[str, Any], end: Callable[[str], None]) -> None:
    """Start a thread that calls `end` with the cause when the child exceeds a limit."""

    def check() -> None:
        while (cause := _exceeded(request)) is None:
            time.sleep(SECONDS_BETWEEN_CHECKS)
        end(cause)

    _thread.start_new_thread(check, ())


def _exceeded(request: dict[str, Any]) -> str | None:
    """Return the cause of a `Died` if this process exceeds a limit."""
    if sum(os.times()[:4]) > request["cpu_seconds"]:
        return "cpu time"
    if Path(request["scratch"], "output").stat().st_size > request["output"]:
        return "output"
    if resource is not None:
        resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * RESIDENT_UNIT
        return "memory" if resident > request["memory"] else None
    return None

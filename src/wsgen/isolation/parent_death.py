"""The parent-death pipe, which ends a child process when its parent ends.

Whatever ends the parent, also kill -9, the system closes its end of the pipe. Linux then sends a
signal to the child's whole process group, however busy it is.
"""

from __future__ import annotations

import fcntl
import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


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


def end_with_parent(parent_death_pipe: int, number: int) -> None:
    """Have this process's group get the signal `number` when the parent ends.

    The child, the leader of its group, calls it. On other systems than Linux it does nothing: there
    only the parent ends the child.
    """
    if sys.platform != "linux":
        return
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETSIG, number)
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
    try:
        has_ended = os.read(parent_death_pipe, 1) == b""  # before the lines above
    except BlockingIOError:
        return
    if has_ended:
        os.killpg(0, number)

"""The parent-death pipe, which ends a child process when its parent ends.

Whatever ends the parent, also kill -9, the system closes its end of the pipe. Linux then sends a
signal to the child's whole process group, however busy it is. Elsewhere a thread of the child
notices. A child that is started gets the pipe as its standard input, as every system allows.
"""

from __future__ import annotations

import _thread
import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from wsgen.isolation.system import end_tree

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

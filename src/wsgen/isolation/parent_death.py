"""A pipe that ties a child process to its parent: when the parent is gone, so is the child.

Whatever ends the parent, kill -9 included, the system closes its end of the pipe. Linux then sends
a signal to the whole group of processes that the child has asked it for, however busy they are.
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
    """Open a pipe; yield the end for the child, as a descriptor to pass on to it.

    At the exit both ends are closed here: a child that is still there gets its signal.
    """
    for_child, ours = os.pipe()
    try:
        yield for_child
    finally:
        os.close(for_child)
        os.close(ours)


def hold(parent_death_pipe: int, number: int) -> None:
    """In the child, the leader of its group: have the group get this signal when the parent ends.

    Elsewhere than on Linux it does nothing; there the parent can end the child and no one else.
    """
    if sys.platform != "linux":
        return
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETSIG, number)
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(parent_death_pipe, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
    try:
        is_alone = os.read(parent_death_pipe, 1) == b""  # the parent ended before the lines above
    except BlockingIOError:
        return
    if is_alone:
        os.killpg(0, number)

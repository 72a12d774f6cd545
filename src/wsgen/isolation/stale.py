"""Remove scratch folders whose process was killed before it could remove them.

A process holds the lock of each of its folders; the system releases it when the process ends,
however it ends. A folder that nobody holds is nobody's any more.
"""

from __future__ import annotations

import os
import shutil
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator


PREFIX = "wsgen-held-"  # of names; folders of other programs and versions have others
SECONDS_TO_HOLD = 60.0  # wall-clock, from when a folder is made until it is held
MOST_REMOVED = 50  # at a time


@contextmanager
def held(folder: str) -> Iterator[None]:
    """Hold the lock of a folder; where its file system has none, nobody takes the folder away."""
    descriptor = _lock(folder)
    try:
        yield
    finally:
        if descriptor is not None:
            os.close(descriptor)


def is_held(folder: str) -> bool:
    """Whether a process holds the lock of a folder, which has been held before."""
    descriptor = _lock(folder)
    if descriptor is not None:
        os.close(descriptor)
    return descriptor is None


def remove_stale(place: str) -> None:
    """Remove folders of this user that lie in a folder and that nobody holds."""
    if fcntl is None:
        return
    with suppress(OSError), os.scandir(place) as entries:
        stale = [entry.path for entry in entries if _may_be_stale(entry)]
        removed = 0
        for path in stale:
            descriptor = _lock(path)
            if descriptor is not None:
                shutil.rmtree(path, ignore_errors=True)
                os.close(descriptor)
                removed += 1
            if removed == MOST_REMOVED:
                break


def _may_be_stale(entry: os.DirEntry[str]) -> bool:
    if not entry.name.startswith(PREFIX):
        return False
    try:
        found = entry.stat(follow_symlinks=False)
    except OSError:
        return False
    return (
        entry.is_dir(follow_symlinks=False)
        and found.st_uid == os.getuid()
        and time.time() - found.st_mtime > SECONDS_TO_HOLD
    )


def _lock(folder: str) -> int | None:
    """A descriptor that holds the lock of a folder; None if another one does, or it has none."""
    if fcntl is None:
        return None
    descriptor = None
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        if descriptor is not None:
            os.close(descriptor)
        return None
    return descriptor

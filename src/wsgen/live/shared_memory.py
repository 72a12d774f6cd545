"""Remove the shared memory that killed processes have left behind.

Fast DDS keeps its queues in files of /dev/shm: a segment of each process, one for each port, a
semaphore for each of these, and locks (`_el`, `_sl`) that say who uses them. It removes what is its
own when a process ends by itself; what is killed leaves it there.
"""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress
from pathlib import Path

FOLDER = Path("/dev/shm")  # noqa: S108  where the system has it
SEGMENTS = ("fastdds_", "fastrtps_")  # as newer and older releases name them
SEMAPHORE = "sem."
LOCKS = ("_el", "_sl")


def remove_left_behind(since: float, folder: Path = FOLDER) -> None:
    """Remove the files of Fast DDS that are newer than `since`, and that no process uses.

    Args:
        since: Seconds since the epoch; others may have left behind what is older.
        folder: Where shared memory is.
    """
    found = [path for path in _files(folder) if _is_newer(path, since)]
    if not found:
        return
    used = _used(folder)
    for path in found:
        if _segment(path.name) not in used and not _is_locked(folder, _segment(path.name)):
            with suppress(OSError):
                path.unlink()


def _files(folder: Path) -> list[Path]:
    with suppress(OSError):
        return [
            path
            for path in folder.iterdir()
            if path.name.removeprefix(SEMAPHORE).startswith(SEGMENTS)
        ]
    return []


def _is_newer(path: Path, since: float) -> bool:
    try:
        status = path.stat()
    except OSError:
        return False
    return status.st_uid == os.getuid() and status.st_mtime >= since


def _segment(name: str) -> str:
    """The segment that a file belongs to."""
    name = name.removeprefix(SEMAPHORE).removesuffix("_mutex")
    for lock in LOCKS:
        name = name.removesuffix(lock)
    return name


def _is_locked(folder: Path, segment: str) -> bool:
    """Whether a process of another container, which this one does not see, uses a segment."""
    for lock in LOCKS:
        try:
            descriptor = os.open(folder / f"{segment}{lock}", os.O_RDWR)
        except FileNotFoundError:
            continue
        except PermissionError:  # it is of another user, who may use it
            return True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return True
        finally:
            os.close(descriptor)
    return False


def _used(folder: Path) -> set[str]:
    """The segments that processes have in their memory, or whose files they have open."""
    used: set[str] = set()
    start = f"{folder}/"
    for process in Path("/proc").iterdir():
        if not process.name.isdecimal():
            continue
        # What is opened, mapped and closed meanwhile is in one of them in this order.
        with suppress(OSError):
            for descriptor in (process / "fd").iterdir():
                with suppress(OSError):
                    target = str(descriptor.readlink())
                    if target.startswith(start):
                        used.add(_segment(target.removeprefix(start)))
        with suppress(OSError):
            for line in (process / "maps").read_text(encoding="utf-8", errors="replace").split():
                if line.startswith(start):
                    used.add(_segment(line.removeprefix(start)))
    return used

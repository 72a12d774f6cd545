"""The folder of the user's cache where ROS is, and the locks on what is in it."""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotReadableError
from wsgen.events import StepProgressed, post
from wsgen.text.files import explain_write_error

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.events import Listener

ELSEWHERE = "set XDG_CACHE_HOME to a folder that you may write to"  # on a full or read-only home
UNFINISHED = ".unfinished"  # at the end of the name of a folder that is being made


def cache_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder, as the XDG specification says where; it is created if it is missing.

    Raises:
        NotReadableError: it cannot be created, or somebody else could put libraries into it.
    """
    cache = Path(environment.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():  # the specification ignores it then, and so an empty one
        try:
            cache = Path.home() / ".cache"
        except RuntimeError:
            raise NotReadableError(
                "ROS cannot be kept: no home folder is known.",
                hint="Set XDG_CACHE_HOME to a folder for caches.",
            ) from None
    folder = cache / "wsgen" / "ros"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.stat()
    except OSError as error:
        raise explain_write_error(
            error, folder, what=f"the folder of ROS, {folder}", instead=ELSEWHERE
        ) from None
    if status.st_uid != os.geteuid() or status.st_mode & 0o022:
        raise NotReadableError(
            f"{folder} is not used: other users can write into it.",
            hint=f"Remove their access (chmod go-w {folder}), or set XDG_CACHE_HOME.",
        )
    return folder


@contextlib.contextmanager
def being_made(target: Path, listener: Listener, step: tuple[str, ...]) -> Iterator[Path | None]:
    """Lock a folder that is to be made, and yield one beside it that becomes it at the end.

    Yields None if the folder exists, or does after another process has made it. What an interrupted
    process left is removed.
    """
    if target.exists():
        yield None
        return
    try:
        with _locked(target.with_name(f"{target.name}.lock"), listener, step):
            if target.exists():
                yield None
                return
            unfinished = target.with_name(f"{target.name}{UNFINISHED}")
            shutil.rmtree(unfinished, ignore_errors=True)
            unfinished.mkdir(parents=True)
            try:
                yield unfinished
                unfinished.rename(target)
            finally:
                shutil.rmtree(unfinished, ignore_errors=True)
    except OSError as error:
        raise explain_write_error(
            error, target, what=f"the folder of ROS, {target}", instead=ELSEWHERE
        ) from None


@contextlib.contextmanager
def _locked(file: Path, listener: Listener, step: tuple[str, ...]) -> Iterator[None]:
    """Hold the lock; the system frees it when the process ends, however it ends."""
    if sys.platform == "win32":
        message = "wheels of ROS are for Linux; nothing is locked elsewhere"
        raise NotImplementedError(message)
    import fcntl  # noqa: PLC0415  Windows has none, and imports this module

    with file.open("ab") as opened:
        reported = False
        while True:
            try:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if not reported:
                    post(listener, StepProgressed(step=step, detail="another wsgen makes it"))
                    reported = True
                time.sleep(0.1)
        yield

"""Write a package: it is there whole, or not at all.

The files are written into a hidden folder next to the package's place, and one rename puts them
there. `rename` replaces no folder that has something in it, so that the second of two commands
with the same name fails. A hidden folder is not seen by colcon.

A command that is killed leaves its hidden folder behind. It held a lock on it, which the system
lets go of when the process is gone: the next command takes the lock of every such folder, and what
it gets it removes.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import shutil
from typing import TYPE_CHECKING

from wsgen.errors import NotReadableError, WouldOverwriteError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

UNFINISHED_PREFIX = ".wsgen-new-"


def write_package(tree: Mapping[str, str], folder: Path) -> None:
    """Write the files of `tree` (path with slashes -> text) into the new folder `folder`.

    Missing parents of `folder` are made, and removed again if nothing comes of it.

    Raises:
        WouldOverwriteError: something is at `folder`; nothing was changed.
        NotReadableError: the disk does not take the files; nothing is left of them.
    """
    refuse_existing(folder)
    made: list[Path] = []
    try:
        make_parents(folder.parent, made)
        remove_leftovers(folder.parent)
        with unfinished_folder(folder.parent) as unfinished:
            write_files(tree, unfinished / folder.name)
            _publish(unfinished / folder.name, folder)
    except BaseException as error:
        for parent in reversed(made):
            with contextlib.suppress(OSError):  # somebody else put something into it
                parent.rmdir()
        if isinstance(error, OSError):
            raise explain_failure(error, folder) from error
        raise


def refuse_existing(folder: Path) -> None:
    """Stop if there is anything at `folder`, a broken link included.

    Raises:
        WouldOverwriteError: there is; nothing was changed.
    """
    if os.path.lexists(folder):
        raise WouldOverwriteError(
            f"{folder} exists already; nothing was written.",
            hint="Take another name, or move the folder away first.",
        )


def make_parents(folder: Path, made: list[Path]) -> None:
    """Make a folder and those around it that are missing; appends to `made` what it made."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    for path in reversed(missing):
        with contextlib.suppress(FileExistsError):  # two commands at once
            path.mkdir()
            made.append(path)
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


@contextlib.contextmanager
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """A new hidden folder that this process has locked; it is gone at the end."""
    while True:
        folder = parent / f"{UNFINISHED_PREFIX}{os.getpid()}-{os.urandom(4).hex()}"
        folder.mkdir()
        with _lock(folder, wait=True):
            # Before the lock was taken another command could have taken it for a leftover.
            if not folder.exists():
                continue
            try:
                yield folder
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            return


def remove_leftovers(parent: Path) -> None:
    """Remove what commands that were killed have left in a folder."""
    for folder in parent.glob(f"{UNFINISHED_PREFIX}*"):
        with _lock(folder, wait=False) as locked:
            if locked:
                shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _lock(folder: Path, *, wait: bool) -> Iterator[bool]:
    """Whether this process has locked the folder; False also where nothing can be locked."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        yield False
        return
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except OSError:
            yield False
        else:
            yield True
    finally:
        os.close(descriptor)


def write_files(tree: Mapping[str, str], folder: Path) -> None:
    """Write the files of a tree into a new folder, and see them safely on the disk."""
    folder.mkdir()
    for name, text in tree.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
            stream.flush()
            # Some disks say only now that they are full; and after a power cut no file is empty.
            os.fsync(stream.fileno())


def _publish(unfinished: Path, folder: Path) -> None:
    refuse_existing(folder)
    try:
        # POSIX replaces only an empty folder, one that somebody made since the line above.
        unfinished.rename(folder)
    except OSError as error:
        if error.errno in {errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR, errno.EISDIR}:
            refuse_existing(folder)
        raise


def explain_failure(error: OSError, folder: Path) -> NotReadableError:
    """What keeps files from being written, and what to do about it."""
    hints = {
        errno.ENOSPC: "Make room on the disk, or give another --workspace.",
        errno.EDQUOT: "Make room in your quota, or give another --workspace.",
        errno.EROFS: "The disk is mounted read-only: give another --workspace.",
        errno.ENOTDIR: "A file is where a folder should be: give another --workspace.",
        errno.ENAMETOOLONG: "The path is too long: give a --workspace nearer to the top.",
    }
    place = error.filename or folder
    return NotReadableError(
        f"The package cannot be written: {error.strerror} ({place}). Nothing is left of it.",
        hint=hints.get(error.errno or 0, "Give a --workspace where you may write."),
    )

"""Write a package, or files of a workspace, atomically: all of them, or none.

A package is written into a hidden folder next to its place, and one rename puts it there. `rename`
does not replace a folder with content, so of two commands with the same name the second fails.
colcon does not see a hidden folder.

Files of a workspace are also written into a hidden folder first, and linked to their places from
there, which fails where something exists.

A killed command leaves its hidden folder behind. It held a lock on it, which the system released
when the process ended: the next command removes every such folder that it can lock. Windows locks
no folders, so it stays there.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
from collections.abc import Mapping
from typing import TYPE_CHECKING

from wsgen.errors import NotReadableError, WouldOverwriteError

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


UNFINISHED_PREFIX = ".wsgen-new-"
# Path with slashes -> a text, bytes, or the file that is copied.
PackageTree = Mapping[str, "str | bytes | Path"]


def write_package(tree: PackageTree, folder: Path) -> None:
    """Write the files of `tree` into the new folder `folder`.

    Missing parents of `folder` are created, and removed again if writing fails.

    Raises:
        WouldOverwriteError: `folder` exists; nothing was changed.
        NotReadableError: the files cannot be written; nothing is left of them.
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
            with contextlib.suppress(OSError):  # another process put something into it
                parent.rmdir()
        if isinstance(error, OSError):
            raise explain_failure(error, folder) from error
        raise


def refuse_existing(folder: Path) -> None:
    """Stop if anything exists at `folder`, also a broken link.

    Raises:
        WouldOverwriteError: something exists; nothing was changed.
    """
    if os.path.lexists(folder):
        raise WouldOverwriteError(
            f"{folder} already exists; nothing was written.",
            hint="Use another name, or move the folder away first.",
        )


def make_parents(folder: Path, made: list[Path]) -> None:
    """Create a folder and its missing parents; append to `made` what was created."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    for path in reversed(missing):
        with contextlib.suppress(FileExistsError):  # two commands at once
            path.mkdir()
            made.append(path)
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


@contextlib.contextmanager
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """Create a hidden folder that this process has locked; it is removed at the end."""
    while True:
        folder = parent / f"{UNFINISHED_PREFIX}{os.getpid()}-{os.urandom(4).hex()}"
        folder.mkdir()
        with _lock(folder, wait=True):
            # Before it was locked, another command may have removed it as a leftover.
            if not folder.exists():
                continue
            try:
                yield folder
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            return


def remove_leftovers(parent: Path) -> None:
    """Remove what killed commands have left in a folder."""
    for folder in parent.glob(f"{UNFINISHED_PREFIX}*"):
        with _lock(folder, wait=False) as locked:
            if locked:
                shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _lock(folder: Path, *, wait: bool) -> Iterator[bool]:
    """Lock the folder; yield False if it is locked already or cannot be locked."""
    if fcntl is None:
        yield False
        return
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


def write_files(tree: PackageTree, folder: Path) -> None:
    """Write the files of a tree into a new folder, and flush them to the disk."""
    folder.mkdir()
    for name, content in tree.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("xb") as stream:
            if isinstance(content, str | bytes):
                stream.write(content.encode() if isinstance(content, str) else content)
            else:
                with content.open("rb") as source:
                    shutil.copyfileobj(source, stream)
            stream.flush()
            # Some disks report only now that they are full; after a power cut no file is empty.
            os.fsync(stream.fileno())
        if isinstance(content, str) and content.startswith(
            "#!"
        ):  # a program, also where an installation links to it
            mode = file.stat().st_mode
            file.chmod(mode | (mode & 0o444) >> 2)  # who may read it may execute it


def _publish(unfinished: Path, folder: Path) -> None:
    refuse_existing(folder)
    try:
        # POSIX replaces only an empty folder, created since the line above.
        unfinished.rename(folder)
    except OSError as error:
        if error.errno in {errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR, errno.EISDIR}:
            refuse_existing(folder)
        raise


def explain_failure(error: OSError, folder: Path) -> NotReadableError:
    """Explain why files cannot be written, and what to do about it."""
    hints = {
        errno.ENOSPC: "Free space on the disk, or use another --workspace.",
        errno.EDQUOT: "Free space in your quota, or use another --workspace.",
        errno.EROFS: "The disk is mounted read-only: use another --workspace.",
        errno.ENOTDIR: "A file is where a folder should be: use another --workspace.",
        errno.ENAMETOOLONG: "The path is too long: use a --workspace with a shorter path.",
    }
    place = error.filename or folder
    return NotReadableError(
        f"The package cannot be written: {error.strerror} ({place}). Nothing was left behind.",
        hint=hints.get(error.errno or 0, "Use a --workspace where you may write."),
    )


# Path in the workspace -> text: what git leaves out.
IGNORE_FILE = {".gitignore": "# Written by colcon.\n/build/\n/install/\n/log/\n"}
# Errors of disks without hard links.
_NO_LINKS = {errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EMLINK, errno.ENOSYS}


def refuse_files(tree: Mapping[str, str], root: Path) -> None:
    """Stop if a file of the tree exists in the workspace, or would be written outside of it.

    Raises:
        WouldOverwriteError: a file exists.
        NotReadableError: one of its parent folders is a link.
    """
    for name in tree:
        for folder in _folders(name, root):
            if folder.is_symlink():
                raise NotReadableError(
                    f"{folder} is a link; nothing was written.",
                    hint="Replace it by a folder: wsgen writes only into the workspace.",
                )
        if os.path.lexists(root / name):
            raise WouldOverwriteError(
                f"{root / name} already exists; nothing was written.",
                hint="Omit --ci if it builds the workspace already; otherwise move it away first.",
            )


@contextlib.contextmanager
def adding_files(
    tree: Mapping[str, str], root: Path, *, where_missing: Mapping[str, str]
) -> Iterator[None]:
    """Add files to the workspace at `root`; if the block fails, they are removed again.

    Files of `where_missing` are only added if they do not exist.

    Raises:
        WouldOverwriteError: a file of `tree` exists; nothing was changed.
        NotReadableError: the files cannot be written; nothing is left of them.
    """
    refuse_files(tree, root)
    made: list[Path] = []
    added: list[Path] = []
    try:
        if tree or where_missing:
            make_parents(root, made)
            remove_leftovers(root)
            with unfinished_folder(root) as unfinished:
                _add(where_missing, root, unfinished / "spare", made, added, is_spare=True)
                _add(tree, root, unfinished / "wanted", made, added, is_spare=False)
        yield
    except BaseException as error:
        for path in added:
            with contextlib.suppress(OSError):
                path.unlink()
        for path in reversed(made):
            with contextlib.suppress(OSError):  # another process put something into it
                path.rmdir()
        if isinstance(error, OSError):
            raise explain_failure(error, root) from error
        raise


def _add(  # noqa: PLR0913  two lists to undo it by
    tree: Mapping[str, str],
    root: Path,
    unfinished: Path,
    made: list[Path],
    added: list[Path],
    *,
    is_spare: bool,
) -> None:
    write_files(tree, unfinished)
    for name in tree:
        make_parents((root / name).parent, made)
        try:
            _link(unfinished / name, root / name)
        except FileExistsError:
            if not is_spare:
                refuse_files({name: ""}, root)
                raise
        else:
            added.append(root / name)


def _link(source: Path, place: Path) -> None:
    try:
        os.link(source, place)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        if os.path.lexists(place):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(place)) from error
        source.rename(place)


def _folders(name: str, root: Path) -> Iterator[Path]:
    """The folders between the workspace and a file."""
    parts = name.split("/")[:-1]
    for count in range(1, len(parts) + 1):
        yield root.joinpath(*parts[:count])

"""Files of a workspace that belong to none of its packages, added to it one by one.

As with packages: all of them are there whole, or none is, and nothing that exists is touched. A
file is written into a hidden folder first and linked to its place from there, which fails where
something is already.
"""

from __future__ import annotations

import contextlib
import errno
import os
from typing import TYPE_CHECKING

from wsgen.errors import NotReadableError, WouldOverwriteError
from wsgen.templating.write import (
    explain_failure,
    make_parents,
    remove_leftovers,
    unfinished_folder,
    write_files,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

# Path in the workspace -> text: what git leaves out.
IGNORE_FILE = {".gitignore": "# What colcon makes, and makes again.\n/build/\n/install/\n/log/\n"}
# What disks answer that know no hard links.
_NO_LINKS = {errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EMLINK, errno.ENOSYS}


def refuse_files(tree: Mapping[str, str], root: Path) -> None:
    """Stop if a file of the tree exists in the workspace, or could only be put outside of it.

    Raises:
        WouldOverwriteError: something is at the place of a file.
        NotReadableError: a link is on the way to it.
    """
    for name in tree:
        for folder in _folders(name, root):
            if folder.is_symlink():
                raise NotReadableError(
                    f"{folder} is a link; nothing was written.",
                    hint="Make it a folder: wsgen writes into the workspace alone.",
                )
        if os.path.lexists(root / name):
            raise WouldOverwriteError(
                f"{root / name} exists already; nothing was written.",
                hint="Leave --ci away if it builds the workspace already; else move it away first.",
            )


@contextlib.contextmanager
def adding_files(
    tree: Mapping[str, str], root: Path, *, where_missing: Mapping[str, str]
) -> Iterator[None]:
    """Add files to the workspace at `root`; if the block fails, they are gone again.

    Files of `where_missing` are left out where something is in their place.

    Raises:
        WouldOverwriteError: a file of `tree` exists; nothing was changed.
        NotReadableError: the disk does not take the files; nothing is left of them.
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
            with contextlib.suppress(OSError):  # somebody else put something into it
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

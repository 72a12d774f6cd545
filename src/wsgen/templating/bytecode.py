"""The compiled templates of earlier runs, in the user's cache folder.

Compiling the templates costs more than all the rest of `wsgen new`. All of them are kept in one
file, which is a convenience: whatever is wrong with it, it is as if there were none.

Loading code means trusting whoever wrote it. Folder and file must belong to the user and be
writable by nobody else; the folder is opened once, so that none can be put in its place.
"""

from __future__ import annotations

import contextlib
import marshal
import os
import stat
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen import __version__

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import CodeType

# Of one compiled template: the checksum of its source, and its code.
Entry = tuple[str, "CodeType"]
# Raise it when the options of the Jinja2 environment change: the code depends on them.
FORMAT = 2


class CodeFile:
    """The file of compiled templates for this Python, this wsgen and this Jinja2."""

    def __init__(self, jinja_version: str) -> None:
        self._name = (
            f"templates-{FORMAT}-{__version__}-{jinja_version}-{sys.implementation.cache_tag}"
        )

    def read(self) -> dict[str, Entry]:
        """What is in the file; nothing if it is missing, broken or not to be trusted."""
        try:
            with _open_folder() as folder:
                descriptor = os.open(self._name, os.O_RDONLY | os.O_NOFOLLOW, dir_fd=folder)
                with open(descriptor, "rb") as file:  # noqa: PTH123  a descriptor, not a path
                    _trust(descriptor)
                    entries = marshal.loads(file.read())  # noqa: S302  trusted, see above
        except (OSError, RuntimeError, ValueError, EOFError, TypeError):
            return {}
        return entries if isinstance(entries, dict) else {}

    def write(self, entries: dict[str, Entry]) -> None:
        """Replace the file; nothing happens if that is impossible."""
        with contextlib.suppress(OSError, RuntimeError), _open_folder() as folder:
            unfinished = f"{self._name}.{os.getpid()}"
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            descriptor = os.open(unfinished, flags, 0o600, dir_fd=folder)
            try:
                with open(descriptor, "wb") as file:  # noqa: PTH123  a descriptor, not a path
                    file.write(marshal.dumps(entries))
                os.replace(unfinished, self._name, src_dir_fd=folder, dst_dir_fd=folder)
            except OSError:
                os.unlink(unfinished, dir_fd=folder)
                raise


@contextlib.contextmanager
def _open_folder() -> Iterator[int]:
    """A descriptor of wsgen's cache folder, which is made if it is missing.

    Raises:
        OSError, RuntimeError: there is none, nor a home to make it in, or it is not the user's
            alone.
    """
    cache = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():  # the XDG specification ignores it then, and so an empty one
        cache = Path.home() / ".cache"
    folder = cache / "wsgen"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        _trust(descriptor)
        yield descriptor
    finally:
        os.close(descriptor)


def _trust(descriptor: int) -> None:
    status = os.fstat(descriptor)
    if status.st_uid != os.geteuid() or status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise PermissionError

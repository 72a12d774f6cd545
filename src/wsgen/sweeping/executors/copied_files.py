"""Copies of files of another machine, in a scratch folder, by their content."""

from __future__ import annotations

import os
import shutil
import threading
from collections import Counter, OrderedDict
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


MOST_FOLDERS = 32  # that are kept, the last that were used; those in use are never removed


class CopiedFiles:
    """Folders with copies; several threads may use them.

    Each has the files of one value under their own names, those of one folder together, for some
    name others beside them. What several folders have in common is on the disk once.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._used: Counter[str] = Counter()  # by how many calls, by key
        self._kept: OrderedDict[str, dict[str, str]] = OrderedDict()  # what was moved, by key
        self._lock = threading.Lock()

    @contextmanager
    def lent(self, key: str, files: Mapping[str, tuple[str, bytes]]) -> Iterator[dict[str, str]]:
        """The paths of the copies by those of the files, for as long as the context lasts.

        `files` has the hash of each file's content, and the content, by its path. `key` is that of
        the value and of all that they hold: the copies of one key are always at the same paths.

        Raises:
            OSError: The disk refuses them.
        """
        with self._lock:
            if key not in self._kept:
                self._kept[key] = self._write(key, files)
            self._kept.move_to_end(key)
            self._used[key] += 1
            moved = self._kept[key]
        try:
            yield moved
        finally:
            with self._lock:
                self._used[key] -= 1
                self._remove_oldest()

    def _write(self, key: str, files: Mapping[str, tuple[str, bytes]]) -> dict[str, str]:
        contents = self._folder / "contents"
        contents.mkdir(parents=True, exist_ok=True)
        folders: dict[str, Path] = {}
        moved = {}
        for path, (hashed, content) in files.items():
            original = PurePosixPath(path)
            folder = folders.setdefault(
                str(original.parent), self._folder / key / str(len(folders))
            )
            folder.mkdir(parents=True, exist_ok=True)
            copy, whole = folder / original.name, contents / hashed
            if not whole.exists():
                part = whole.with_suffix(".part")
                part.write_bytes(content)
                part.replace(whole)
            with suppress(FileExistsError):
                _link(whole, copy)
            moved[path] = str(copy)
        return moved

    def _remove_oldest(self) -> None:
        for key in list(self._kept):
            if len(self._kept) <= MOST_FOLDERS:
                return
            if not self._used[key]:
                del self._kept[key], self._used[key]
                shutil.rmtree(self._folder / key, ignore_errors=True)
                self._remove_unnamed()

    def _remove_unnamed(self) -> None:
        """Remove contents that no folder names any more."""
        for content in (self._folder / "contents").iterdir():
            with suppress(OSError):
                if content.stat().st_nlink == 1:
                    content.unlink()

    def remove(self) -> None:
        """Remove all."""
        with self._lock:
            self._kept.clear()
            shutil.rmtree(self._folder, ignore_errors=True)


def _link(content: Path, copy: Path) -> None:
    try:
        os.link(content, copy)
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        shutil.copyfile(content, copy)

"""Arguments that many calls have in common: they are sent once to whoever computes these calls.

Files that they name are copied to other machines, into a scratch folder, by their content.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
import threading
from collections import Counter, OrderedDict
from collections.abc import Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path, PurePath, PurePosixPath
from typing import TYPE_CHECKING, Any

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


@dataclass(frozen=True)
class Shared:
    """An argument of many calls, by its content; a function that is called gets the value."""

    key: str  # of the content
    pickled: bytes
    files: tuple[str, ...] = ()  # absolute paths of files that the value names
    # Where these files are instead; what a call answers names them as the value does.
    moved: Mapping[str, str] | None = None


@dataclass(frozen=True)
class Reference:
    """What stands for a shared argument that a child has."""

    key: str


def share(value: Any, files: Iterable[str] = ()) -> Shared:
    """Make an argument that is sent once to each child or worker; it is pickled now.

    `files` are paths of files that the value names, as it names them; other machines get copies.
    """
    pickled = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    return Shared(hashlib.sha256(pickled).hexdigest(), pickled, tuple(dict.fromkeys(files)))


def relocated(value: Any, moved: Mapping[str, str]) -> Any:
    """A value of dataclasses, sequences and mappings with other paths where it names these."""
    if isinstance(value, PurePath):
        return type(value)(moved[str(value)]) if str(value) in moved else value
    if isinstance(value, tuple | list):
        parts = [relocated(part, moved) for part in value]
        if all(new is old for new, old in zip(parts, value, strict=True)):
            return value
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if isinstance(value, Mapping):
        return {key: relocated(part, moved) for key, part in value.items()}
    if hasattr(value, "__dataclass_fields__"):
        return _relocated_fields(value, moved)
    return moved.get(value, value) if type(value) is str else value


def _relocated_fields(value: Any, moved: Mapping[str, str]) -> Any:
    before = {field.name: getattr(value, field.name) for field in fields(value) if field.init}
    after = {name: relocated(part, moved) for name, part in before.items()}
    if all(after[name] is before[name] for name in before):
        return value
    return type(value)(**after)


def named_as_before(answer: Any, moved: Mapping[str, str]) -> Any:
    """An answer as JSON has it, with texts that name files by the paths that they were moved from.

    The values of `moved` are the paths where they are.
    """
    if isinstance(answer, str):
        for old, new in moved.items():
            answer = answer.replace(new, old)
        return answer
    if isinstance(answer, list):
        return [named_as_before(part, moved) for part in answer]
    if isinstance(answer, dict):
        return {key: named_as_before(part, moved) for key, part in answer.items()}
    return answer


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

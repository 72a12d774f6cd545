"""Look for files that change, by their times and sizes: of some hundred files it takes 1 ms.

The events of a system are not used: they are lost on network drives and in containers.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.packages.source_shares import BUILD_FOLDERS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


MOST_FILES = 5_000  # that are looked at
LEFT_OUT = BUILD_FOLDERS | {"node_modules"}  # names of folders
MARKS = ("package.xml", "model.config")  # of a folder that belongs together
MOST_LEVELS = 6  # from a file to the folder of its package
OF_EDITORS = ("~", ".swp", ".swx", ".tmp", ".bak", ".orig", ".pyc", "4913")  # ends of names
OF_ROBOTS = (  # what a file outside of packages may refer to beside it
    *(".urdf", ".xacro", ".sdf", ".world", ".yaml", ".yml"),
    *(".stl", ".dae", ".obj", ".mtl", ".glb", ".gltf", ".bin", ".ply"),
    *(".png", ".jpg", ".jpeg"),
)

Signature = tuple[int, int, int] | None  # None: it does not exist


class Watcher:
    """Remembers how files are, and says which have changed.

    Watched are the files themselves, and all that is in the packages and models that they are in:
    what is missing now may be put there, and a mesh file names its textures itself.
    """

    def __init__(self, files: Iterable[Path] = ()) -> None:
        self._files: dict[str, Signature] = {}
        self._folders: dict[str, tuple[Signature, frozenset[str]]] = {}
        self.watch(files)

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these files instead of those before, as they are now."""
        self._files, self._folders = {}, {}
        places: dict[Path, bool] = {}  # and whether it is a package, of which everything counts
        for file in files:
            self._files[str(file)] = _signature(str(file))
            package = _package_of(file)
            places[package or file.parent] = package is not None
        for place, is_package in places.items():
            if is_package:
                for folder, names, inner in _walk(str(place)):
                    self._folders[folder] = (_signature(folder), names)
                    self._add(folder, names - inner)
            else:
                beside = _names(str(place))
                self._add(str(place), (one for one in beside if one.lower().endswith(OF_ROBOTS)))

    def _add(self, folder: str, names: Iterable[str]) -> None:
        for name in names:
            path = os.path.join(folder, name)  # noqa: PTH118  thousands of them
            if len(self._files) < MOST_FILES and path not in self._files:
                self._files[path] = _signature(path)

    def changed(self) -> list[str]:
        """The paths that have changed since the last call, or since they are watched."""
        changed = []
        for path, before in self._files.items():
            now = _signature(path)
            if now != before:
                changed.append(path)
                self._files[path] = now
        for folder, (before, names) in self._folders.items():
            now = _signature(folder)
            if now != before:  # an editor's own files come and go, too
                found = _names(folder)
                changed += [os.path.join(folder, name) for name in sorted(found - names)]  # noqa: PTH118
                self._folders[folder] = (now, found)
        return changed


def _signature(path: str) -> Signature:
    try:
        found = os.stat(path)  # noqa: PTH116  thousands of them
    except (OSError, ValueError):
        return None
    return (found.st_mtime_ns, found.st_size, found.st_ino)


def _package_of(file: Path) -> Path | None:
    for folder in list(file.absolute().parents)[:MOST_LEVELS]:
        if any((folder / mark).is_file() for mark in MARKS):
            return folder
    return None


def _names(folder: str) -> frozenset[str]:
    """The names of files and folders in a folder that count."""
    try:
        names = os.listdir(folder)  # noqa: PTH208
    except OSError:
        return frozenset()
    return frozenset(
        name
        for name in names
        if name not in LEFT_OUT and not name.startswith(".") and not name.endswith(OF_EDITORS)
    )


def _walk(folder: str) -> Iterator[tuple[str, frozenset[str], frozenset[str]]]:
    """A folder and those below it: the names in it, and which of them are of folders."""
    waiting = [folder]
    count = 0
    while waiting and count < MOST_FILES:
        place = waiting.pop(0)
        names = _names(place)
        count += len(names) + 1
        paths = {name: os.path.join(place, name) for name in names}  # noqa: PTH118
        inner = frozenset(name for name, path in paths.items() if os.path.isdir(path))  # noqa: PTH112
        yield place, names, inner
        # A link may lead to a folder above.
        waiting += [paths[name] for name in sorted(inner) if not os.path.islink(paths[name])]  # noqa: PTH114

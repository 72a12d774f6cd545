"""Which packages of a workspace those that are checked may look up, by the names in their files.

Reading the build files of a hundred packages to check one takes longer than everything else.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.packages.source_shares import may_have_sources
from wsgen.text.files import read_regular
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.packages.workspace.layout import PackageFolder


SIZE_LIMIT = 2**20  # bytes; larger files are data
WORDS = lazy_pattern(rb"[A-Za-z0-9_-]+")
_HOOKS = b"ament_environment_hooks"  # sets what others find files by, without a name
# Of meshes and pictures, which name no package.
_BINARY = frozenset(
    (
        *(".bin", ".bmp", ".dae", ".gif", ".glb", ".jpeg", ".jpg", ".mp4", ".obj", ".pcd", ".pdf"),
        *(".pgm", ".ply", ".png", ".so", ".stl", ".tga", ".tif", ".zip"),
    )
)


def find_reached(checked: Iterable[str], packages: Mapping[str, PackageFolder]) -> frozenset[str]:
    """The names of packages that are checked, that their files name, and so on.

    Those that set the environment of all others are reached, too.

    Args:
        checked: names of packages.
        packages: all packages of the workspaces, by name.
    """
    checked = [*checked]
    if packages.keys() <= set(checked):
        return frozenset(packages)
    names = {name.encode(): name for name in packages}
    reached: set[str] = set()
    waiting = [*checked, *(name for name, one in packages.items() if _sets_environment(one))]
    while waiting:
        name = waiting.pop()
        if name in reached:
            continue
        reached.add(name)
        if len(reached) == len(packages):
            break
        words = {
            word for _, text in texts_below(packages[name].path) for word in WORDS.findall(text)
        }
        waiting += [names[word] for word in words & names.keys()]
    return frozenset(reached)


def _sets_environment(package: PackageFolder) -> bool:
    return _HOOKS in _read(package.path / "CMakeLists.txt")


def texts_below(folder: Path) -> Iterator[tuple[Path, bytes]]:
    """The files of a package that may name another one, and what they hold."""
    for here, folders, files in os.walk(folder):
        folders[:] = filter(may_have_sources, folders)
        for name in files:
            if os.path.splitext(name)[1].lower() not in _BINARY:  # noqa: PTH122  of many files
                file = Path(here, name)
                yield file, _read(file)


def _read(file: Path) -> bytes:
    try:
        return read_regular(file, SIZE_LIMIT)
    except OSError:
        return b""

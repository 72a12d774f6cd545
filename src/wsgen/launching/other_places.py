"""Paths of another workspace, whose end is a file that a package of this one has, too."""

from __future__ import annotations

import os
import posixpath
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.launching.known_packages import as_on_linux

if TYPE_CHECKING:
    from collections.abc import Callable


class PlaceInPackage(NamedTuple):
    """Where a package has a file."""

    package: str
    inside: str  # its path below the share folder, with slashes


def find_in_package(
    path: str, share_of: Callable[[str], Path | None] | None = None
) -> PlaceInPackage | None:
    """The place in a package that is meant by a path like `~/other_ws/src/PACKAGE/config/a.yaml`.

    Args:
        path: A path, of any system, where nothing is.
        share_of: Gives the share folder of a package, if there is one; without it the packages are
            those of AMENT_PREFIX_PATH.
    """
    parts = PurePosixPath(posixpath.normpath(as_on_linux(path))).parts
    for index in range(len(parts) - 2, 0, -1):  # inner folders first: `install/P/share/P/...`
        package, inside = parts[index], "/".join(parts[index + 1 :])
        share = (share_of or _share)(package)
        if package != ".." and share is not None and os.path.isfile(share / inside):
            return PlaceInPackage(package, inside)
    return None


def _share(package: str) -> Path | None:
    from ament_index_python.packages import get_packages_with_prefixes

    prefix = get_packages_with_prefixes().get(package)
    return None if prefix is None else Path(prefix, "share", package)


def in_python(place: PlaceInPackage) -> str:
    """The expression of a launch file in Python for that place."""
    return f"os.path.join(get_package_share_directory('{place.package}'), '{place.inside}')"

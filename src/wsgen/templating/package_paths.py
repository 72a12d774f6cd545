"""Paths of the files of a package: written with names in them, and fit for every disk."""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

from wsgen.model.names import WINDOWS_DEVICES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.model.package import PackageSpec

MAXIMUM_BYTES = 255  # of one name, on most disks
MAXIMUM_PATH = 400  # characters: below the folders of a workspace it becomes longer
# Folders that colcon makes, and that of git: what lies there is not the package's.
RESERVED_FOLDERS = frozenset({"build", "install", "log", ".git"})
# colcon would pass the package over.
RESERVED_FILES = frozenset({"colcon_ignore", "ament_ignore", "catkin_ignore"})

_NAME = re.compile(r"\{\{ *([a-z_.0-9]+) *\}\}")
_WINDOWS_CANNOT = frozenset('<>:"|?*\\')


class PathError(Exception):
    """A path that no package can have; the message is a sentence about it."""


def fill_in(pattern: str, spec: PackageSpec) -> str:
    """The path that a pattern stands for: `{{ package.name }}` and the like become names.

    Raises:
        PathError: it names something else, or is no path that a package can have.
    """
    names = _names(spec)

    def name(match: re.Match[str]) -> str:
        try:
            return names[match[1]]
        except KeyError:
            raise PathError(
                f"{match[0]} is no name that a path may have in it: {', '.join(names)}"
            ) from None

    path = _NAME.sub(name, pattern)
    if "{" in path or "}" in path:
        raise PathError("a path has no logic in it, only names such as {{ package.name }}")
    problem = check_path(path)
    if problem is not None:
        raise PathError(problem)
    return path


def check_path(path: str) -> str | None:
    """What keeps a path from being one in a package; None if nothing does."""
    return next(_problems(path), None)


def _problems(path: str) -> Iterator[str]:
    parts = path.split("/")
    if not {"", ".", ".."}.isdisjoint(parts):
        yield "it is no path below the package's folder, written with single slashes"
    if not path.isprintable():
        yield "it has a character in it that does not print"
    elif len(path) > MAXIMUM_PATH or any(len(part.encode()) > MAXIMUM_BYTES for part in parts):
        yield "it is too long"
    for part in parts:
        if not _WINDOWS_CANNOT.isdisjoint(part) or part != part.strip(" ").rstrip("."):
            yield f"{part!r} is no name on Windows, where nobody could check the package out"
        if part.split(".")[0].lower() in WINDOWS_DEVICES:
            yield f"{part!r} is a device on Windows, where nobody could check the package out"
    if parts[0].lower() in RESERVED_FOLDERS:
        yield f"{parts[0]!r} is a folder that colcon or git makes"
    if parts[-1].lower() in RESERVED_FILES:
        yield f"with a file {parts[-1]!r} colcon passes the package over"


def find_collision(paths: Iterable[str]) -> tuple[str, str] | None:
    """Two paths that are one on some disks, or of which one needs the other to be a folder."""
    known: dict[str, str] = {}
    folders: dict[str, str] = {}
    for path in paths:
        # macOS and Windows do not tell capitals apart, macOS not how accents are written.
        same = unicodedata.normalize("NFC", path).casefold()
        if same in known:
            return known[same], path
        known[same] = path
        while "/" in same:
            same = same.rpartition("/")[0]
            folders.setdefault(same, path)
    for same, path in known.items():
        if same in folders:
            return path, folders[same]
    return None


def _names(spec: PackageSpec) -> dict[str, str]:
    """What may stand in a path: names, and answers that are texts."""
    return {
        "package.name": spec.name,
        "package.target.distro": spec.target.distro,
        "package.target.simulator": spec.target.simulator,
        **{
            f"package.answers.{name}": value
            for name, value in spec.answers.items()
            if isinstance(value, str)
        },
    }

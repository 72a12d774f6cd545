"""What a FILE of `wsgen validate` is: a URDF, a xacro file or SDF; and files of xacro in others."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

from wsgen.descriptions.urdf.reader import TEXT_LIMIT
from wsgen.text.files import irregular_kind, read_regular
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


Kind = Literal["urdf", "xacro", "sdf"]

ROOT = lazy_pattern(
    rb"(?:\xef\xbb\xbf)?(?:\s|<\?.*?\?>|<!--.*?-->|<![^>-]*>)*<(robot|sdf)\b", re.DOTALL
)
XACRO = lazy_pattern(rb"xmlns:xacro.*(?:<xacro:|\$[({])", re.DOTALL)
MACRO = lazy_pattern(rb"<xacro:macro\s[^>]*?name\s*=\s*[\"']([^\"']+)")
INCLUDE = lazy_pattern(rb"<xacro:include\s[^>]*?filename\s*=\s*[\"'](?:[^\"']*/)?([^\"'/]+)[\"']")
OF_SUFFIX: dict[str, Kind] = {".urdf": "urdf", ".xacro": "xacro", ".sdf": "sdf", ".world": "sdf"}
MOST_LEVELS = 10  # of files that include each other


def kind_of(file: Path) -> Kind | None:
    """What a file is by its suffix and its root element; None where wsgen cannot simulate it.

    What declares and uses xacro is a file of xacro, whatever its suffix is: what xacro has written
    declares it too.
    """
    of_suffix = OF_SUFFIX.get(file.suffix.lower())
    text = read(file)
    root = ROOT.match(text)
    is_named_so = any(suffix.lower() == ".xacro" for suffix in file.suffixes)  # robot.xacro.urdf
    if is_named_so or ((root or of_suffix) and XACRO.search(text)):
        return "xacro"
    if of_suffix is not None or root is None:
        return of_suffix
    return "sdf" if root[1] == b"sdf" else "urdf"


def why_refused(file: Path) -> str | None:
    """Why a file cannot be simulated, as the end of a sentence about it; None where it can."""
    kind = irregular_kind(file)
    if kind is not None:
        return f"is {kind}"
    if not file.is_file():
        return "does not exist"
    return "is neither a URDF nor xacro nor SDF" if kind_of(file) is None else None


def defined_macros(file: Path) -> list[str]:
    """The names of the macros that a file of xacro defines, in its order."""
    return [name.decode("utf-8", "replace") for name in MACRO.findall(read(file))]


def find_includer(file: Path, root: Path) -> Path | None:
    """The file below a folder that includes a file of xacro, itself included by no other."""
    includers: dict[str, Path] = {}
    for other in _files_below(root):
        for name in INCLUDE.findall(read(other)):
            includers.setdefault(name.decode("utf-8", "replace"), other)
    found = None
    for _ in range(MOST_LEVELS):
        above = includers.get((found or file).name)
        if above is None or above == found:
            break
        found = above
    return found


def _files_below(root: Path) -> Iterator[Path]:
    for suffix in ("*.urdf.xacro", "*.xacro", "*.urdf"):
        yield from sorted(root.rglob(suffix))


def read(file: Path) -> bytes:
    """The content of a file; empty where it cannot be read."""
    try:
        return read_regular(file, 4 * TEXT_LIMIT)
    except (OSError, ValueError):
        return b""

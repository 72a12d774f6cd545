"""STL files, binary and text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.descriptions.meshes.content import (
    BrokenMeshError,
    Content,
    Patch,
    check_part,
    flat_normals,
    parse_floats,
)

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


TITLE_BYTES = 80
HEADER_BYTES = 84  # a title, and the number of triangles
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VERTEX = re.compile(rb"\bvertex\s+(\S+\s+\S+\s+\S+)", re.IGNORECASE)
# A triangle as Gazebo reads a text (STLLoader of gz-common): lines that it skips are not looked at.
FACET = re.compile(
    rb"[ \t]*facet\b[^\n]*\n[^\n]*\n"  # and `outer loop`
    rb"(?:[ \t]*[^\s]+(?:[ \t]+[^\s]+){3}[^\n]*\n){3}"
    rb"[^\n]*\n[^\n]*(?:\n|\Z)",  # `endloop` and `endfacet`
    re.IGNORECASE,
)
BETWEEN_FACETS = (b"solid", b"endsolid", b"color")  # the first words of other lines
COMMENTS = (b"#", b"!", b"$")
MOST_READ = 255  # bytes; what is longer counts as several lines
MOST_SHOWN = 40  # bytes of a line in a message
END_OF_TRIANGLE = re.compile(rb"\bendfacet\b", re.IGNORECASE)


def is_stl(data: bytes) -> bool:
    """Whether these are the bytes of an STL file."""
    return _binary_size(data) == len(data) or _is_text(data)


def read_stl(data: bytes, folder: Path | None = None, part: str | None = None) -> Content:
    """The triangles of an STL file, which has no parts; with their materials if its `folder` is.

    PyBullet leaves out one that is text, or has bytes behind its triangles.
    """
    if part is not None:
        check_part(part, ())
    size = _binary_size(data)
    if size != len(data) and _is_text(data):
        corners = _read_text(data)
        patches = () if folder is None else (Patch(corners),)
        return Content(corners=corners, is_plain=False, patches=patches)
    if size is None:
        raise BrokenMeshError(f"has {len(data)} bytes, too few for an STL file")
    claimed = (size - HEADER_BYTES) // TRIANGLE.itemsize
    if size > len(data):
        raise BrokenMeshError(
            f"says that it has {claimed} triangles, but ends after "
            f"{(len(data) - HEADER_BYTES) // TRIANGLE.itemsize}: it is cut short or not STL"
        )
    triangles = np.frombuffer(data, TRIANGLE, count=claimed, offset=HEADER_BYTES)
    inconsistency = None
    if size < len(data):
        inconsistency = (
            f"says that it has {claimed} triangles, but has {len(data) - size} more bytes: "
            "PyBullet does not load it"
        )
    is_plain = inconsistency is None
    corners = triangles["corners"]
    patches = () if folder is None else (Patch(corners),)
    return Content(corners=corners, is_plain=is_plain, inconsistency=inconsistency, patches=patches)


def write_stl(corners: NDArray[Any], file: Path) -> None:
    """Write triangles, shape (n, 3, 3), as a binary STL file."""
    triangles = np.zeros(len(corners), TRIANGLE)
    triangles["corners"] = corners
    triangles["normal"] = flat_normals(corners)
    with file.open("wb") as stream:
        stream.write(bytes(TITLE_BYTES) + len(corners).to_bytes(4, "little"))
        stream.write(triangles.data)


def _binary_size(data: bytes) -> int | None:
    """The size of the file if it is binary; None if it is too short to be."""
    if len(data) < HEADER_BYTES:
        return None
    count = int.from_bytes(data[TITLE_BYTES:HEADER_BYTES], "little")
    return HEADER_BYTES + TRIANGLE.itemsize * count


def _is_text(data: bytes) -> bool:
    start = data[:1024].lower()
    return start.lstrip().startswith(b"solid") and (b"facet" in start or b"endsolid" in start)


def _read_text(data: bytes) -> NDArray[np.float64]:
    if b"\n" not in data and b"\r" in data:
        raise BrokenMeshError(
            "is a text with CR line endings (old Macintosh): Gazebo does not read it"
        )
    numbers = parse_floats(b" ".join(VERTEX.findall(data)), "its vertices")
    triangles = len(END_OF_TRIANGLE.findall(data))
    if len(numbers) != 9 * triangles:
        raise BrokenMeshError(
            f"has {len(numbers) // 3} vertices for {triangles} triangles: it is cut short"
        )
    stop = _where_gazebo_stops(data, triangles)
    if stop is not None:
        line = data.splitlines()[stop - 1][:MOST_SHOWN].decode("ascii", "replace").strip()
        raise BrokenMeshError(
            f"is a text that Gazebo does not read from line {stop} on ({line!r}): `facet`, `outer "
            f"loop` and each `vertex` must be on separate lines of at most {MOST_READ} characters, "
            "without other lines between them"
        )
    return numbers.reshape(-1, 3, 3)


def _where_gazebo_stops(data: bytes, triangles: int) -> int | None:
    """The number of the line at which Gazebo leaves a text; None where it reads it to its end."""
    place = found = 0
    while place < len(data):
        facet = FACET.match(data, place)
        if facet is not None:
            found += 1
            place = facet.end()
            continue
        end = data.find(b"\n", place) + 1 or len(data)
        for start in range(place, end, MOST_READ):
            words = data[start : min(start + MOST_READ, end)].lower().split(None, 1)
            if words and words[0] not in BETWEEN_FACETS and not words[0].startswith(COMMENTS):
                return data.count(b"\n", 0, place) + 1
        place = end
    return None if found == triangles else 1

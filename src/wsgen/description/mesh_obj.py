"""Wavefront OBJ files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Content,
    EnormousMeshError,
    parse_floats,
    parse_integers,
    refuse_triangles,
    triangulate,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

VERTEX_LINE = re.compile(rb"(?m)^[ \t]*v[ \t]+[-+.\d]")
BEHIND_SLASH = re.compile(rb"/\S*")  # the indices of texture coordinates and normals
COORDINATES = 3
WORD_LIMIT = 12_000_000  # a million triangles have about half of it; so many take a second or two


def is_obj(data: bytes) -> bool:
    """Whether these are the bytes of an OBJ file."""
    return VERTEX_LINE.search(data) is not None


def read_obj(data: bytes) -> Content:
    """The triangles of an OBJ file.

    PyBullet and Gazebo use an index that is out of range, and crash or read other memory.
    """
    refuse_triangles(data.count(b"\nf "))
    if data.count(b" ") + data.count(b"\n") > WORD_LIMIT:
        raise EnormousMeshError(f"has more than {WORD_LIMIT:,} words")
    lines = _lines(data)
    vertices = [line for line in lines if line.startswith(b"v ")]
    faces = [line for line in lines if line.startswith(b"f ")]
    points = _read_points(vertices)
    joined = b"".join([line[1:] for line in faces])
    indices = parse_integers(BEHIND_SLASH.sub(b"", joined), "its faces")
    if indices.size and indices.min() < 0:
        indices = _made_absolute(indices, lines)
    wrong = indices[(indices < 1) | (indices > len(points))]
    if wrong.size:
        raise BrokenMeshError(
            f"has {len(points)} vertices, and a face with number {wrong[0]}: "
            "Gazebo and PyBullet crash on it"
        )
    return Content(corners=points[_cut(indices - 1, faces)])


def _lines(data: bytes) -> list[bytes]:
    """Its lines, with one blank behind the keyword and none before it."""
    for blank in (b"\r", b"\t", b"\v", b"\f"):
        if blank in data:
            data = data.replace(blank, b"\n" if blank == b"\r" else b" ")
    if b"\\\n" in data:
        data = data.replace(b"\\\n", b" ")
    if b"\n " in data or data.startswith(b" "):
        return [line.lstrip() for line in data.split(b"\n")]
    return data.split(b"\n")


def _read_points(lines: Sequence[bytes]) -> NDArray[np.float64]:
    """Shape (n, 3); a line may have a weight or a colour behind the coordinates."""
    numbers = parse_floats(b"".join([line[1:] for line in lines]), "its vertices")
    width, rest = divmod(len(numbers), len(lines) or 1)
    if width >= COORDINATES and not rest and _have_equal_widths(lines, width):
        return numbers.reshape(-1, width)[:, :COORDINATES]
    rows = [line.split()[1 : COORDINATES + 1] for line in lines]
    if any(len(row) < COORDINATES for row in rows):
        raise BrokenMeshError("has a vertex with fewer than three numbers")
    return np.array(rows, dtype=np.float64).reshape(-1, COORDINATES)


def _have_equal_widths(lines: Sequence[bytes], width: int) -> bool:
    """Whether each line has so many numbers, given that all together have that many on average."""
    if width == COORDINATES:  # nothing has fewer, so nothing has more
        return all(len(line.split(None, COORDINATES)) > COORDINATES for line in lines)
    return all(len(line.split()) == width + 1 for line in lines)


def _cut(indices: NDArray[np.int64], faces: Sequence[bytes]) -> NDArray[np.int64]:
    sizes = np.fromiter((len(line.split()) - 1 for line in faces), np.int64, len(faces))
    if (sizes == COORDINATES).all():
        return indices.reshape(-1, COORDINATES)
    return triangulate(indices, sizes)


def _made_absolute(indices: NDArray[np.int64], lines: Sequence[bytes]) -> NDArray[Any]:
    """Negative indices count back from the last vertex that stands before the face."""
    seen = 0
    before = []
    for line in lines:
        if line.startswith(b"v "):
            seen += 1
        elif line.startswith(b"f "):
            before += [seen] * (len(line.split()) - 1)
    return np.where(indices < 0, indices + np.array(before) + 1, indices)

"""Wavefront OBJ files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Content,
    EnormousMeshError,
    parse_integers,
    refuse_triangles,
    triangulate,
)
from wsgen.description.mesh_obj_look import Faces, with_look
from wsgen.description.mesh_obj_rows import made_absolute, read_rows

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

VERTEX_LINE = re.compile(rb"(?m)^[ \t]*v[ \t]+[-+.\d]")
BEHIND_SLASH = re.compile(rb"/\S*")  # the indices of texture coordinates and normals
LIBRARY = b"mtllib"  # the keyword before the name of a file with materials
COORDINATES = 3
WORD_LIMIT = 12_000_000  # a million triangles have about half of it; so many take a second or two


def is_obj(data: bytes) -> bool:
    """Whether these are the bytes of an OBJ file."""
    return VERTEX_LINE.search(data) is not None


def read_obj(data: bytes, folder: Path | None = None) -> Content:
    """The triangles of an OBJ file; with their look if its `folder` is given.

    PyBullet and Gazebo use an index that is out of range, and crash or read other memory.
    """
    refuse_triangles(data.count(b"\nf "))
    if data.count(b" ") + data.count(b"\n") > WORD_LIMIT:
        raise EnormousMeshError(f"has more than {WORD_LIMIT:,} words")
    lines = _lines(data)
    vertices = [line for line in lines if line.startswith(b"v ")]
    faces = [line for line in lines if line.startswith(b"f ")]
    points = read_rows(vertices, COORDINATES, "vertex")
    joined = b"".join([line[1:] for line in faces])
    indices = parse_integers(BEHIND_SLASH.sub(b"", joined), "its faces")
    indices = made_absolute(indices, lines, b"v ")
    wrong = indices[(indices < 1) | (indices > len(points))]
    if wrong.size:
        raise BrokenMeshError(
            f"has {len(points)} vertices, and a face with number {wrong[0]}: "
            "Gazebo and PyBullet crash on it"
        )
    sizes = np.fromiter((len(line.split()) - 1 for line in faces), np.int64, len(faces))
    # PyBullet and Gazebo's engines open what stands behind it; as a comment it is none.
    cleaned = data.replace(LIBRARY, b"#" * len(LIBRARY)) if LIBRARY in data else None
    if folder is None:
        return Content(corners=points[_cut(indices - 1, sizes)], cleaned=cleaned)
    places = _cut(np.arange(len(indices)), sizes)
    corners = points[indices[places] - 1]
    return with_look(corners, places, Faces(lines, joined, sizes), folder)._replace(cleaned=cleaned)


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


def _cut(indices: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    if (sizes == COORDINATES).all():
        return indices.reshape(-1, COORDINATES)
    return triangulate(indices, sizes)

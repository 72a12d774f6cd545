"""What the triangles of an OBJ file look like."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Content,
    Material,
    Patch,
    parse_integers,
)
from wsgen.description.mesh_mtl import read_materials
from wsgen.description.mesh_obj_rows import made_absolute, read_rows

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

TEXTURE_POINT, NORMAL = 1, 2  # where they stand in `vertex/texture point/normal`
KEYWORDS = {TEXTURE_POINT: b"vt ", NORMAL: b"vn "}
WIDTHS = {TEXTURE_POINT: 2, NORMAL: 3}


class Faces(NamedTuple):
    """The faces of a file, as far as they are read."""

    lines: Sequence[bytes]  # of the whole file
    joined: bytes  # of the faces, without their keywords
    sizes: NDArray[np.int64]  # how many corners each has


def with_look(
    corners: NDArray[np.float64], places: NDArray[np.int64], faces: Faces, folder: Path
) -> Content:
    """What is in the file.

    Args:
        corners: Of the triangles, shape (n, 3, 3).
        places: Where these stand among all corners of the faces, shape (n, 3).
        faces: What the triangles were cut from.
        folder: Where the materials are searched.
    """
    if not len(corners):
        return Content(corners=corners)
    lines = faces.lines
    libraries = [line[7:].strip() for line in lines if line.startswith(b"mtllib ")]
    names = [name.decode("utf-8", errors="replace") for name in libraries]
    materials, complaints = read_materials(names, folder)
    columns = _columns(faces)
    normals = _rows_at(columns, NORMAL, faces, places)
    texture_points = _rows_at(columns, TEXTURE_POINT, faces, places)
    used, number_of = _materials_of_faces(faces, materials)
    face_of_corner = np.repeat(np.arange(len(faces.sizes)), faces.sizes)
    number = number_of[face_of_corner[places[:, 0]]]
    patches = [
        Patch(
            corners=corners[mask],
            normals=None if normals is None else normals[mask],
            texture_points=None if texture_points is None else texture_points[mask],
            material=material,
        )
        for material, mask in zip(used, _masks(number, len(used)), strict=True)
    ]
    is_whole = normals is not None or b"/" not in faces.joined
    return Content(
        corners=corners,
        patches=tuple(patch for patch in patches if len(patch.corners)),
        complaints=complaints,
        is_drawable=is_whole and not libraries,
    )


def _materials_of_faces(
    faces: Faces, materials: dict[str, Material]
) -> tuple[list[Material], NDArray[np.int64]]:
    """The different materials, and for each face the number of its own."""
    numbers: dict[Material, int] = {}
    number_of = np.zeros(len(faces.sizes), np.int64)
    at, current = 0, Material()
    start = 0
    marks = [line for line in faces.lines if line.startswith((b"f ", b"usemtl"))]
    for line in [*marks, b"usemtl"]:
        if line.startswith(b"f "):
            at += 1
            continue
        if at > start:
            number_of[start:at] = numbers.setdefault(current, len(numbers))
            start = at
        name = line[7:].strip().decode("utf-8", errors="replace")
        current = materials.get(name, Material())
    return list(numbers), number_of


def _masks(numbers: NDArray[np.int64], count: int) -> Iterator[NDArray[np.int64] | slice]:
    """Where each of the numbers from 0 stands."""
    if count == 1:
        yield slice(None)
        return
    order = np.argsort(numbers, kind="stable")
    ends = np.cumsum(np.bincount(numbers, minlength=count))
    yield from np.split(order, ends[:-1])


def _columns(faces: Faces) -> NDArray[np.int64] | None:
    """Vertex, texture point and normal of each corner, 0 where there is none, shape (n, 3).

    None where the corners are not all written alike, which no exporter does.
    """
    count = int(faces.sizes.sum())
    text = faces.joined.replace(b"//", b"/0/")
    slashes = text.count(b"/")
    if not slashes or slashes not in {count, 2 * count}:
        return None
    try:
        indices = parse_integers(text.replace(b"/", b" "), "its faces")
    except BrokenMeshError:
        return None
    columns = np.zeros((count, 3), np.int64)
    width = slashes // count + 1
    if len(indices) != count * width:
        return None
    columns[:, :width] = indices.reshape(count, width)
    return columns


def _rows_at(
    columns: NDArray[np.int64] | None, kind: int, faces: Faces, places: NDArray[np.int64]
) -> NDArray[np.float64] | None:
    """The normals or texture points of the triangles; None if one is not there."""
    if columns is None:
        return None
    keyword = KEYWORDS[kind]
    rows = [line for line in faces.lines if line.startswith(keyword)]
    indices = made_absolute(columns[:, kind], faces.lines, keyword)
    if not rows or indices.min() < 1 or indices.max() > len(rows):
        return None
    try:
        return read_rows(rows, WIDTHS[kind], keyword.decode().strip())[indices[places] - 1]
    except BrokenMeshError:
        return None

"""The surfaces that are drawn: triangles of primitives, and those of mesh files."""

from __future__ import annotations

import functools
import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.model.robot import Box, Capsule, Sphere

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Primitive

    Floats = NDArray[np.float32]

AROUND = 96  # faces around a round shape
UP = 32  # rings of a sphere


class Surface(NamedTuple):
    """Triangles, seen from their own frame: coordinates by three corners, by n."""

    corners: Floats  # 3 by 3 by n, m, without the scale of a mesh
    normals: Floats | None = None  # 3 by 3 by n, not a number where there is none; None: nowhere
    texture_points: Floats | None = None  # 2 by 3 by n; 0 0 is an image's lower left corner


@functools.cache  # robots have many that are alike
def surface_of(geometry: Primitive | str, around: int = AROUND, up: int = UP) -> Surface:
    """The surface of a shape, or of a mesh by its path; not to be changed.

    A mesh is an array that `wsgen.descriptions.meshes.appearance` wrote, or a mesh file in any
    format. A round shape has so many faces `around`, and a sphere so many rings `up`.
    """
    if isinstance(geometry, str):
        return _load(Path(geometry))
    if isinstance(geometry, Box):
        return _box(geometry.size)
    if isinstance(geometry, Sphere):
        return _turned(_arc(geometry.radius, -90, 90, 0.0, up), around)
    half, radius = geometry.length / 2, geometry.radius
    side = [[(radius, -half, 1.0, 0.0), (radius, half, 1.0, 0.0)]]
    if isinstance(geometry, Capsule):
        ends = _arc(radius, -90, 0, -half, up), _arc(radius, 0, 90, half, up)
        return _turned([*ends[0], *side, *ends[1]], around)
    bottom, top = ([(0.0, z, 0.0, z), (radius, z, 0.0, z)] for z in (-half, half))
    return _turned([bottom, *side, top[::-1]], around)


def forget_surfaces() -> None:
    """Free what was loaded: where robots are read again and again, files get new names."""
    surface_of.cache_clear()
    is_closed.cache_clear()


OUTLINE = 5_000  # corners are enough to know where a surface is
DIRECTIONS = np.array(
    [
        [x, y, z]
        for x in (-1, 0, 1)
        for y in (-1, 0, 1)
        for z in (-1, 0, 1)
        if (x, y, z) > (0, 0, 0)
    ],
    dtype=np.float32,
)


def outline(surface: Surface) -> Floats:
    """Corners (3 by n) that it lies between: of many some, and the outermost in each direction."""
    points = surface.corners.reshape(3, -1)
    count = points.shape[1]
    if count <= OUTLINE:
        return points
    along = DIRECTIONS @ points
    some = np.arange(0, count, count // OUTLINE)
    return points[:, np.concatenate([some, along.argmin(axis=1), along.argmax(axis=1)])]


HASHES = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


@functools.cache
def is_closed(geometry: Primitive | str) -> bool:
    """Whether each side of a triangle is the opposite side of another: a surface without a border.

    It compares sums over all sides, of a number that hardly two different sides have in common.
    """
    bits = (surface_of(geometry).corners + np.float32(0)).view(np.uint32).astype(np.uint64)  # no -0
    corners = _mixed(sum(row * number for row, number in zip(bits, HASHES, strict=True)))
    after = corners[[1, 2, 0]]
    sides, opposite = (_mixed(a * HASHES[0] + b) for a, b in ((corners, after), (after, corners)))
    return bool(sides.sum() == opposite.sum())


def _mixed(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    mixed: NDArray[np.uint64] = (numbers ^ (numbers >> np.uint64(29))) * HASHES[1]
    return mixed


def _load(file: Path) -> Surface:
    if file.suffix == ".npy":
        rows = np.load(file)
        normals, points = (rows[part] if len(rows) > part.start else None for part in PARTS)
        return Surface(rows[:3], normals, points)
    # Of a file that was not prepared, as a collision's is not; its readers take a while to load.
    from wsgen.descriptions.meshes.worker import read_mesh  # noqa: PLC0415

    return Surface(np.ascontiguousarray(read_mesh(file).corners.astype(np.float32).T))


PARTS = slice(3, 6), slice(6, 8)  # of an array's rows: normals, texture points


def _box(size: Sequence[float]) -> Surface:
    faces = [np.roll(np.insert(SQUARE, 0, 1, axis=0), axis, axis=0) for axis in range(3)]
    quads = np.stack([*faces, *(-face[:, ::-1] for face in faces)], axis=1)  # 3 by 6 by 4
    signs = quads[:, :, QUADS].reshape(3, -1, 3).transpose(0, 2, 1)
    corners = (signs * np.array(size)[:, None, None] / 2).astype(np.float32)
    # The whole image on each face; on those above and below, x is to the right and y up.
    places = np.stack([signs[1:], signs[[0, 2]], signs[:2]])  # by axis, 2 by 3 by 12
    axes = np.tile(np.repeat(np.arange(3), len(QUADS)), 2)  # of each triangle
    points = (places[axes, :, :, np.arange(len(axes))].transpose(1, 2, 0) + 1) / 2
    return Surface(corners, texture_points=points.astype(np.float32))


SQUARE = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]])  # the corners of a face, seen from outside
QUADS = np.array([[0, 1, 2], [0, 2, 3]])  # two triangles

End = tuple[float, float, float, float]  # radius, z, and the normal's part outwards, along z


def _arc(radius: float, start: int, end: int, shift: float, up: int) -> list[list[End]]:
    count = up * (end - start) // 180
    angles = [math.radians(start + (end - start) * step / count) for step in range(count + 1)]
    ends = [
        (
            radius * math.cos(angle),
            shift + radius * math.sin(angle),
            math.cos(angle),
            math.sin(angle),
        )
        for angle in angles
    ]
    return [[low, high] for low, high in itertools.pairwise(ends)]


def _turned(profile: list[list[End]], around: int) -> Surface:
    """Lines turned about z."""
    radius, z, outwards, along = np.array(profile, dtype=np.float64).transpose(2, 0, 1)[..., None]
    angles = np.linspace(0, 2 * np.pi, around + 1)
    cos, sin = np.cos(angles), np.sin(angles)
    cos[-1], sin[-1] = 1, 0  # the last are the first, to the bit
    radius[np.abs(radius) < np.abs(radius).max() * 1e-9] = 0
    flat = np.ones_like(cos)
    rows = np.stack(
        [radius * cos, radius * sin, z * flat, outwards * cos, outwards * sin, along * flat]
    )  # 6 by lines by their two ends by angles
    low, high = rows[:, :, 0], rows[:, :, 1]
    corners = [low[..., :-1], low[..., 1:], high[..., 1:], high[..., :-1]]
    halves = [
        np.stack([corners[number] for number in order], axis=1).reshape(6, 3, -1) for order in QUADS
    ]
    both = np.concatenate(halves, axis=2)
    points = both[:3]
    has_area = ((points[:, 0] != points[:, 1]) | (points[:, 0] != points[:, 2])).any(axis=0)
    both = both[..., has_area].astype(np.float32)
    return Surface(both[:3], both[3:])

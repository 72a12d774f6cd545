"""Fewer triangles for almost the same surface: corners that lie close together become one."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Doubles = NDArray[np.float64]
    Indices = NDArray[np.int64]

FINEST = 1024  # cells along the longest edge of the box around all: what is smaller is not seen
ROUNDS = 12  # in which the size of a cell is found
ENOUGH = 0.85  # of the triangles that there may be


class Triangles(NamedTuple):
    """Corners, and triangles between them."""

    corners: Doubles  # n by 3, m
    triangles: Indices  # n by 3, numbers of corners


def merge(corners: Doubles, keys: Doubles | None = None) -> Triangles:
    """Triangles (n by 3 corners by 3 coordinates) with each corner once; none without area.

    Corners are the same where all of `keys` (n by 3 by any) are, which are the coordinates if they
    are not given.
    """
    flat = corners.reshape(-1, 3)
    rows = flat if keys is None else keys.reshape(len(flat), -1)
    same = np.ascontiguousarray(rows + 0.0).view([("", rows.dtype)] * rows.shape[1]).ravel()
    _, first, numbers = np.unique(same, return_index=True, return_inverse=True)
    return _without_flat(Triangles(flat[first], numbers.reshape(-1, 3)))


def simplify(meshes: Sequence[Triangles], most: int) -> list[Triangles]:
    """The meshes with at most so many triangles in all, or about that; each keeps some.

    Space is divided into cubic cells, and the corners of a mesh that are in one cell become one, in
    their middle (Rossignac and Borrel 1993). The cells are as small as there may be triangles.
    """
    if _count(meshes) <= most:
        return list(meshes)
    low = np.min([mesh.corners.min(axis=0) for mesh in meshes if len(mesh.corners)], axis=0)
    high = np.max([mesh.corners.max(axis=0) for mesh in meshes if len(mesh.corners)], axis=0)
    size = float(np.max(high - low)) or 1.0
    # What is seen of no cell is left out first, so that the rounds have less to do.
    fine = [_clustered(mesh, low, size / FINEST) for mesh in meshes]
    best, cells = fine, (size / FINEST, size)
    if _count(fine) > most:
        best = [_clustered(mesh, low, size) for mesh in fine]
        for _ in range(ROUNDS):
            middle = (cells[0] * cells[1]) ** 0.5
            found = [_clustered(mesh, low, middle) for mesh in fine]
            if _count(found) > most:
                cells = (middle, cells[1])
                continue
            best, cells = found, (cells[0], middle)
            if _count(found) >= ENOUGH * most:
                break
    return [
        one if len(one.triangles) else _box_around(mesh)
        for one, mesh in zip(best, meshes, strict=True)
    ]


def _count(meshes: Sequence[Triangles]) -> int:
    return sum(len(mesh.triangles) for mesh in meshes)


CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)  # counter-clockwise, seen from outside


def _box_around(mesh: Triangles) -> Triangles:
    """What a mesh becomes that is smaller than a cell."""
    if not len(mesh.corners):
        return mesh
    low, high = mesh.corners.min(axis=0), mesh.corners.max(axis=0)
    triangles = np.concatenate([FACES[:, [0, 1, 2]], FACES[:, [0, 2, 3]]])
    return Triangles(low + CORNERS * (high - low), triangles)


def _clustered(mesh: Triangles, low: Doubles, cell: float) -> Triangles:
    if not len(mesh.corners):
        return mesh
    places = np.floor((mesh.corners - low) / cell).astype(np.int64)
    keys = (places[:, 0] << 42) | (places[:, 1] << 21) | places[:, 2]
    _, numbers = np.unique(keys, return_inverse=True)
    count = np.bincount(numbers)
    corners = np.stack(
        [np.bincount(numbers, weights=mesh.corners[:, axis]) / count for axis in range(3)], axis=1
    )
    return _without_flat(Triangles(corners, numbers[mesh.triangles]))


def _without_flat(mesh: Triangles) -> Triangles:
    """Without triangles that have a corner twice, and without second ones of the same corners."""
    a, b, c = mesh.triangles.T
    triangles = mesh.triangles[(a != b) & (b != c) & (a != c)]
    if len(triangles):
        _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
        triangles = triangles[np.sort(first)]
    used, numbers = np.unique(triangles, return_inverse=True)
    return Triangles(mesh.corners[used], numbers.reshape(-1, 3))

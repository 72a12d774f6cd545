"""Fewer triangles for a picture, in which small ones are not seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.description.mesh_content import flat_normals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.description.mesh_content import Patch

# To write and load a million, and to draw them twice, takes 5 s.
BUDGET = 100_000  # triangles of a robot; a picture of 960 by 720 shows no more
FEW = 500  # a patch with no more is left as it is
SAMPLE = 4_000  # triangles of a patch from which is told how many will be left
FINEST = 1 / 2000  # of the largest patch: no cell is smaller
GROWTH = 1.25  # from one size of the cells to the next
CELLS = 2**20  # along each edge, so that a cell's number has 60 bits


class Drawn(NamedTuple):
    """A patch, and how a robot shows it."""

    patch: Patch
    times: int  # in so many places
    scale: float  # the largest of the three, without sign


def reduce_patches(drawn: Sequence[Drawn], budget: int = BUDGET) -> list[Patch]:
    """The patches, with no more triangles than a robot may have.

    The corners that lie in one cell of a grid become one, and what has no area then is left out.
    The cells are equally large in all patches, so that the robot is equally fine all over. Normals
    and texture points stay those of the corner.
    """
    if sum(len(one.patch.corners) * one.times for one in drawn) <= budget:
        return [one.patch for one in drawn]
    largest = max(one.scale * _extent(one.patch.corners) for one in drawn)
    samples = [_sample(one.patch.corners) for one in drawn]
    cell = largest * FINEST
    for _ in range(math.ceil(math.log(1 / FINEST, GROWTH))):
        left = sum(
            one.times * len(one.patch.corners) * _share_left(sample, cell / one.scale)
            for one, sample in zip(drawn, samples, strict=True)
        )
        if left <= budget:
            break
        cell *= GROWTH
    return [_clustered(one.patch, cell / one.scale) for one in drawn]


def _extent(corners: NDArray[Any]) -> float:
    points = corners.reshape(-1, 3)
    return max(float(points[:, axis].max() - points[:, axis].min()) for axis in range(3))


def _sample(corners: NDArray[Any]) -> NDArray[Any]:
    return corners[:: max(1, len(corners) // SAMPLE)]


def _share_left(corners: NDArray[Any], cell: float) -> float:
    """How many of the triangles have corners in three cells, 0 to 1."""
    return 1.0 if len(corners) <= FEW else float(_is_left(_cells(corners, cell)).mean())


def _clustered(patch: Patch, cell: float) -> Patch:
    if len(patch.corners) <= FEW:
        return patch
    cells = _cells(patch.corners, cell)
    left = np.flatnonzero(_is_left(cells))
    before = patch.corners[left]
    _, first, places = np.unique(cells[left].ravel(), return_index=True, return_inverse=True)
    corners = before.reshape(-1, 3)[first][places].reshape(-1, 3, 3)
    flat = flat_normals(before)
    # What has been turned over is a fold, and is not seen from the side that the surface is.
    is_upright = np.einsum("ij,ij->i", flat, flat_normals(corners)) > 0
    left, flat = left[is_upright], flat[is_upright]
    points = patch.texture_points
    return patch._replace(
        corners=corners[is_upright],
        normals=np.repeat(flat[:, None], 3, axis=1)
        if patch.normals is None
        else patch.normals[left],
        texture_points=None if points is None else points[left],
    )


def _cells(corners: NDArray[Any], cell: float) -> NDArray[np.int64]:
    """The number of the cell that each corner is in, shape (n, 3)."""
    numbers = np.zeros(corners.shape[:2], np.int64)
    for axis in range(3):
        along = corners[:, :, axis]
        steps = np.floor((along - along.min()) / cell).astype(np.int64)
        numbers = numbers * CELLS + np.minimum(steps, CELLS - 1)
    return numbers


def _is_left(cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    first, second, third = cells.T
    is_left: NDArray[np.bool_] = (first != second) & (second != third) & (third != first)
    return is_left

"""Which triangle is seen at a sample: against a slow calculation, for each kind of sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from wsgen.rendering.rasterizer import OFFSETS, Grid
from wsgen.rendering.renderer import nearness_of, triangles_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.rendering.rasterizer import Floats

WIDTH, HEIGHT = 40, 30


def drawn(grid: Grid, x: Floats, y: Floats, near: Floats) -> NDArray[np.uint64]:
    keys = np.zeros(grid.samples, dtype=np.uint64)
    grid.draw(keys, x, y, near, np.arange(x.shape[1]))
    return keys


def nearest(corners: Floats, column: float, row: float) -> tuple[int, float]:
    """The nearest triangle (x, y, near by 3 by n) at a point, and how near; -1 where none is."""
    x, y, near = corners.astype(np.float64)
    x, y = x - column, y - row
    weights = np.stack([x[a] * y[b] - x[b] * y[a] for a, b in ((1, 2), (2, 0), (0, 1))])
    inside = np.flatnonzero((weights > 0).all(axis=0) | (weights < 0).all(axis=0))
    if not len(inside):
        return -1, 0.0
    depth = (weights * near).sum(axis=0)[inside] / weights.sum(axis=0)[inside]
    return int(inside[depth.argmax()]), float(depth.max())


def some_triangles() -> Floats:
    """Small and large, in the picture and out of it, with sides along rows and without area."""
    rng = np.random.default_rng(1)
    middle = rng.uniform(-5, 45, (2, 1, 300))
    size = rng.choice([0.3, 2.0, 15.0, 200.0], 300, p=[0.4, 0.4, 0.18, 0.02])
    corners = np.empty((3, 3, 300), dtype=np.float32)
    corners[:2] = middle + rng.uniform(-1, 1, (2, 3, 300)) * size
    corners[2] = rng.uniform(0.1, 2.0, (3, 300))
    corners[1, 1, :40] = corners[1, 0, :40]  # a side along the rows
    corners[0, 1, 40:80] = corners[0, 0, 40:80]  # one upright
    corners[:2, 2, 80:100] = corners[:2, 1, 80:100]  # two corners at one place
    corners[1, :, 100:110] = corners[1, :1, 100:110]  # a line
    return corners


def test_each_pixel_shows_what_is_nearest_in_its_middle() -> None:
    corners = some_triangles()
    keys = drawn(Grid(WIDTH, HEIGHT), *corners).reshape(HEIGHT, WIDTH)
    for row in range(HEIGHT):
        for column in range(WIDTH):
            number, near = nearest(corners, column + 0.5, row + 0.5)
            key = keys[row, column]
            assert number == triangles_of(key)
            assert nearness_of(key) == pytest.approx(near, rel=1e-4)


@pytest.mark.parametrize("count", [2, 4])
def test_so_do_the_samples_of_chosen_pixels(count: int) -> None:
    corners = some_triangles()
    chosen = np.random.default_rng(2).random((HEIGHT, WIDTH)) < 0.2
    grid = Grid(WIDTH, HEIGHT, chosen, count)
    keys = drawn(grid, *corners).reshape(count, -1)
    columns, rows = (part.reshape(count, -1) for part in grid.places(np.arange(grid.samples)))
    for place, (row, column) in enumerate(np.argwhere(chosen)):
        for subrow in range(count):
            x, y = column + OFFSETS[count][subrow], row + (subrow + 0.5) / count
            assert (columns[subrow, place], rows[subrow, place]) == (x, y)
            number, near = nearest(corners, x, y)
            assert number == triangles_of(keys[subrow, place])
            assert nearness_of(keys[subrow, place]) == pytest.approx(near, rel=1e-4)


@pytest.mark.parametrize("step", [0.25, 0.5, 1.0, 3.7])  # corners and sides on samples, or not
def test_a_surface_has_neither_gaps_nor_overlaps(step: float) -> None:
    count = int(WIDTH / step) + 2
    places = np.arange(-1, count, dtype=np.float64) * step
    x, y = np.meshgrid(places, places)
    corners = [
        np.stack([part[:-1, :-1], part[:-1, 1:], part[1:, 1:], part[1:, :-1]]).reshape(4, -1)
        for part in (x, y)
    ]
    grid = Grid(WIDTH, HEIGHT)
    covered = np.zeros(grid.samples, dtype=int)
    halves = [np.array(corners)[:, order] for order in ([0, 1, 2], [0, 2, 3])]
    xs, ys = np.concatenate(halves, axis=2).astype(np.float32)
    for start in range(0, xs.shape[1], max(1, xs.shape[1] // 50)):
        stop = start + max(1, xs.shape[1] // 50)
        part = xs[:, start:stop], ys[:, start:stop]
        keys = drawn(grid, *part, np.ones_like(part[0]))
        covered += keys > 0
        alone = (
            sum(  # each by itself
                np.count_nonzero(drawn(grid, one, other, np.ones_like(one)))
                for one, other in zip(
                    np.split(part[0], part[0].shape[1], axis=1),
                    np.split(part[1], part[1].shape[1], axis=1),
                    strict=True,
                )
            )
            if start < 200
            else np.count_nonzero(keys)
        )
        assert alone == np.count_nonzero(keys)
    assert (covered == 1).all()

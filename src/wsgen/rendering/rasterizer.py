"""Which triangle is seen at each sample of an image, and how near it is: scanlines in NumPy.

A sample belongs to the triangle that its point lies in; one on the edge between two belongs to one
of them alone. Triangles become rows, rows become samples, and at each sample the nearest wins.

A number of 64 bits says what is seen at a sample. Its upper half is the nearness, a positive
single-precision number, whose bits grow with it; the lower one is the number of the triangle and 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Floats = NDArray[np.float32]
    Doubles = NDArray[np.float64]
    Indices = NDArray[np.intp]
    Keys = NDArray[np.uint64]

TRIANGLES, ROWS, SAMPLES = 2**16, 2**15, 2**17  # that are in memory at a time
# Where the samples are in the rows of a pixel that has so many of them: no two are above each
# other, so that upright edges get smooth, too.
OFFSETS = {2: np.array([0.25, 0.75]), 4: np.array([0.375, 0.875, 0.125, 0.625])}


class Grid:
    """The samples of an image: the middle of each pixel, or two or four in each of some pixels.

    The samples of the chosen pixels stand in the order of the pixels, once for each row of samples.
    """

    def __init__(
        self, width: int, height: int, chosen: NDArray[np.bool_] | None = None, rows: int = 4
    ) -> None:
        self.width, self.height = width, height
        self.rows = 1 if chosen is None else rows  # of samples, in one of pixels
        self._shift = self.rows.bit_length() - 1
        self.offsets = np.array([0.5]) if chosen is None else OFFSETS[rows]
        self.pixels: Indices | None = None  # the chosen ones, ascending
        self._before = self._inside = np.empty(0, dtype=np.int64)
        if chosen is not None:
            self.pixels = np.flatnonzero(chosen)
            self._columns = self.pixels % width
            counts = np.zeros((height, width + 1), dtype=np.int64)
            np.cumsum(chosen, axis=1, out=counts[:, 1:])
            ends = np.cumsum(counts[:, -1])
            self._before = (counts + (ends - counts[:, -1])[:, None]).ravel()  # a pixel, in its row
            inside = np.zeros((height + 1, width + 1), dtype=np.int64)
            np.cumsum(counts, axis=0, out=inside[1:])
            self._inside = inside.ravel()  # chosen ones above and left of a corner of pixels

    @property
    def samples(self) -> int:
        """How many there are."""
        pixels = self.width * self.height if self.pixels is None else len(self.pixels)
        return pixels * self.rows

    def places(self, samples: Indices) -> tuple[Floats, Floats]:
        """Where samples are: columns and rows of pixels, with fractions."""
        if self.pixels is None:
            row, column = np.divmod(samples.astype(np.int32), np.int32(self.width))
            return column + np.float32(0.5), row + np.float32(0.5)
        subrow, place = np.divmod(samples, len(self.pixels))
        row, column = np.divmod(self.pixels[place], self.width)
        x = (column + self.offsets[subrow]).astype(np.float32)
        return x, (row + (subrow + 0.5) / self.rows).astype(np.float32)

    def _may_cover(self, x: Floats, y: Floats) -> Indices:
        """Triangles (corners by 3, by n) whose box has a sample; `y` counts rows of samples."""
        left = _clipped(x.min(axis=0) - np.float32(self.offsets.max()), self.width)
        right = _clipped(x.max(axis=0) - np.float32(self.offsets.min()), self.width)
        top = _clipped(y.min(axis=0) - np.float32(0.5), self.height * self.rows)
        bottom = _clipped(y.max(axis=0) - np.float32(0.5), self.height * self.rows)
        found = np.flatnonzero((right > left) & (bottom > top))
        if self.pixels is None:
            return found
        left, right, top, bottom = (
            left[found],
            right[found],
            top[found] >> self._shift,
            bottom[found],
        )
        bottom = (bottom + self.rows - 1) >> self._shift
        above, below = top * (self.width + 1), bottom * (self.width + 1)
        count = self._inside[below + right] - self._inside[above + right]
        may_cover = count > self._inside[below + left] - self._inside[above + left]
        kept: Indices = found[may_cover]
        return kept

    def draw(  # noqa: PLR0913, PLR0917  corners, and which they are
        self,
        keys: Keys,
        x: Floats,
        y: Floats,
        near: Floats,
        numbers: Indices,
        turned: NDArray[np.bool_] | None = None,
    ) -> None:
        """Put triangles into what is seen.

        Args:
            keys: What is seen at each sample so far; 0 where nothing is.
            x: Columns of their corners, with fractions, 3 by n.
            y: Likewise rows.
            near: How near they are, above 0, linear in the image.
            numbers: The numbers of the triangles.
            turned: Which triangles are left out where their back is seen.
        """
        for start in range(0, x.shape[1], TRIANGLES):
            these = slice(start, start + TRIANGLES)
            rows = y[:, these] * np.float32(self.rows)
            found = self._may_cover(x[:, these], rows)
            corners = np.stack(
                [part.take(found, axis=1) for part in (x[:, these], rows, near[:, these])]
            )
            number = numbers[these][found]
            if turned is not None and len(found):
                (x0, x1, x2), (y0, y1, y2), _ = corners
                is_back = (x1 - x0) * (y2 - y0) > (x2 - x0) * (y1 - y0)
                kept = np.flatnonzero(~(is_back & turned[number]))
                corners, number = corners.take(kept, axis=2), number[kept]
            if len(number):
                self._draw(keys, _trapezoids(corners, self.height * self.rows), number)

    def _draw(self, keys: Keys, shapes: _Trapezoids, number: Indices) -> None:
        low = number.astype(np.uint64) + np.uint64(1)
        for part in _portions(shapes.rows, ROWS):
            counts = shapes.rows[part]
            row = np.arange(counts.sum()) + np.repeat(
                shapes.first[part] - np.cumsum(counts) + counts, counts
            )
            y = row + 0.5
            one, other = (
                np.repeat(start[part], counts) + np.repeat(slope[part], counts) * y
                for start, slope in (shapes.one, shapes.other)
            )
            pixel_row, subrow, offset = row, row, self.offsets[0]
            if self.pixels is not None:  # their number is a power of 2
                pixel_row, subrow = row >> self._shift, row & (self.rows - 1)
                offset = self.offsets.take(subrow)
            left = _clipped(np.minimum(one, other) - offset, self.width)
            right = _clipped(np.maximum(one, other) - offset, self.width)
            base = pixel_row * (self.width + (self.pixels is not None))
            first, last = base + left, base + right
            if self.pixels is not None:
                first, last = self._before[first], self._before[last]
            seen = np.flatnonzero(last > first)
            if not len(seen):
                continue
            triangle = np.repeat(shapes.triangle[part], counts)[seen]
            first, count, left = first[seen], (last - first)[seen], left[seen]
            if self.pixels is not None:
                offset = offset[seen]
                left = self._columns[first]
                first = first + subrow[seen] * len(self.pixels)
            grow = shapes.across[triangle]
            near = shapes.near[triangle] + grow * (left + offset) + shapes.down[triangle] * y[seen]
            lines = first, count, near.astype(np.float32), grow.astype(np.float32), low[triangle]
            for portion in _portions(count, SAMPLES):
                self._fill(keys, *(part[portion] for part in lines))

    def _fill(self, keys: Keys, *lines: Any) -> None:
        """Put rows of samples in: their first, how many, how near, its growth, the lower half."""
        first, count, near, grow, low = lines
        place = np.arange(count.sum())
        if self.pixels is None:
            steps = place - np.repeat(np.cumsum(count) - count, count)
            place += np.repeat(first - np.cumsum(count) + count, count)
        else:
            place += np.repeat(first - np.cumsum(count) + count, count)
            chosen = len(self.pixels)
            steps = self._columns[place % chosen]
            steps -= np.repeat(self._columns[first % chosen], count)
        depth = np.repeat(grow, count)
        depth *= steps
        depth += np.repeat(near, count)
        key = depth.view(np.uint32).astype(np.uint64)
        key <<= np.uint64(32)
        key |= np.repeat(low, count)
        np.maximum.at(keys, place, key)


class _Trapezoids(NamedTuple):
    """Halves of triangles, above and below their middle corner; a row lies between two lines."""

    first: Indices  # row of samples
    rows: Indices  # how many
    one: tuple[Doubles, Doubles]  # column of the left or right side at row 0, and its growth
    other: tuple[Doubles, Doubles]
    triangle: Indices  # of those that were given, to which the rest belongs:
    near: Doubles  # at column 0 of row 0
    across: Doubles  # how it grows from column to column
    down: Doubles  # and from row to row


def _trapezoids(corners: Floats, height: int) -> _Trapezoids:
    (x0, x1, x2), (y0, y1, y2), (near0, near1, near2) = corners.astype(np.float64)
    with np.errstate(all="ignore"):  # a side along the rows has no slope, and is not used
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        area[area == 0] = np.inf
        across = ((near1 - near0) * (y2 - y0) - (near2 - near0) * (y1 - y0)) / area
        down = ((near2 - near0) * (x1 - x0) - (near1 - near0) * (x2 - x0)) / area
        origin = near0 - across * x0 - down * y0
        x0, y0, x1, y1 = _sorted(x0, y0, x1, y1)
        x1, y1, x2, y2 = _sorted(x1, y1, x2, y2)
        x0, y0, x1, y1 = _sorted(x0, y0, x1, y1)
        # Of two triangles with a common side both compute the same line, so that no sample is lost.
        whole, upper, lower = (
            (xa - ya * (slope := (xb - xa) / (yb - ya)), slope)
            for xa, ya, xb, yb in ((x0, y0, x2, y2), (x0, y0, x1, y1), (x1, y1, x2, y2))
        )
    top, middle, bottom = (_clipped(edge - 0.5, height) for edge in (y0, y1, y2))
    count = np.concatenate([middle - top, bottom - middle])
    kept = np.flatnonzero(count)
    triangle = kept % len(y0)
    return _Trapezoids(
        np.concatenate([top, middle])[kept],
        count[kept],
        (whole[0][triangle], whole[1][triangle]),
        (
            np.concatenate([upper[0], lower[0]])[kept],
            np.concatenate([upper[1], lower[1]])[kept],
        ),
        triangle,
        origin,
        across,
        down,
    )


def _sorted(
    xa: Doubles, ya: Doubles, xb: Doubles, yb: Doubles
) -> tuple[Doubles, Doubles, Doubles, Doubles]:
    """Two corners, the upper one first."""
    is_right = ya <= yb
    return (
        np.where(is_right, xa, xb),
        np.minimum(ya, yb),
        np.where(is_right, xb, xa),
        np.maximum(ya, yb),
    )


def _clipped(place: NDArray[Any], most: int) -> Indices:
    """The first sample at or behind a place, 0 to `most`."""
    ahead = np.ceil(place)
    first: Indices = np.clip(ahead, 0, most, out=ahead).astype(np.intp)
    return first


def _portions(counts: Indices, limit: int) -> Iterator[slice]:
    """Slices of what has so many parts each; none has many more than the limit."""
    ends = np.cumsum(counts)
    start = 0
    while start < len(counts):
        done = ends[start] - counts[start]
        stop = max(start + 1, int(np.searchsorted(ends, done + limit, side="right")))
        yield slice(start, stop)
        start = stop

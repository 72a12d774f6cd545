"""Lines of OBJ files that hold numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.description.mesh_content import BrokenMeshError, parse_floats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


def read_rows(lines: Sequence[bytes], width: int, what: str) -> NDArray[np.float64]:
    """The first numbers of each line behind its keyword, shape (n, width).

    A line may have more: a weight or a colour behind the coordinates. `what` it is, for messages.
    """
    numbers = parse_floats(b"".join([line[line.index(b" ") :] for line in lines]), f"a {what}")
    found, rest = divmod(len(numbers), len(lines) or 1)
    if found >= width and not rest and _have_equal_widths(lines, found, width):
        return numbers.reshape(-1, found)[:, :width]
    rows = [line.split()[1 : width + 1] for line in lines]
    if any(len(row) < width for row in rows):
        few = ("no", "one", "two", "three")[width]
        raise BrokenMeshError(f"has a {what} with fewer than {few} numbers")
    return np.array(rows, dtype=np.float64).reshape(-1, width)


def _have_equal_widths(lines: Sequence[bytes], found: int, width: int) -> bool:
    """Whether each line has so many numbers, given that all together have that many on average."""
    if found == width:  # nothing has fewer, so nothing has more
        return all(len(line.split(None, width)) > width for line in lines)
    return all(len(line.split()) == found + 1 for line in lines)


def made_absolute(
    indices: NDArray[np.int64], lines: Sequence[bytes], keyword: bytes
) -> NDArray[np.int64]:
    """Negative indices count back from the last row with that keyword that stands before the face.

    Args:
        indices: Those of all faces, one after the other.
        lines: The lines of the file.
        keyword: What the rows that they count begin with, with the blank behind it.
    """
    if not indices.size or indices.min() >= 0:
        return indices
    seen = 0
    before = []
    for line in lines:
        if line.startswith(keyword):
            seen += 1
        elif line.startswith(b"f "):
            before += [seen] * (len(line.split()) - 1)
    return np.where(indices < 0, indices + np.array(before) + 1, indices)

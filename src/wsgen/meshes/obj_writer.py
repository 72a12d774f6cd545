"""Writes what a renderer is to draw, as OBJ."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.meshes.content import flat_normals

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.meshes.content import Patch


DIGITS = 6  # of each number: a millionth of the mesh's size
NORMAL_DIGITS = 3
INDEX_DIGITS = 7  # of indices, which are at most three million


def write_obj(patch: Patch, scale: tuple[float, float, float], file: Path) -> None:
    """Write triangles with normals, and with texture points if they have any.

    PyBullet multiplies points with a scale, and leaves normals and the order of corners as they
    are; so these are written as they must be for that `scale`. A texture is repeated where its
    points are beyond 0 and 1, but PyBullet does so above 1 alone.
    """
    corners, points = patch.corners, patch.texture_points
    normals = _scaled(_normals(patch), scale)
    if math.prod(scale) < 0:  # seen from the other side
        corners, normals = corners[:, ::-1], normals[:, ::-1]
        points = None if points is None else points[:, ::-1]
    columns = [corners.reshape(-1, 3), normals.reshape(-1, 3)]
    keywords = [(b"v", DIGITS), (b"vn", NORMAL_DIGITS)]
    if points is not None:
        points = points - np.floor(points.min(axis=1, keepdims=True))
        columns.insert(1, points.reshape(-1, 2))
        keywords.insert(1, (b"vt", DIGITS))
    with file.open("wb") as stream:
        indices = []
        for rows, (keyword, digits) in zip(columns, keywords, strict=True):
            mantissas, exponent = _mantissas(rows, digits)
            found, places = _unique_rows(mantissas)
            stream.write(_lines(keyword, found, digits, exponent))
            indices.append(places + 1)
        stream.write(_faces(indices))


def _normals(patch: Patch) -> NDArray[np.float64]:
    """Unit vectors, shape (n, 3, 3), on the side from which the triangles are seen."""
    flat = np.repeat(flat_normals(patch.corners)[:, None], 3, axis=1)
    flat[(flat == 0).all(axis=-1)] = (0.0, 0.0, 1.0)  # nothing is seen of it
    if patch.normals is None:
        return flat
    with np.errstate(all="ignore"):
        lengths = np.sqrt(np.einsum("ijk,ijk->ij", patch.normals, patch.normals))
        normals = patch.normals / lengths[..., None]
    normals = np.where(np.isfinite(normals).all(axis=-1, keepdims=True), normals, flat)
    is_behind = np.einsum("ijk,ijk->ij", normals, flat) < 0
    return np.where(is_behind[..., None], -normals, normals)


def _scaled(normals: NDArray[np.float64], scale: tuple[float, float, float]) -> NDArray[np.float64]:
    """Unit vectors that are upright on surfaces of that scale."""
    if len(set(scale)) == 1 and scale[0] > 0:
        return normals
    divisor = [part if math.isfinite(part) and part else 1.0 for part in scale]
    turned = normals / np.array(divisor)
    unit: NDArray[np.float64] = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
    return unit


def _mantissas(rows: NDArray[Any], digits: int) -> tuple[NDArray[np.int64], int]:
    """Whole numbers of so many digits that times 10 to the exponent are the numbers."""
    largest = float(np.abs(rows).max())
    exponent = math.floor(math.log10(largest)) + 1 - digits if largest > 0 else 0
    limit = 10**digits - 1
    mantissas = np.rint(rows * 10.0**-exponent).clip(-limit, limit).astype(np.int64)
    return mantissas, exponent


def _unique_rows(rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The different rows, and for each row which of them it is; the order does not matter."""
    keys = np.zeros(len(rows), np.int64)
    for column in rows.T:
        keys = keys * (2 * 10**DIGITS) + column + 10**DIGITS
    _, first, places = np.unique(keys, return_index=True, return_inverse=True)
    return rows[first], places


def _lines(keyword: bytes, rows: NDArray[np.int64], digits: int, exponent: int) -> bytes:
    """A line for each row: the keyword, and whole numbers with an exponent."""
    suffix = np.frombuffer(b"e%d" % exponent, np.uint8)
    width = 2 + digits + len(suffix)  # a blank, a sign, digits, the exponent
    text = np.full((len(rows), len(keyword) + rows.shape[1] * width + 1), ord(" "), np.uint8)
    text[:, : len(keyword)] = np.frombuffer(keyword, np.uint8)
    for at, column in enumerate(rows.T):
        start = len(keyword) + at * width + 1
        text[:, start] = np.where(column < 0, ord("-"), ord("0"))
        _put(text[:, start + 1 : start + 1 + digits], np.abs(column))
        text[:, start + 1 + digits : start + width - 1] = suffix
    text[:, -1] = ord("\n")
    return text.tobytes()


def _faces(indices: list[NDArray[np.int64]]) -> bytes:
    """A line for each three corners; `indices` of points, texture points, normals."""
    separators = ["/", "/"] if len(indices) == 3 else ["//"]  # noqa: PLR2004  the three of these
    corner = b" " + b"".join(
        b"0" * INDEX_DIGITS + separator.encode() for separator in (*separators, "")
    )
    line = b"f" + corner * 3 + b"\n"
    text = np.tile(np.frombuffer(line, np.uint8), (len(indices[0]) // 3, 1))
    for number in range(3):
        start = 2 + number * len(corner)
        for column, separator in zip(indices, (*separators, ""), strict=True):
            _put(text[:, start : start + INDEX_DIGITS], column[number::3])
            start += INDEX_DIGITS + len(separator)
    return text.tobytes()


def _put(text: NDArray[np.uint8], numbers: NDArray[np.int64]) -> None:
    """Write numbers of 0 or more in decimals, one for each row, as wide as the rows are."""
    for place in range(text.shape[1] - 1, -1, -1):
        numbers, digit = np.divmod(numbers, 10)
        text[:, place] = digit + ord("0")

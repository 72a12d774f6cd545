"""What is in a mesh file, and what keeps one from being used."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.text.suggestions import some_named

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsgen.descriptions.meshes.requests import MaterialProblem, Rgba
    from wsgen.model.transform import Vector


FILE_LIMIT = 100 * 10**6  # bytes; a million triangles are 50 MB of STL
TRIANGLE_LIMIT = 1_000_000  # an engine takes about 10 s to load them
REDUCE = "Reduce it to some thousand triangles; for a <collision>, boxes or cylinders are best."
EXPORT_AGAIN = "Export the mesh again, as binary STL or as OBJ."


class BrokenMeshError(Exception):
    """Why a mesh cannot be used: goes on after its name. It never leaves the child process."""

    def __init__(self, problem: str, *, hint: str = EXPORT_AGAIN) -> None:
        super().__init__(problem)
        self.problem = problem
        self.hint = hint


class EnormousMeshError(BrokenMeshError):
    """The mesh is more than a simulator can be expected to load."""

    def __init__(self, problem: str) -> None:
        super().__init__(problem, hint=REDUCE)


def damaged(kind: str) -> BrokenMeshError:
    """The error about a file in which a reader finds what no such file has."""
    return BrokenMeshError(f"is not a valid {kind.upper()} file: it is cut short or damaged")


LFS_POINTER = b"version https://git-lfs.github.com/spec/"


def refuse_lfs_pointer(data: bytes) -> None:
    """Raise BrokenMeshError for what stands in a repository for a file that git has elsewhere."""
    if data.startswith(LFS_POINTER):
        raise BrokenMeshError(
            "is a Git LFS pointer instead of the file",
            hint="Download the file: run `git lfs install`, then `git lfs pull`.",
        )


MOST_PARTS = 5  # are named


def check_part(part: str, parts: Iterable[str]) -> None:
    """Raise BrokenMeshError where a file does not have the part of that name."""
    named = sorted(set(parts))
    if part in named:
        return
    some = some_named(named, MOST_PARTS)
    raise BrokenMeshError(
        f"has no part `{part}`, which <submesh> names: Gazebo does not create it",
        hint=f"Write the name of one of its parts: {some}."
        if some
        else "Remove <submesh>: the parts of the file have no names.",
    )


def refuse_triangles(count: int) -> None:
    """Raise EnormousMeshError for more triangles than a mesh may have."""
    if count > TRIANGLE_LIMIT:
        raise EnormousMeshError(
            f"has {count:,} triangles or more; an engine needs 10 s to load {TRIANGLE_LIMIT:,}"
        )


class Material(NamedTuple):
    """What a surface looks like; a texture is multiplied with the color."""

    rgba: Rgba | None = None  # 0 to 1; None: the simulator's default
    image: Any = None  # the address that the mesh file gives, or an opened Pillow image


class Patch(NamedTuple):
    """Triangles of one material."""

    corners: NDArray[Any]  # (n, 3, 3): three corners' x, y, z; m, unscaled; seen counter-clockwise
    normals: NDArray[Any] | None = None  # (n, 3, 3), of any length; None: those of the triangles
    texture_points: NDArray[Any] | None = None  # (n, 3, 2): 0 0 is the image's lower left corner
    material: Material = Material()


class Content(NamedTuple):
    """The triangles of a mesh, as Gazebo reads them."""

    corners: NDArray[Any]  # (n, 3, 3), float: of each triangle three corners' x, y, z; m, unscaled
    is_plain: bool = True  # PyBullet reads the same from the file
    cleaned: bytes | None = None  # to be read in the place of the file, which names other files
    inconsistency: str | None = None  # a problem that Gazebo reads over; goes on after the name
    # The rest is there where the materials were asked for:
    patches: tuple[Patch, ...] = ()  # all the triangles, by material
    material_problems: tuple[MaterialProblem, ...] = ()


def parse_floats(text: str | bytes, what: str) -> NDArray[np.float64]:
    """The numbers of a text; `what` it is, for the message if something else is among them."""
    return _parse(text, what, "numbers", np.float64)


def parse_integers(text: str | bytes, what: str) -> NDArray[np.int64]:
    """The whole numbers of a text, as `parse_floats`."""
    return _parse(text, what, "whole numbers", np.int64)


def _parse(text: str | bytes, what: str, kind: str, dtype: type[Any]) -> NDArray[Any]:
    if not text or text.isspace():
        return np.empty(0, dtype)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # numpy stops at what is no number, and only warns
        try:
            return np.fromstring(text, dtype=dtype, sep=" ")
        except (DeprecationWarning, ValueError):
            raise BrokenMeshError(f"contains something other than {kind} in {what}") from None


def bounds_of(corners: NDArray[Any]) -> tuple[Vector, Vector]:
    """The corners of the box around triangles, shape (n, 3, 3), n at least 1."""
    points = corners.reshape(-1, 3)
    # A column at a time: over rows of three numpy is twenty times as slow.
    columns = [points[:, axis] for axis in range(3)]
    x, y, z = (float(column.min()) for column in columns)
    far_x, far_y, far_z = (float(column.max()) for column in columns)
    return (x, y, z), (far_x, far_y, far_z)


def flat_normals(corners: NDArray[Any]) -> NDArray[np.float64]:
    """Of triangles, shape (n, 3, 3), seen counter-clockwise: unit vectors, 0 where it has no area.

    Gives shape (n, 3).
    """
    first, second, third = (corners[:, at].astype(np.float64) for at in range(3))
    a, b = (second - first).T, (third - first).T  # by column: over rows numpy is slow
    with np.errstate(all="ignore"):  # a corner may be at no finite place
        x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
        lengths = np.sqrt(x * x + y * y + z * z)
        lengths[lengths == 0] = 1.0
        return np.stack([x / lengths, y / lengths, z / lengths], axis=-1)


def triangulate(indices: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut polygons into fans of triangles.

    Args:
        indices: The corners of all polygons, one after the other.
        sizes: How many corners each polygon has; their sum is the number of `indices`.

    Returns:
        Indices, shape (n, 3). What has fewer than three corners is left out.
    """
    starts = np.cumsum(sizes) - sizes
    parts = [np.empty((0, 3), np.int64)]
    for size in np.unique(sizes):
        if size >= 3:  # noqa: PLR2004  corners of a triangle
            polygons = indices[starts[sizes == size][:, None] + np.arange(size)]
            parts += [polygons[:, [0, at, at + 1]] for at in range(1, size - 1)]
    return np.concatenate(parts)

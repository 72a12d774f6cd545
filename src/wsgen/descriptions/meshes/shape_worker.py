"""The child process that makes meshes of the shapes that no engine has.

Outlines become triangles with Shapely; the surface of a heightmap is as in Gazebo Sim's physics.
"""

from __future__ import annotations

import warnings
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import shapely
from PIL import Image

from wsgen.descriptions.meshes.content import (
    LFS_POINTER,
    BrokenMeshError,
    bounds_of,
    refuse_lfs_pointer,
)
from wsgen.descriptions.meshes.requests import BuiltShape, UnbuildableShape
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.isolation.child import announce
from wsgen.model.robot import Ellipsoid, Extrusion, Heightmap
from wsgen.text.files import irregular_kind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Cone, Triangulated


DRAW_ANEW = "Write each outline as a simple polygon that does not touch itself or another one."


def extrusion_triangles(extrusion: Extrusion) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m, counter-clockwise seen from outside.

    Raises:
        BrokenMeshError: Outlines touch or cross themselves or each other; Gazebo makes nothing of
            such ones.
    """
    rings = [shapely.Polygon(outline) for outline in extrusion.outlines]
    for number, ring in enumerate(rings, 1):
        if not ring.is_valid or ring.area == 0:
            raise BrokenMeshError(
                f"has an outline (number {number}) that does not enclose an area or crosses itself "
                f"({shapely.is_valid_reason(ring)})",
                hint=DRAW_ANEW,
            )
    if any(one.boundary.intersects(other.boundary) for one, other in combinations(rings, 2)):
        raise BrokenMeshError("has outlines that touch or cross each other", hint=DRAW_ANEW)
    # What is inside of an even number of them is outside.
    inside: Any = rings[0]
    for ring in rings[1:]:
        inside = shapely.symmetric_difference(inside, ring)
    area = shapely.orient_polygons(inside)
    floor = _floor(area)
    top = np.concatenate([floor, np.full((*floor.shape[:2], 1), extrusion.height)], axis=2)
    bottom = np.concatenate([floor[:, ::-1], np.zeros((*floor.shape[:2], 1))], axis=2)
    return np.concatenate([top, bottom, *_walls(area, extrusion.height)])


def _floor(area: Any) -> NDArray[Any]:
    """The area as triangles in the plane, shape (n, 3, 2), counter-clockwise."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    return np.array([shapely.get_coordinates(shapely.orient_polygons(t))[:3] for t in triangles])


def _walls(area: Any, height: float) -> Iterator[NDArray[Any]]:
    """Above the rings of the area; it is to the left of each of them."""
    up = np.array([0.0, 0.0, height])
    for ring in shapely.get_rings(shapely.get_parts(area)):
        points = shapely.get_coordinates(ring)  # the last is the first again
        low = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
        high = low + up
        yield np.stack([low[:-1], low[1:], high[1:]], axis=1)
        yield np.stack([low[:-1], high[1:], high[:-1]], axis=1)


MOST_PIXELS = 4097  # on a side; Gazebo's rendering has no larger tile either
MOST_ROWS = 513  # of corners: half a million triangles, for which an engine takes a second
EIGHT_BITS = 255.0
SIXTEEN_BITS = 65535.0
REDUCE = "Scale it down: one pixel per wheel size is enough for a simulation."
SAVE_AGAIN = "Save it again as a grayscale PNG, with 2ⁿ + 1 pixels on each side (129, 257, 513, …)."


class Surface(NamedTuple):
    """A heightmap as triangles."""

    corners: NDArray[Any]  # (n, 3, 3), m, counter-clockwise seen from above
    pixels: int  # of the image, on a side
    rows: int  # of corners


def heightmap_surface(heightmap: Heightmap) -> Surface:
    """Its surface, without its offset `pos`.

    One row of pixels is that row's share of the size: the outermost are half a share away from
    the border. Between four pixels the surface folds along the diagonal from low x and y to high
    ones.

    Raises:
        BrokenMeshError: The image cannot be used.
    """
    brightness, brightest = _read(Path(heightmap.path or ""))
    pixels = len(brightness)
    count = (pixels - 1) * heightmap.sampling + 1  # of corners on a side in Gazebo
    kept = np.unique(np.linspace(0, count - 1, min(count, MOST_ROWS)).round().astype(np.int64))
    heights = _between(brightness, kept / heightmap.sampling)
    width, depth, height = heightmap.size
    heights *= abs(height) / brightest if brightest else 1.0
    if height < 0:  # what Gazebo does; it makes sense for a height of 1 m alone
        heights = 1.0 - heights
    shares = (kept - (count - 1) / 2) / count
    points = np.empty((len(kept), len(kept), 3))
    points[..., 0] = shares * width
    points[..., 1] = -(shares * depth)[:, None]
    points[..., 2] = heights
    above, below = points[:-1], points[1:]
    upper_left, upper_right = above[:, :-1], above[:, 1:]
    lower_left, lower_right = below[:, :-1], below[:, 1:]
    corners = np.concatenate(
        [
            np.stack([lower_left, upper_right, upper_left], axis=2),
            np.stack([lower_left, lower_right, upper_right], axis=2),
        ]
    )
    return Surface(corners.reshape(-1, 3, 3), pixels, len(kept))


def _read(file: Path) -> tuple[NDArray[Any], float]:
    """The brightness of each pixel, 0 to 1, and that of the brightest.

    It is that of the red channel; which pixel is the brightest is checked by all channels.
    """
    kind = irregular_kind(file)
    if kind is not None:
        raise BrokenMeshError(f"is {kind}", hint=SAVE_AGAIN)
    try:
        with file.open("rb") as content:
            refuse_lfs_pointer(content.read(len(LFS_POINTER)))
        pixels = _load(file)
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise BrokenMeshError("has a hundred million pixels or more", hint=REDUCE) from None
    except (BrokenMeshError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  Pillow raises anything on broken images
        raise BrokenMeshError(
            "is not a valid PNG or JPEG file: it is cut short or damaged", hint=SAVE_AGAIN
        ) from None
    if pixels.ndim == 2:  # noqa: PLR2004  16 bits, grey
        grey = pixels / SIXTEEN_BITS
        return grey, float(grey.max())
    red, green, blue = (pixels[..., channel] for channel in range(3))
    brightest = np.argmax(red.astype(np.uint16) + green + blue)
    return red / EIGHT_BITS, float(red.flat[brightest] / EIGHT_BITS)


def _load(file: Path) -> NDArray[Any]:
    """The pixels: 16 bits in rows and columns, or 8 bits with channels as third axis."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        with Image.open(file, formats=("PNG", "JPEG")) as image:
            _refuse_shape(*image.size)
            return np.asarray(image if image.mode.startswith("I") else image.convert("RGB"))


def _refuse_shape(width: int, height: int) -> None:
    if width != height or width < 2:  # noqa: PLR2004  a surface begins between two rows
        raise BrokenMeshError(
            f"has {width} × {height} pixels: Gazebo exits with an error on an image that is not "
            "square or has a single pixel",
            hint=SAVE_AGAIN,
        )
    if width > MOST_PIXELS:
        raise BrokenMeshError(
            f"has {width} × {height} pixels, more than {MOST_PIXELS} × {MOST_PIXELS}",
            hint=REDUCE,
        )


def _between(brightness: NDArray[Any], places: NDArray[Any]) -> NDArray[Any]:
    """The brightness at places in rows and columns, linearly between the pixels."""
    low = np.floor(places).astype(np.int64)
    high = np.ceil(places).astype(np.int64)
    share = places - low
    rows = brightness[low] * (1 - share)[:, None] + brightness[high] * share[:, None]
    between: NDArray[Any] = rows[:, low] * (1 - share) + rows[:, high] * share
    return between


AROUND = 48  # corners of a circle: what rolls deviates by 0.2 % of the radius
UP = 24  # steps from pole to pole


def ellipsoid_triangles(ellipsoid: Ellipsoid) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m; the ends of its axes are corners."""
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, UP + 1)
    triangles = _turned(np.cos(latitudes), np.sin(latitudes))
    triangles *= ellipsoid.radii
    return triangles


def cone_triangles(cone: Cone) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m."""
    half = cone.length / 2
    return _turned(np.array([0.0, cone.radius, 0.0]), np.array([-half, -half, half]))


def _turned(radii: NDArray[Any], heights: NDArray[Any]) -> NDArray[Any]:
    """A profile, from below upwards, turned about z; triangles without extent are left out."""
    angles = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    rings = np.empty((len(radii), AROUND, 3))
    rings[..., 0] = radii[:, None] * np.cos(angles)
    rings[..., 1] = radii[:, None] * np.sin(angles)
    rings[..., 2] = heights[:, None]
    rings[radii < 1e-9 * radii.max(), :, :2] = 0.0  # a pole is one point
    low, high = rings[:-1], rings[1:]
    next_low, next_high = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    triangles = np.concatenate(
        [np.stack([low, next_low, next_high], axis=2), np.stack([low, next_high, high], axis=2)]
    ).reshape(-1, 3, 3)
    edges = np.diff(triangles, axis=1)
    return triangles[np.cross(edges[:, 0], edges[:, 1]).any(axis=1)]


def build(shapes: Sequence[Triangulated], folder: Path) -> list[BuiltShape | UnbuildableShape]:
    """Write a binary STL file of each shape into a folder; announces the number of the one."""
    answers: list[BuiltShape | UnbuildableShape] = []
    for number, shape in enumerate(shapes):
        announce(str(number))
        try:
            answers.append(_write(shape, folder / f"{number}.stl"))
        except BrokenMeshError as error:
            answers.append(UnbuildableShape(problem=error.problem, hint=error.hint))
    return answers


def _write(shape: Triangulated, file: Path) -> BuiltShape:
    pixels = rows = 0
    if isinstance(shape, Heightmap):
        corners, pixels, rows = heightmap_surface(shape)
    elif isinstance(shape, Extrusion):
        corners = extrusion_triangles(shape)
    elif isinstance(shape, Ellipsoid):
        corners = ellipsoid_triangles(shape)
    else:
        corners = cone_triangles(shape)
    write_stl(corners, file)
    low, high = bounds_of(corners.astype(np.float32))
    return BuiltShape(path=str(file), low=low, high=high, pixels=pixels, rows=rows)

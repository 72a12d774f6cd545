"""A camera, placed so that it sees all of something as large as possible."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.values import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.transform import Vector

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from, as renderers want it (OpenGL's conventions)."""

    eye: Vector  # m
    target: Vector  # m
    up: Vector  # a direction that is up in the picture
    field_of_view: float  # degrees, vertical
    aspect: float  # width over height
    near: float  # m
    far: float  # m
    width: int  # pixels to render
    height: int


@dataclass(frozen=True)
class Shot:
    """What a renderer saw through a camera."""

    camera: Camera
    view: tuple[float, ...]  # 4 by 4, column-major: world to camera
    projection: tuple[float, ...]  # 4 by 4, column-major: camera to clip space
    rgba: NDArray[np.uint8]  # height by width by 4
    depth: NDArray[np.float32]  # height by width, 0 to 1, of the depth buffer
    body: NDArray[np.int32]  # height by width; negative where nothing is seen


FIELD_OF_VIEW = 32.0  # degrees, vertical
FROM: Vector = (0.72, -0.62, 0.36)  # direction from the robot to the camera: three-quarter view
MARGIN = 0.08  # of the picture's width or height, on either side

SUN_FIELD_OF_VIEW = 3.0  # degrees; so far away its rays are nearly parallel
SUN_MARGIN = 0.03

SMALLEST = 1e-4  # m; what is smaller is a point
AROUND_A_POINT = 0.5  # m
CUT_AWAY = 0.95  # of the distance to what is nearest of the subject: what is before it is not drawn
NEAREST = 1e-3  # of the distance to the subject: a depth buffer resolves no wider range


@dataclass(frozen=True)
class Size:
    """Of a picture, in pixels."""

    width: int
    height: int


def extent(points: Floats) -> float:
    """The longest edge of the box around points (n by 3), m, or what is seen around one point."""
    edge = float(np.ptp(points, axis=0).max())
    return edge if edge >= SMALLEST else 2 * AROUND_A_POINT


def eye_camera(
    points: Floats, size: Size, *, behind: Floats | None = None, towards: Vector = FROM
) -> Camera:
    """A camera that has all points (n by 3, m, in the world) within the margin.

    It is `towards` a direction from them, and sees what is `behind` and around them, too, but
    nothing that is in front of them.
    """
    return _camera(_padded(points), towards, FIELD_OF_VIEW, size, MARGIN, behind=behind)


def sun_camera(points: Floats, towards: Vector, pixels: int) -> Camera:
    """A camera at a sun in this direction from the points."""
    size = Size(pixels, pixels)
    return _camera(_padded(points), towards, SUN_FIELD_OF_VIEW, size, SUN_MARGIN)


def _padded(points: Floats) -> Floats:
    if np.ptp(points, axis=0).max() >= SMALLEST:
        return points
    return np.vstack([points - AROUND_A_POINT, points + AROUND_A_POINT])


def _camera(  # noqa: PLR0913  an optical set-up has this many parts
    points: Floats,
    towards: Vector,
    field_of_view: float,
    size: Size,
    margin: float,
    *,
    behind: Floats | None = None,
) -> Camera:
    """The nearest camera that looks along a direction and has all points in its picture.

    Seen from anywhere along that direction a point at depth z keeps within the picture's sides if
    |x - x of the camera| is at most (z - z of the camera) times a slope. The sides that the
    outermost points put up are straight lines in the plane of x and z, and where they cross is the
    nearest place for the camera. Likewise for y; the farther of the two places is taken.
    """
    axes = view_axes(towards)
    center = points.mean(axis=0)  # far from the origin digits would be lost
    x, y, z = axes @ (points - center).T
    slope_y = math.tan(math.radians(field_of_view / 2)) * (1 - 2 * margin)
    slope_x = slope_y * size.width / size.height
    left, right = (x - slope_x * z).max(), (x + slope_x * z).min()
    low, high = (y - slope_y * z).max(), (y + slope_y * z).min()
    depth = min((right - left) / (2 * slope_x), (high - low) / (2 * slope_y))
    eye = np.array([(left + right) / 2, (low + high) / 2, depth])
    nearest, middle = z.min() - depth, (z.min() + z.max()) / 2 - depth
    farther = [] if behind is None else (axes[2] @ (behind - center).T - depth).tolist()
    return Camera(
        eye=_vector(axes.T @ eye + center),
        target=_vector(axes.T @ (eye + np.array([0, 0, middle])) + center),
        field_of_view=field_of_view,
        aspect=size.width / size.height,
        up=_vector(axes[1]),
        near=max(float(nearest) * CUT_AWAY, float(middle) * NEAREST),
        far=max(float(z.max() - depth) * 1.05, *farther, float(middle) * 1.05),
        width=size.width,
        height=size.height,
    )


def view_axes(towards: Vector) -> Floats:
    """Right, up and forward of a camera that is in this direction, as rows."""
    forward = -np.array(towards) / np.linalg.norm(towards)
    aside = (0.0, 0.0, 1.0) if abs(forward[2]) < 0.999 else (0.0, 1.0, 0.0)  # noqa: PLR2004
    right = np.cross(forward, aside)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, forward), forward])


def _vector(numbers: Floats) -> Vector:
    return (float(numbers[0]), float(numbers[1]), float(numbers[2]))


def matrix(column_major: tuple[float, ...]) -> Floats:
    """The 4 by 4 matrix of OpenGL's sixteen numbers."""
    square: Floats = np.array(column_major, dtype=float).reshape(4, 4).T
    return square

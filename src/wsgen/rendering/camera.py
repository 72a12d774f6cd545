"""Where cameras stand: what they see of points in the world, and where the sun sees them from.

On a slope gravity is tilted and the ground of the world is level. A picture in which gravity points
down is drawn as seen by a camera whose right is level in the world, larger than it is wanted, and
then turned.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PIL import Image

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsgen.model.transform import Vector

    Floats = NDArray[np.float64]
    Floats32 = NDArray[np.float32]


class View(NamedTuple):
    """How points become places in an image: `matrix` times (point - origin) gives x, y and z.

    With perspective the place is x / z and y / z from the middle, in pixels to the right and
    downwards, and the nearness 1 / z; without, it is x and y, and the nearness z.
    """

    matrix: Floats  # 3 by 3
    origin: Floats  # m, in the world
    width: int  # pixels
    height: int
    nearest: float | None  # z before which nothing is seen; None: no perspective

    @property
    def axis(self) -> Floats:
        """The direction in which it looks, in the world."""
        axis: Floats = self.matrix[2] / np.linalg.norm(self.matrix[2])
        return axis if self.nearest is not None else -axis

    def project(self, points: Floats32) -> tuple[Floats32, Floats32, Floats32]:
        """Columns, rows and nearness of points in the view (3 by any shape)."""
        x, y, z = points
        if self.nearest is not None:
            z = 1 / z
            x, y = x * z, y * z
        else:
            z = np.maximum(z, np.float32(1e-30))
        return x + np.float32(self.width / 2), y + np.float32(self.height / 2), z


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from; its pixels are squares."""

    eye: Vector  # m
    target: Vector  # m
    field_of_view: float  # degrees, vertical
    near: float  # m; nothing nearer is seen
    far: float  # m; of what is seen nothing is farther away
    width: int  # pixels
    height: int

    @property
    def aspect(self) -> float:
        """Width over height."""
        return self.width / self.height

    @property
    def axes(self) -> Floats:
        """Right, up and forward, as rows."""
        return view_axes(_vector(np.subtract(self.eye, self.target)))

    @property
    def view(self) -> View:
        """The same as a matrix; its z is the depth, m."""
        focal = self.height / 2 / math.tan(math.radians(self.field_of_view / 2))  # pixels
        matrix = self.axes * np.array([[focal], [-focal], [1.0]])
        return View(matrix, np.array(self.eye), self.width, self.height, self.near)


FIELD_OF_VIEW = 32.0  # degrees, vertical
FROM: Vector = (0.72, -0.62, 0.36)  # direction from the robot to the camera: three-quarter view
MARGIN = 0.08  # of the picture's width or height, on either side

SUN_MARGIN = 0.04
SUN_REACH = 100.0  # sizes of what it shines on: what is farther behind is not distinguished

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
    points: Floats, size: Size, *, behind: Iterable[Floats] = (), towards: Vector = FROM
) -> Camera:
    """A camera that has all points (n by 3, m, in the world) within the margin.

    It is `towards` a direction from them, and sees what is `behind` and around them, too, but
    nothing that is in front of them.

    Seen from anywhere along that direction a point at depth z keeps within the picture's sides if
    |x - x of the camera| is at most (z - z of the camera) times a slope. The sides that the
    outermost points put up are straight lines in the plane of x and z, and where they cross is the
    nearest place for the camera. Likewise for y; the farther of the two places is taken.
    """
    points = _padded(points)
    axes = view_axes(towards)
    center = points.mean(axis=0)  # far from the origin digits would be lost
    x, y, z = axes @ (points - center).T
    slope_y = math.tan(math.radians(FIELD_OF_VIEW / 2)) * (1 - 2 * MARGIN)
    slope_x = slope_y * size.width / size.height
    left, right = (x - slope_x * z).max(), (x + slope_x * z).min()
    low, high = (y - slope_y * z).max(), (y + slope_y * z).min()
    depth = min((right - left) / (2 * slope_x), (high - low) / (2 * slope_y))
    eye = np.array([(left + right) / 2, (low + high) / 2, depth])
    nearest, middle = z.min() - depth, (z.min() + z.max()) / 2 - depth
    farther = [float((one @ axes[2]).max() - axes[2] @ center - depth) for one in behind]
    return Camera(
        eye=_vector(axes.T @ eye + center),
        target=_vector(axes.T @ (eye + np.array([0, 0, middle])) + center),
        field_of_view=FIELD_OF_VIEW,
        near=max(float(nearest) * CUT_AWAY, float(middle) * NEAREST),
        far=max(float(z.max() - depth) * 1.05, *farther, float(middle) * 1.05),
        width=size.width,
        height=size.height,
    )


def sun_view(points: Floats, towards: Vector, pixels: int) -> View:
    """What a sun in this direction sees of the points, in a square; its rays are parallel."""
    points = _padded(points)
    axes = view_axes(towards)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    reach = axes @ (points - middle).T
    x, y, z = (reach.min(axis=1) + reach.max(axis=1)) / 2
    edge = max(float(np.ptp(reach[:2], axis=1).max()), SMALLEST) / (1 - 2 * SUN_MARGIN)
    scale = pixels / edge
    depth = SUN_REACH * max(edge, float(np.ptp(reach[2])))
    origin = middle + axes.T @ np.array([x, y, z + depth])
    matrix = axes * np.array([[scale], [-scale], [-1 / depth]])
    return View(matrix, origin, pixels, pixels, None)


def _padded(points: Floats) -> Floats:
    if np.ptp(points, axis=0).max() >= SMALLEST:
        return points
    return np.vstack([points - AROUND_A_POINT, points + AROUND_A_POINT])


def view_axes(towards: Vector) -> Floats:
    """Right, up and forward of a camera that is in this direction, as rows."""
    forward = -np.array(towards) / np.linalg.norm(towards)
    aside = (0.0, 0.0, 1.0) if abs(forward[2]) < 0.999 else (0.0, 1.0, 0.0)  # noqa: PLR2004
    right = np.cross(forward, aside)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, forward), forward])


def _vector(numbers: Floats) -> Vector:
    return (float(numbers[0]), float(numbers[1]), float(numbers[2]))


LEAST = 0.005  # rad: a smaller slope is not seen
# From the side of the slope: how far down it, across it and up the camera is.
DOWN_IT, ACROSS, UP = 0.25, 0.93, 0.28
FITS = 8  # at most so often the camera is moved back


def slope_of(gravity: Vector) -> float:
    """The angle between gravity and -z, rad; 0 where there is none, or it is too small to be seen.

    A gravity that points upwards is none of a slope.
    """
    across = math.hypot(gravity[0], gravity[1])
    angle = math.atan2(across, -gravity[2]) if across else 0.0
    return angle if LEAST < angle < math.pi / 2 else 0.0


class TurnedCamera:
    """A camera, and by how much its picture is turned so that gravity points down in it."""

    def __init__(
        self,
        points: Floats,
        size: Size,
        gravity: Vector,
        *,
        behind: Iterable[Floats] = (),
        towards: Vector = FROM,
    ) -> None:
        """Place it as `eye_camera` does; from the side of the slope, unless `towards` is given."""
        self._size = size
        self.roll = 0.0  # rad, clockwise
        if not slope_of(gravity):
            self.camera = eye_camera(points, size, behind=behind, towards=towards)
            return
        behind = [*behind]
        towards = _from_the_side(gravity) if towards == FROM else towards
        camera = eye_camera(points, size, towards=towards)
        right, up, _ = camera.axes @ np.array(gravity)
        self.roll = math.atan2(right, -up)
        sin, cos = abs(math.sin(self.roll)), abs(math.cos(self.roll))
        larger = Size(
            math.ceil(size.width * cos + size.height * sin) + 2,
            math.ceil(size.width * sin + size.height * cos) + 2,
        )
        middle, framed = (points.min(axis=0) + points.max(axis=0)) / 2, points
        for _ in range(FITS):
            self.camera = eye_camera(framed, larger, behind=behind, towards=towards)
            beyond = self._beyond(points)
            if beyond <= 1.0:
                break
            framed = middle + (framed - middle) * beyond

    def _beyond(self, points: Floats) -> float:
        """How much farther from the middle the outermost points are than the margin lets them."""
        x, y = self.places(points)
        width, height = self._size.width / 2, self._size.height / 2
        room = 1 - 2 * MARGIN
        return max(
            float(np.abs(x - width).max()) / (width * room),
            float(np.abs(y - height).max()) / (height * room),
        )

    def places(self, points: Floats) -> tuple[Floats, Floats]:
        """Columns and rows in the turned picture of points (n by 3, m, in the world)."""
        view = self.camera.view
        x, y, z = view.matrix @ (points - view.origin).T
        x, y = x / z, y / z
        sin, cos = math.sin(self.roll), math.cos(self.roll)
        return (
            x * cos - y * sin + self._size.width / 2,
            x * sin + y * cos + self._size.height / 2,
        )

    def turned(self, image: Image.Image) -> Image.Image:
        """What the camera has seen, in the size that was wanted."""
        if not self.roll:
            return image
        image = image.rotate(-math.degrees(self.roll), Image.Resampling.BICUBIC)
        left = (image.width - self._size.width) // 2
        top = (image.height - self._size.height) // 2
        return image.crop((left, top, left + self._size.width, top + self._size.height))


def _from_the_side(gravity: Vector) -> Vector:
    length = math.hypot(gravity[0], gravity[1])
    x, y = gravity[0] / length, gravity[1] / length
    return DOWN_IT * x + ACROSS * y, DOWN_IT * y - ACROSS * x, UP

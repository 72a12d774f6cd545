"""Pictures in which gravity points down, where it is not along -z of the world: on a slope.

The ground of the world is level and gravity is tilted. The picture is drawn as seen by a camera
whose right is level in the world, larger than it is wanted, and then turned.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from wsgen.rendering.camera import FROM, MARGIN, Size, eye_camera

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.model.transform import Vector
    from wsgen.rendering.camera import Floats


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

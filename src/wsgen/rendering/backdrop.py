"""What is behind the things in a picture: checkered ground with their shadow, haze and the sky.

A square of the ground has an edge of a round length (1, 2 or 5 times a power of ten), which is
written into the picture, so that sizes can be read off. Ground, shadow and sky are computed for
every pixel: a ground of triangles would cost more, and its edges would not be smooth.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageFilter

from wsgen.rendering.camera import FIELD_OF_VIEW

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.rendering.camera import Camera, View
    from wsgen.rendering.renderer import Shadow

    Floats = NDArray[np.float32]
    Doubles = NDArray[np.float64]


SKY_LOW, SKY_HIGH = np.array([[0.93, 0.95, 0.97], [0.72, 0.82, 0.92]])
TILE_LIGHT, TILE_DARK = np.array([[0.86, 0.87, 0.88], [0.77, 0.79, 0.81]])
SHADE = 0.42  # of the ground's light that a shadow takes
SOFTNESS = 1 / 170  # of the shadow's width: how far its edges are blurred
TILE_MOST = 0.5  # of the robots' size; the next smaller round length is a fifth or more
TILE_PIXELS = 5.0  # squares that are smaller than this at the nearest look like one color
LEAST_GROUND = 0.02  # of the picture: less shows no square
DOWN = -1e-6  # a ray that goes no steeper looks along the ground


def tile_for(size: float) -> float:
    """A round length for the edge of a square, a fifth to a half of this size, m."""
    wanted = max(size * TILE_MOST, 1e-9)
    power = 10.0 ** math.floor(math.log10(wanted))
    edge = max((step * power for step in (1, 2, 5) if step * power <= wanted), default=power)
    return float(f"{edge:.1g}")  # 0.2 and not 0.20000000000000001


class Backdrop:
    """The ground and the sky that a camera sees.

    `color` is 3 by height by width, 0 to 1. `tile` is the edge of a square, m; None where no
    squares can be seen: the camera does not look down on the ground, or is so high above it that
    they run together, or there is no ground.
    """

    def __init__(self, camera: Camera, *, tile: float, has_ground: bool) -> None:
        self.tile: float | None = None
        width, height = camera.width, camera.height
        self._camera = camera
        right, up, forward = camera.axes  # the first is level: what depends on height is of a row
        slope = math.tan(math.radians(camera.field_of_view / 2))
        across = ((np.arange(width) + 0.5) / width * 2 - 1) * slope * camera.aspect
        down = (1 - (np.arange(height) + 0.5) / height * 2) * slope
        rays = forward[:, None] + up[:, None] * down  # of each row, in its middle
        elevation = camera.eye[2]
        has_ground = has_ground and elevation > 0
        self._hits = (rays[2] < DOWN) & has_ground  # of each row
        self.is_ground_seen = bool(self._hits.any())
        rise = np.clip(rays[2] / 0.5, 0, 1) ** 0.8 * has_ground
        sky = SKY_LOW[:, None] + (SKY_HIGH - SKY_LOW)[:, None] * rise
        self.color = np.repeat(sky.astype(np.float32)[..., None], width, axis=2)
        if not self.is_ground_seen:
            return
        pixel = math.radians(FIELD_OF_VIEW) / height / tile
        reach = -elevation / rays[2, self._hits]
        if float(reach.min()) * pixel * TILE_PIXELS < 1:
            self.tile = tile
        haze = np.clip((reach / math.dist(camera.eye, camera.target) - 1.2) / 4.5, 0, 1)
        self._lit = 1 - haze * haze * (3 - 2 * haze)  # it hides shadows, too
        eye = np.array(camera.eye[:2])
        start = eye - np.floor(eye / (2 * tile)) * 2 * tile  # keeps digits
        # The mean of the light and the dark, and how much a pixel deviates from it.
        blurred = np.maximum(reach * pixel, 1e-9)  # a pixel's edge in tiles
        contrast = np.clip(1 - 3 * blurred, 0, 1) / 2  # tiles smaller than a pixel are one gray
        light, dark = TILE_LIGHT[:, None], TILE_DARK[:, None]
        base = SKY_LOW[:, None] + ((light + dark) / 2 - SKY_LOW[:, None]) * self._lit
        swing = (light - dark) * (contrast * self._lit)
        wave = np.float32(1)
        for axis in range(2):
            middle = (start[axis] + reach * rays[axis, self._hits]) / (2 * tile)
            growth = reach * right[axis] / (2 * tile)
            wave = wave * _wave(middle, growth, across, blurred)
        self.color[:, self._hits] = (
            base.astype(np.float32)[..., None] + wave * swing.astype(np.float32)[..., None]
        )

    def look_past(self, is_free: NDArray[np.bool_]) -> None:
        """Have no tile where the ground is seen nowhere: all else than `is_free` is before it."""
        seen = np.count_nonzero(is_free[self._hits])
        if seen < LEAST_GROUND * is_free.size:
            self.tile = None

    def shadowed(self, sun: Shadow | None) -> Floats:
        """The colors with the shadow of what keeps the sun's light from the ground."""
        color: Floats = self.color.copy()
        if sun is None or not self.is_ground_seen:
            return color
        size = sun.view.width
        mask = Image.fromarray((sun.on_ground() * 255).astype(np.uint8))
        soft = mask.filter(ImageFilter.GaussianBlur(size * SOFTNESS))
        # A plane is seen alike by two cameras but for a change of perspective.
        change = _ground_to_pixels(sun.view) @ np.linalg.inv(_ground_to_pixels(self._camera.view))
        seen = soft.transform(
            (self._camera.width, self._camera.height),
            Image.Transform.PERSPECTIVE,
            tuple((change / change[2, 2]).ravel()[:8]),
            Image.Resampling.BILINEAR,
        )
        dark = np.asarray(seen)[self._hits] * (self._lit * SHADE / 255).astype(np.float32)[:, None]
        color[:, self._hits] *= 1 - dark
        return color


def _wave(middle: Doubles, growth: Doubles, across: Doubles, blurred: Doubles) -> Floats:
    """For each pixel of some rows -1 or 1 for a tile along an axis, smooth over a pixel's width."""
    periods = middle.astype(np.float32)[:, None] + np.outer(growth, across).astype(np.float32)
    periods -= np.floor(periods)
    # A triangle wave of height 1, steep where tiles meet.
    wave: Floats = np.abs(periods * 2 - 1, out=periods)
    wave -= np.float32(0.5)
    wave /= blurred.astype(np.float32)[:, None]
    np.clip(wave, -1, 1, out=wave)
    return wave


def _ground_to_pixels(view: View) -> Doubles:
    """From a point of the ground (x, y, 1) to the pixel that shows it (column w, row w, w)."""
    across = view.matrix[:, :2]
    columns = np.column_stack([across, -view.matrix @ view.origin])
    if view.nearest is None:
        columns[2] = (0, 0, 1)
    middle = np.array([[1, 0, view.width / 2], [0, 1, view.height / 2], [0, 0, 1]])
    to_pixels: Doubles = middle @ columns
    return to_pixels

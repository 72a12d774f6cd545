"""Puts a picture together: what is behind the things, dithering, captions, title cards, files.

Behind them are checkered ground with their shadow, haze and the sky. A square of the ground has an
edge of a round length (1, 2 or 5 times a power of ten), which is written into the picture, so that
sizes can be read off. Ground, shadow and sky are computed for every pixel: a ground of triangles
would cost more, and its edges would not be smooth.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from wsgen.rendering.camera import FIELD_OF_VIEW
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

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


# Of 256 levels, either way: without it the levels of a surface that slowly turns from the light
# are seen as bands.
DITHER = 1.0
CAPTION_COLOR = (70, 78, 88)
CAPTION_SIZE, CAPTION_MARGIN = 1 / 40, 1 / 51  # of the picture's height
CAPTION_LEADING = 4  # pixels between lines
CAPTION_SCALE = 4  # so many times as large the letters are drawn
TITLE_COLOR = (30, 36, 44)
ARROW_COLOR = (200, 30, 60)
ARROW_WIDTH = 1 / 110  # of the picture's height
TITLE_PALENESS = 0.75  # of the image behind a title
TITLE_SIZE, TITLE_WIDTH = 1 / 9, 0.9  # of the picture's height; of its width, the most


def image_of(colors: Floats, dithered: NDArray[np.bool_] | None) -> Image.Image:
    """An image of colors (3 by height by width, 0 to 1), dithered where that is wanted."""
    levels = colors * np.float32(255) + np.float32(0.5)
    if dithered is not None:  # the same every time
        noise = np.random.default_rng(0).random(dithered.shape, dtype=np.float32)
        levels += (noise * 2 - 1) * (dithered * np.float32(DITHER))
    return Image.fromarray(levels.clip(0, 255).astype(np.uint8).transpose(1, 2, 0))


def write_caption(image: Image.Image, lines: Sequence[str]) -> None:
    """Write into the lower left corner."""
    margin = round(image.height * CAPTION_MARGIN)
    letters = _letters("\n".join(lines), max(11, round(image.height * CAPTION_SIZE)))
    image.paste(CAPTION_COLOR, (margin, image.height - margin - letters.height), letters)


def _letters(text: str, size: int) -> Image.Image:
    """What a text covers, 0 to 255; `size` of the letters and the result in pixels.

    Pillow rounds the width of each letter to whole pixels, which leaves next to nothing of a space
    between small words. So it draws them larger.
    """
    font = ImageFont.load_default(size * CAPTION_SCALE)
    spacing = CAPTION_LEADING * CAPTION_SCALE
    large = Image.new("L", (1, 1))
    _, top, right, _ = ImageDraw.Draw(large).multiline_textbbox(
        (0, 0), text, font=font, anchor="ld", spacing=spacing
    )
    width, height = (max(1, math.ceil(edge / CAPTION_SCALE)) for edge in (right, -top))
    large = large.resize((width * CAPTION_SCALE, height * CAPTION_SCALE))
    ImageDraw.Draw(large).multiline_text(
        (0, large.height), text, fill=255, font=font, anchor="ld", spacing=spacing
    )
    return large.reduce(CAPTION_SCALE)


def draw_arrow(image: Image.Image, tail: tuple[float, float], head: tuple[float, float]) -> None:
    """Draw an arrow from a place to another one, each a column and a row."""
    along = np.subtract(head, tail)
    length = float(np.hypot(*along))
    width = max(2, round(image.height * ARROW_WIDTH))
    if length < width:  # it points at the camera, or away from it
        return
    along = along / length
    across = np.array([-along[1], along[0]])
    neck = np.array(head) - min(4.0 * width, length) * along
    half, wide = width / 2 * across, 2.0 * width * across
    corners = [tail + half, neck + half, neck + wide, head, neck - wide, neck - half, tail - half]
    outline = [(float(x), float(y)) for x, y in corners]
    draw = ImageDraw.Draw(image)
    draw.line([*outline, *outline[:2]], fill="white", width=max(2, width // 2), joint="curve")
    draw.polygon(outline, fill=ARROW_COLOR)


def draw_title(image: Image.Image, title: str) -> Image.Image:
    """A title card: the title, as large as there is room for, over the pale image."""
    card = Image.blend(image, Image.new("RGB", image.size, "white"), TITLE_PALENESS)
    size = image.height * TITLE_SIZE
    room = image.width * TITLE_WIDTH
    size *= min(1.0, room / max(1.0, ImageFont.load_default(size).getlength(title)))
    ImageDraw.Draw(card).text(
        (image.width / 2, image.height / 2),
        title,
        fill=TITLE_COLOR,
        font=ImageFont.load_default(max(1.0, size)),
        anchor="mm",
    )
    return card


def write_png(image: Image.Image, file: Path) -> None:
    """Write an image, whole or not at all; see `wsgen.text.files.write_file`."""
    stream = io.BytesIO()
    image.save(stream, format="PNG")
    write_file(file, stream.getvalue())

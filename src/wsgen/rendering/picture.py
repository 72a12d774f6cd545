"""Composes a picture: what a renderer saw, in front of checkered ground with shadows, and the sky.

The renderer draws the robots alone, larger than the picture is, so that their edges are smooth.
What is transparent is drawn a second time, over the rest; what lies under the ground is drawn
faintly.

A square of the ground has an edge of a round length (1, 2 or 5 times a power of ten), which is
written into the picture, so that sizes can be read off. Ground, shadow and sky are computed for
every pixel: a ground of triangles would cost most of the time, and its edges would not be smooth.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont

from wsgen.files import write_file
from wsgen.rendering.camera import FIELD_OF_VIEW, matrix, view_axes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.rendering.camera import Camera, Shot, Size

    Floats = NDArray[np.float32]


SUNK = 1e-3  # of the farthest distance: what the depth buffer cannot tell from the ground
FAINT = 0.35  # opacity of what is under the ground

# Of 256 levels, either way: without it the levels of a surface that slowly turns from the light
# are seen as bands.
DITHER = 1.0
CAPTION_COLOR = (70, 78, 88)
CAPTION_SIZE, CAPTION_MARGIN = 1 / 40, 1 / 51  # of the picture's height
CAPTION_LEADING = 4  # pixels between lines
CAPTION_SCALE = 4  # so many times as large the letters are drawn
TITLE_COLOR = (30, 36, 44)
TITLE_PALENESS = 0.75  # of the image behind a title
TITLE_SIZE, TITLE_WIDTH = 1 / 9, 0.9  # of the picture's height; of its width, the most


def robots(shot: Shot, behind: Shot | None, opacity: Floats, *, has_ground: bool) -> Image.Image:
    """What was seen, as an image with transparency, as large as it was rendered.

    Args:
        shot: What was seen of all, as if nothing were transparent.
        behind: What was seen of all that is solid, of any size; None where nothing else is.
        opacity: Of each body by its number, 0 to 1.
        has_ground: Whether a ground at z = 0 is seen.
    """
    image = _image(shot, opacity, has_ground=has_ground)
    if behind is None:
        return image
    hidden = _image(behind, np.ones_like(opacity), has_ground=has_ground)
    hidden = hidden.resize(image.size, Image.Resampling.NEAREST)
    transparent = Image.fromarray(_of_bodies(shot, opacity < 1).astype(np.uint8) * 255)
    # Elsewhere the sharper one is all there is.
    hidden.putalpha(ImageChops.multiply(hidden.getchannel("A"), transparent))
    return Image.alpha_composite(hidden, image)


def _image(shot: Shot, opacity: Floats, *, has_ground: bool) -> Image.Image:
    alpha = (_of_bodies(shot, opacity) * 255).astype(np.uint8)
    if has_ground:
        alpha = np.where(is_under_ground(shot), (alpha * FAINT).astype(np.uint8), alpha)
    color = shot.rgba.copy()
    color[..., 3] = alpha
    return Image.fromarray(color)


def _of_bodies(shot: Shot, table: NDArray[Any]) -> NDArray[Any]:
    """For each pixel what a table says of the body that is seen there; 0 where none is."""
    return np.where(shot.body >= 0, table[np.maximum(shot.body, 0)], 0)


def is_under_ground(shot: Shot) -> NDArray[np.bool_]:
    """Where what is seen lies under z = 0."""
    rows, columns = np.nonzero(shot.body >= 0)
    depth = shot.depth[rows, columns].astype(np.float64)
    under = np.zeros(shot.body.shape, dtype=bool)
    under[rows, columns] = unproject(shot, rows, columns, depth)[2] < -SUNK * shot.camera.far
    return under


def unproject(
    shot: Shot, rows: NDArray[np.intp], columns: NDArray[np.intp], depth: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The points in the world (3 by n, m) that were seen at these pixels, at that depth."""
    clip = np.stack(
        [
            (columns + 0.5) / shot.camera.width * 2 - 1,
            1 - (rows + 0.5) / shot.camera.height * 2,
            depth * 2 - 1,
            np.ones_like(depth),
        ]
    )
    world = np.linalg.inv(matrix(shot.projection) @ matrix(shot.view)) @ clip
    points: NDArray[np.float64] = world[:3] / world[3]
    return points


def compose(front: Image.Image, background: Floats, size: Size, *, dither: bool) -> Image.Image:
    """The robots, made as small as the picture is, in front of a background (0 to 1)."""
    if front.size != (size.width, size.height):
        front = front.resize((size.width, size.height), Image.Resampling.BOX)
    seen = np.asarray(front, dtype=np.float32)
    cover = seen[..., 3:] / 255
    color = seen[..., :3]
    if dither:  # the same every time
        noise = np.random.default_rng(0).random(cover.shape, dtype=np.float32)
        color = color + (noise * 2 - 1) * np.float32(DITHER)
    picture = background * 255 * (1 - cover) + color * cover
    return Image.fromarray((picture + 0.5).clip(0, 255).astype(np.uint8))


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
    """Write an image, whole or not at all; see `wsgen.files.write_file`."""
    stream = io.BytesIO()
    image.save(stream, format="PNG")
    write_file(file, stream.getvalue())


SKY_LOW, SKY_HIGH = (0.93, 0.95, 0.97), (0.72, 0.82, 0.92)
TILE_LIGHT, TILE_DARK = (0.86, 0.87, 0.88), (0.77, 0.79, 0.81)
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
    """The ground and the sky that a camera sees, in a picture of this size.

    `tile` is the edge of a square, m; None where no squares can be seen: the camera does not look
    down on the ground, or is so high above it that they run together, or there is no ground.
    """

    def __init__(self, camera: Camera, size: Size, *, tile: float, has_ground: bool) -> None:
        self.size = size
        self._camera = camera
        rays = _rays(camera, size)
        height = camera.eye[2]
        self._hits = (rays[..., 2] < DOWN) & (has_ground and height > 0)
        self.is_ground_seen = bool(self._hits.any())
        reach = np.where(self._hits, -height / np.where(self._hits, rays[..., 2], -1.0), 0.0)
        self.color = _sky(rays, has_ground=has_ground and height > 0)
        self.tile: float | None = None
        if self.is_ground_seen:
            pixel = math.radians(FIELD_OF_VIEW) / size.height / tile
            if float(reach[self._hits].min()) * pixel * TILE_PIXELS < 1:
                self.tile = tile
            self._lay(rays, reach, tile, pixel)

    def _lay(self, rays: Floats, reach: Floats, tile: float, pixel: float) -> None:
        """Put the ground over the sky, with haze where it is far."""
        eye = np.array(self._camera.eye, dtype=np.float64)
        middle = (np.floor(eye[:2] / (2 * tile)) * 2 * tile).astype(np.float64)  # keeps digits
        on_ground = (eye[:2] - middle).astype(np.float32) + reach[..., None] * rays[..., :2]
        size = math.dist(self._camera.eye, self._camera.target)
        tiles = _tiles(on_ground, tile, reach * np.float32(pixel))
        haze = np.clip((reach / size - 1.2) / 4.5, 0, 1)
        haze = (haze * haze * (3 - 2 * haze))[..., None]
        ground = tiles + haze * (np.array(SKY_LOW, dtype=np.float32) - tiles)
        self._lit = 1 - haze[..., 0]  # haze hides shadows, too
        self.color = np.where(self._hits[..., None], ground, self.color)

    def look_past(self, is_free: NDArray[np.bool_]) -> None:
        """Have no tile where the ground is seen nowhere: all else than `is_free` is before it.

        `is_free` is of the picture, in any resolution.
        """
        rows = np.arange(self.size.height) * len(is_free) // self.size.height
        columns = np.arange(self.size.width) * is_free.shape[1] // self.size.width
        seen = self._hits & is_free[rows[:, None], columns]
        if np.count_nonzero(seen) < LEAST_GROUND * seen.size:
            self.tile = None

    def shadowed(self, light: Shot | None, opacity: Floats) -> Floats:
        """Red, green and blue, 0 to 1, with the shadow of what the light sees.

        `opacity` says how much light each body takes, by its number, 0 to 1.
        """
        if light is None or not self.is_ground_seen:
            return self.color
        pixels = light.camera.width
        bodies = light.body
        mask = np.where(bodies >= 0, opacity[np.maximum(bodies, 0)] * 255, 0).astype(np.uint8)
        soft = Image.fromarray(mask).filter(ImageFilter.GaussianBlur(pixels * SOFTNESS))
        # A plane is seen alike by two cameras but for a change of perspective.
        change = _ground_to_pixels(light) @ _pixels_to_ground(self._camera, self.size)
        seen = soft.transform(
            (self.size.width, self.size.height),
            Image.Transform.PERSPECTIVE,
            tuple((change / change[2, 2]).ravel()[:8]),
            Image.Resampling.BILINEAR,
        )
        shade = np.asarray(seen, dtype=np.float32) * np.float32(SHADE / 255) * self._hits
        shaded: Floats = self.color * (1 - shade * self._lit)[..., None]
        return shaded


def _rays(camera: Camera, size: Size) -> Floats:
    """Where each pixel looks: directions in the world, their part along the view's axis 1."""
    right, up, forward = view_axes(_back(camera)).astype(np.float32)
    slope = math.tan(math.radians(camera.field_of_view / 2))
    across = (np.arange(size.width, dtype=np.float32) + 0.5) / size.width * 2 - 1
    down = 1 - (np.arange(size.height, dtype=np.float32) + 0.5) / size.height * 2
    columns = (across * np.float32(slope * camera.aspect))[:, None] * right
    rows = (down * np.float32(slope))[:, None] * up + forward
    rays: Floats = columns[None, :, :] + rows[:, None, :]
    return rays


def _back(camera: Camera) -> tuple[float, float, float]:
    x, y, z = (eye - target for eye, target in zip(camera.eye, camera.target, strict=True))
    return (x, y, z)


def _sky(rays: Floats, *, has_ground: bool) -> Floats:
    """The sky; without a ground below it, one plain color all around."""
    low, high = np.array(SKY_LOW, dtype=np.float32), np.array(SKY_HIGH, dtype=np.float32)
    if not has_ground:
        return np.broadcast_to(low, rays.shape)
    height = np.clip(rays[..., 2:] / 0.5, 0, 1) ** 0.8
    sky: Floats = low + (high - low) * height
    return sky


def _tiles(on_ground: Floats, tile: float, pixel: Floats) -> Floats:
    """A checker whose edges are smoothed over the width of a pixel (in tiles)."""
    # A triangle wave of period 2, of height 1, steep where tiles meet.
    wave = np.abs((on_ground / np.float32(tile)) % 2 - 1) - 0.5
    square = np.clip(wave / np.maximum(pixel, 1e-9)[..., None], -1, 1)
    # Tiles smaller than a pixel are one grey.
    fade = np.clip(1 - pixel * 3, 0, 1) * square[..., 0] * square[..., 1] / 2 + 0.5
    light, dark = np.array(TILE_LIGHT, dtype=np.float32), np.array(TILE_DARK, dtype=np.float32)
    tiles: Floats = dark + (light - dark) * fade[..., None]
    return tiles


def _pixels_to_ground(camera: Camera, size: Size) -> NDArray[np.float64]:
    """From a pixel (column, row, 1) to the point of the ground that it shows (x w, y w, w)."""
    right, up, forward = view_axes(_back(camera))
    slope = math.tan(math.radians(camera.field_of_view / 2))
    across, down = 2 * slope * camera.aspect / size.width, -2 * slope / size.height
    corner = forward - right * slope * camera.aspect + up * slope
    rays = np.stack([right * across, up * down, corner], axis=1)
    x, y, z = camera.eye
    to_ground: NDArray[np.float64] = np.array([[-z, 0, x], [0, -z, y], [0, 0, 1]]) @ rays
    return to_ground


def _ground_to_pixels(light: Shot) -> NDArray[np.float64]:
    """From a point of the ground (x, y, 1) to the pixel that shows it (column w, row w, w)."""
    transform = matrix(light.projection) @ matrix(light.view)
    half = light.camera.width / 2
    to_pixel = np.array([[half, 0, half], [0, -half, half], [0, 0, 1]])
    to_pixels: NDArray[np.float64] = to_pixel @ transform[[0, 1, 3]][:, [0, 1, 3]]
    return to_pixels

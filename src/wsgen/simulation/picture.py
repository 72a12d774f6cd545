"""Puts what a renderer saw before the ground and the sky.

The renderer draws the robots alone, larger than the picture is, so that their edges are smooth.
What is see-through is drawn a second time, over the rest; what lies under the ground shines
through it faintly.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFont

from wsgen.files import write_file
from wsgen.simulation.framing import matrix

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.simulation.framing import Size
    from wsgen.simulation.shot import Shot

    Floats = NDArray[np.float32]

SUNK = 1e-3  # of the farthest distance: what the depth buffer cannot tell from the ground
FAINT = 0.35  # how much of what is under the ground shines through

# Of 256 levels, either way: without it the levels of a surface that slowly turns from the light
# are seen as bands.
DITHER = 1.0
CAPTION_COLOUR = (70, 78, 88)
CAPTION_SIZE, CAPTION_MARGIN = 1 / 40, 1 / 51  # of the picture's height
CAPTION_LEADING = 4  # pixels between lines
CAPTION_SCALE = 4  # so many times as large the letters are drawn
TITLE_COLOR = (30, 36, 44)
TITLE_PALENESS = 0.75  # of the image behind a title
TITLE_SIZE, TITLE_WIDTH = 1 / 9, 0.9  # of the picture's height; of its width, the most


def robots(shot: Shot, behind: Shot | None, opacity: Floats, *, has_ground: bool) -> Image.Image:
    """What was seen, as an image with transparency, as large as it was rendered.

    Args:
        shot: What was seen of all, as if nothing were see-through.
        behind: What was seen of all that is solid, of any size; None where nothing else is.
        opacity: Of each body by its number, 0 to 1.
        has_ground: Whether a ground at z = 0 is seen.
    """
    image = _image(shot, opacity, has_ground=has_ground)
    if behind is None:
        return image
    hidden = _image(behind, np.ones_like(opacity), has_ground=has_ground)
    hidden = hidden.resize(image.size, Image.Resampling.NEAREST)
    veils = Image.fromarray(_of_bodies(shot, opacity < 1).astype(np.uint8) * 255)
    # Elsewhere the sharper one is all there is.
    hidden.putalpha(ImageChops.multiply(hidden.getchannel("A"), veils))
    return Image.alpha_composite(hidden, image)


def _image(shot: Shot, opacity: Floats, *, has_ground: bool) -> Image.Image:
    alpha = (_of_bodies(shot, opacity) * 255).astype(np.uint8)
    if has_ground:
        alpha = np.where(is_under_ground(shot), (alpha * FAINT).astype(np.uint8), alpha)
    colour = shot.rgba.copy()
    colour[..., 3] = alpha
    return Image.fromarray(colour)


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
    """The robots, made as small as the picture is, before a background (0 to 1)."""
    if front.size != (size.width, size.height):
        front = front.resize((size.width, size.height), Image.Resampling.BOX)
    seen = np.asarray(front, dtype=np.float32)
    cover = seen[..., 3:] / 255
    colour = seen[..., :3]
    if dither:  # the same every time
        noise = np.random.default_rng(0).random(cover.shape, dtype=np.float32)
        colour = colour + (noise * 2 - 1) * np.float32(DITHER)
    picture = background * 255 * (1 - cover) + colour * cover
    return Image.fromarray((picture + 0.5).clip(0, 255).astype(np.uint8))


def write_caption(image: Image.Image, lines: Sequence[str]) -> None:
    """Write into the lower left corner."""
    margin = round(image.height * CAPTION_MARGIN)
    letters = _letters("\n".join(lines), max(11, round(image.height * CAPTION_SIZE)))
    image.paste(CAPTION_COLOUR, (margin, image.height - margin - letters.height), letters)


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

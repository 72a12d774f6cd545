"""Puts a picture together: dithering, captions, title cards, files."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float32]


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

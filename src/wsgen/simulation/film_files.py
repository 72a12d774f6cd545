"""Images become a film: a GIF by Pillow, or an MP4 by PyAV."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from PIL import Image

from wsgen.files import write_file

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

COLOURS = 255  # and one that says that a pixel is as before


def write_film(
    file: Path, frames: Iterator[Image.Image], samples: Sequence[Image.Image], rate: float
) -> None:
    """Write the frames, so many a second, as they come.

    Args:
        file: Its ending says what it becomes, `.gif` or `.mp4`. It is written when all is done.
        frames: All of one size, with an even number of rows and columns.
        samples: Images with the film's colours.
        rate: Frames a second.
    """
    if file.suffix.lower() == ".mp4":
        # It is an extra, and its loading takes longer than PyBullet's.
        from wsgen.simulation.film_encoder import encode_mp4  # noqa: PLC0415

        write_file(file, encode_mp4(frames, rate))
    else:
        write_file(file, _encode_gif(frames, samples, rate))


def _encode_gif(
    frames: Iterator[Image.Image], samples: Sequence[Image.Image], rate: float
) -> bytes:
    palette = _palette(samples)
    painted = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    stream = io.BytesIO()
    next(painted).save(
        stream,
        format="GIF",
        save_all=True,
        append_images=painted,
        duration=round(1000 / rate),  # ms
        loop=0,
        disposal=1,
    )
    return stream.getvalue()


def _palette(samples: Sequence[Image.Image]) -> Image.Image:
    """One for all frames: with one of its own for each, what does not move would flicker."""
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for number, sample in enumerate(samples):
        sheet.paste(sample, (0, number * height))
    return sheet.quantize(COLOURS, method=Image.Quantize.MEDIANCUT)

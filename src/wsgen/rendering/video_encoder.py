"""Writes MP4 with PyAV; no other module imports it.

It has wheels for every Python that wsgen runs on, and encodes in this process. The alternatives
start a program: imageio-ffmpeg brings one for every video, and the one on the path may have been
built without H.264.
"""

from __future__ import annotations

import io
from fractions import Fraction
from typing import TYPE_CHECKING

import av

if TYPE_CHECKING:
    from collections.abc import Iterator

    from PIL.Image import Image


CODECS = ("libx264", "mpeg4")  # the first one that is there
QUALITY = {"crf": "20", "preset": "veryfast"}  # of libx264: no artefact is seen
BITS_PER_SECOND = 2_000_000  # of the other


def encode_mp4(frames: Iterator[Image], rate: float) -> bytes:
    """The frames, so many a second, as an MP4 that every browser plays."""
    stream = io.BytesIO()
    codec = next(name for name in CODECS if name in av.codecs_available)
    with av.open(stream, "w", format="mp4") as container:
        first = next(frames)
        video = container.add_stream(codec, rate=Fraction(rate).limit_denominator(1000))
        video.width, video.height = first.size
        video.pix_fmt = "yuv420p"  # the only one that all players know
        video.bit_rate = BITS_PER_SECOND if codec != CODECS[0] else 0
        video.options = QUALITY if codec == CODECS[0] else {}
        video.thread_count = 1
        image: Image | None = first
        while image is not None:
            container.mux(video.encode(av.VideoFrame.from_image(image)))
            image = next(frames, None)
        container.mux(video.encode())
    return stream.getvalue()

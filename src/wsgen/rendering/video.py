"""Draws the video of a simulation: of each behavior, or of the robots from spawning to the end.

Pillow writes a GIF, PyAV an MP4; no other module imports that. It has wheels for every Python that
wsgen runs on, and encodes in this process. The alternatives start a program: imageio-ffmpeg brings
one for every video, and the one on the path may have been built without H.264.
"""

from __future__ import annotations

import io
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from wsgen.rendering.camera import Size, extent
from wsgen.rendering.picture import (
    ARROW_COLOR,
    CAPTION_COLOR,
    TITLE_COLOR,
    draw_title,
    write_caption,
)
from wsgen.rendering.scene_renderer import VIEWS, CameraSetup, is_no_subject
from wsgen.simulation.scene import Video
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from wsgen.rendering.drawing import Clip, Recorder
    from wsgen.rendering.render_items import Poses
    from wsgen.rendering.scene_renderer import SceneRenderer
    from wsgen.simulation.scene import Push


COLORS = 255  # and one that says that a pixel is as before
LETTERS = (CAPTION_COLOR, TITLE_COLOR)  # so few pixels that none of the colors would be theirs


def write_video(
    file: Path, frames: Iterator[Image.Image], samples: Sequence[Image.Image], rate: float
) -> None:
    """Write the frames, so many a second, as they come.

    Args:
        file: Its ending says what it becomes, `.gif` or `.mp4`. It is written when all is done.
        frames: All of one size, with an even number of rows and columns.
        samples: Images with the video's colors.
        rate: Frames a second.
    """
    if file.suffix.lower() == ".mp4":
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
    palette = sheet.quantize(COLORS - len(LETTERS), method=Image.Quantize.MEDIANCUT)
    palette.putpalette([*(palette.getpalette() or []), *(part for rgb in LETTERS for part in rgb)])
    return palette


BUDGET = 16.0  # s of CPU time for all frames, about: a usual robot's need a fifth of it
LARGE, SMALL = Size(480, 360), Size(320, 240)

# About what a frame takes on a usual computer, s of CPU time. It is computed and not measured, so
# that the same things get the same videos on every machine, however busy it is.
FRAME_SECONDS, PIXEL_SECONDS, TRIANGLE_SECONDS = 0.006, 0.1e-6, 0.15e-6

AROUND_LEAST = 3.0  # m around the way of the robots, and the size of that
TITLE_SECONDS = 0.8  # how long the name of a behavior is shown before it


def draw_video(  # noqa: PLR0913  what to draw, where, and how
    scene_renderer: SceneRenderer,
    recorder: Recorder,
    file: Path,
    announce: Callable[[str], None],
    *,
    looks: int = 3,
    with_surroundings: bool = False,
) -> Video:
    """Write a video of what was recorded; `announce` gets how far it is.

    The camera stands still and sees the robots as they are at the beginning and the end of each
    clip and at moments between, `looks` in all. A clip with a name begins with it on a title card:
    else the cut would look like a jump of the robot. `with_surroundings` the camera looks from
    above, over walls, and sees the static models near the robots, too. What takes long to draw gets
    a smaller picture, then fewer frames.
    """
    clips = recorder.shown
    count = sum(len(clip.frames) for clip in clips)
    size, cost = _quality(scene_renderer.renderer.triangles, count)
    stride = max(1, -int(-count * cost // BUDGET))
    rate = recorder.rate / stride
    moments = [moment for clip in clips for moment in _moments(clip, looks)]
    setup = _set_up(scene_renderer, moments, size, with_surroundings=with_surroundings)
    titles = max(1, round(TITLE_SECONDS * rate))
    total = sum(len(clip.frames[::stride]) for clip in clips)
    written = total + titles * sum(bool(clip.name) for clip in clips)

    def draw_all() -> Iterator[Image.Image]:
        number = 0
        for clip in clips:
            for place, now in enumerate(clip.frames[::stride]):
                number += 1
                announce(f"frame {number} of {total}")
                image = _draw(setup, now, clip.name, seconds=place / rate)
                if not clip.name:  # the pushes act while the robots stand
                    _draw_pushes(setup, scene_renderer.pushes, image, now, place / rate)
                if place == 0 and clip.name:
                    yield from [draw_title(image, clip.name)] * titles
                yield image

    samples = _samples(setup, clips)
    if scene_renderer.pushes:  # else no color of so few pixels would be that of the arrow
        samples.append(Image.new("RGB", samples[0].size, ARROW_COLOR))
    write_video(file, draw_all(), samples, rate)
    return Video(
        file=file,
        frames=written,
        frames_per_second=rate,
        width=size.width,
        height=size.height,
        triangles=scene_renderer.renderer.triangles,
        is_coarse=stride > 1 or size != LARGE,
    )


def _quality(triangles: int, frames: int) -> tuple[Size, float]:
    """The size in which so many triangles are drawn, and about the CPU time of a frame (s)."""
    for size in (LARGE, SMALL):
        pixels = size.width * size.height
        cost = FRAME_SECONDS + pixels * PIXEL_SECONDS + triangles * TRIANGLE_SECONDS
        if cost * frames <= BUDGET:
            break
    return size, cost


def _moments(clip: Clip, count: int = 3) -> list[Poses]:
    """The first frame, the last one, and others evenly between them."""
    frames, gaps = len(clip.frames), count - 1
    return [clip.frames[min(frames * number // gaps, frames - 1)] for number in range(count)]


def _set_up(
    scene_renderer: SceneRenderer, moments: Sequence[Poses], size: Size, *, with_surroundings: bool
) -> CameraSetup:
    seen = []
    for moment in moments:
        scene_renderer.renderer.arrange(moment)
        seen.append(scene_renderer.subject_points())
    points = np.vstack(seen)
    options: dict[str, Any] = {"without_shadow": is_no_subject}
    if with_surroundings:
        around = scene_renderer.around(points, AROUND_LEAST + extent(points))
        points, options = np.vstack([points, *around.values()]), {"towards": VIEWS[0]}
    return CameraSetup(
        scene_renderer.renderer, scene_renderer.world, points, size, samples=2, **options
    )


def _samples(setup: CameraSetup, clips: Sequence[Clip]) -> list[Image.Image]:
    """Three images that have the colors of all."""
    samples = [_draw(setup, moment, "", seconds=0.0) for moment in _moments(clips[0])]
    return [*samples, *(draw_title(samples[0], clip.name) for clip in clips[:1] if clip.name)]


def _draw_pushes(
    setup: CameraSetup, pushes: Sequence[Push], image: Image.Image, poses: Poses, seconds: float
) -> None:
    for push in pushes:
        if push.begin <= seconds < push.begin + push.seconds:
            setup.draw_push(image, push, poses)


def _draw(setup: CameraSetup, poses: Poses, name: str, *, seconds: float) -> Image.Image:
    image = setup.take_at(poses)
    tile = setup.backdrop.tile
    lines = [name, f"{seconds:.2f} s", f"1 square = {tile:g} m" if tile else ""]
    write_caption(image, [line for line in lines if line])
    return image


CODECS = ("libx264", "mpeg4")  # the first one that is there
QUALITY = {"crf": "20", "preset": "veryfast"}  # of libx264: no artefact is seen
BITS_PER_SECOND = 2_000_000  # of the other


def encode_mp4(frames: Iterator[Image.Image], rate: float) -> bytes:
    """The frames, so many a second, as an MP4 that every browser plays."""
    import av  # noqa: PLC0415  it is an extra, and takes a while to load

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
        image: Image.Image | None = first
        while image is not None:
            container.mux(video.encode(av.VideoFrame.from_image(image)))
            image = next(frames, None)
        container.mux(video.encode())
    return stream.getvalue()

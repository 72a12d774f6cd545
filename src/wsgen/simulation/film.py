"""Draws the film of a trial: from where the robots were spawned to the end."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from wsgen.simulation.film_files import write_film
from wsgen.simulation.framing import Size
from wsgen.simulation.picture import write_caption
from wsgen.simulation.scene import Film
from wsgen.simulation.stage import Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from PIL.Image import Image

    from wsgen.simulation.exhibits import Poses
    from wsgen.simulation.gallery import Gallery
    from wsgen.simulation.recording import Recorder

BUDGET = 16.0  # s of CPU time for all frames: a usual robot's need a third of it


# The second for what is so dense that the first would leave too few frames.
SIZES = Size(480, 360), Size(320, 240)


def draw_film(
    gallery: Gallery, recorder: Recorder, file: Path, announce: Callable[[str], None]
) -> Film:
    """Write a film of what was recorded; `announce` is told how far it is.

    The camera stands still and sees the robots as they were at first, at the end of each behaviour
    and at last. What takes long to draw gets a smaller picture, then fewer frames.
    """
    poses = recorder.frames
    stage, samples, cost = _set_up(gallery, poses, recorder.ends)
    stride = max(1, round(cost * len(poses) / BUDGET + 0.5)) if cost * len(poses) > BUDGET else 1
    shown = poses[::stride]
    rate = recorder.rate / stride

    def draw_all() -> Iterator[Image]:
        for number, now in enumerate(shown):
            announce(f"frame {number + 1} of {len(shown)}")
            yield _draw(stage, now, seconds=number / rate)

    write_film(file, draw_all(), samples, rate)
    return Film(
        file=file,
        frames=len(shown),
        frames_per_second=rate,
        width=stage.size.width,
        height=stage.size.height,
        is_coarse=stride > 1 or stage.size != SIZES[0],
    )


def _set_up(
    gallery: Gallery, poses: Sequence[Poses], ends: Sequence[int]
) -> tuple[Stage, list[Image], float]:
    """The stage, the first, a middle and the last frame, and what a frame costs (s of CPU time)."""
    moments = [poses[0], poses[len(poses) // 2], poses[-1]]
    points = []
    for moment in (moments[0], *(poses[end] for end in ends), moments[-1]):
        gallery.studio.arrange(moment)
        points.append(gallery.subject_points())
    for size in SIZES:
        stage = Stage(
            gallery.studio,
            gallery.world,
            np.vstack(points),
            size,
            BUDGET / len(poses) / 2,
            without_shadow=gallery.scenery,
        )
        started = time.process_time()
        samples = [_draw(stage, moment, seconds=0.0) for moment in moments]
        cost = (time.process_time() - started) / len(moments)
        if cost * len(poses) <= BUDGET:
            break
    return stage, samples, cost


def _draw(stage: Stage, poses: Poses, *, seconds: float) -> Image:
    stage.studio.arrange(poses)
    image = stage.take(dither=False)
    tile = stage.backdrop.tile
    write_caption(image, [f"{seconds:.2f} s", *([f"1 square = {tile:g} m"] if tile else [])])
    return image

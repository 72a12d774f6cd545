"""Draws the video of a live run, in a child: meshes of strangers are read for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.isolation.child import announce
from wsgen.rendering.drawing import drawn
from wsgen.rendering.recording import Clip, Recorder
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.rendering.video import draw_video
from wsgen.simulation.film import RATE, read_film
from wsgen.simulation.scene import RECORDING, NotDrawn

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.scene import Scene, Video


LOOKS = 12  # at the robots: as they drive around, the camera sees them all the time


def draw(scene: Scene, film_file: Path, file: Path) -> Video | NotDrawn:
    """Draw the frames of a film into a video.

    Args:
        scene: The world and all robots that were spawned into it.
        film_file: What `wsgen.simulation.film` wrote.
        file: The video, .gif or .mp4.
    """
    film = read_film(film_file)
    if not film.frames:
        return NotDrawn(problem="no robot was spawned")
    never_seen = {robot.entity for robot in scene.robots} - film.corners.keys()
    recorder = Recorder(lambda _: {}, 0.0)
    recorder.rate = RATE
    recorder.clips = [Clip("", film.frames)]

    def make() -> Video:
        renderer = SceneRenderer(scene, film.frames[-1], film.corners, never_seen)
        return draw_video(
            renderer,
            recorder,
            file,
            lambda text: announce(f"{RECORDING}: {text}"),
            looks=LOOKS,
            with_surroundings=True,
        )

    announce(RECORDING)
    return drawn(make)

"""Draws the video of a live run, in a child: meshes of strangers are read for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.isolation.child import announce
from wsgen.rendering.drawing import Clip, Recorder, drawn
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.rendering.video import draw_video
from wsgen.simulation.live_runs import NO_ROBOT, RATE, read_pose_log
from wsgen.simulation.scene import RECORDING, NotDrawn

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.scene import Scene, Video


LOOKS = 12  # at the robots: as they drive around, the camera sees them all the time


def draw(
    scene: Scene, log_file: Path, file: Path, progress: Path | None = None
) -> Video | NotDrawn:
    """Draw the frames of a pose log into a video.

    Args:
        scene: The world.
        log_file: The robots that were in it, and where: what `wsgen.simulation.live_runs` wrote.
        file: The video, .gif or .mp4.
        progress: A file that says how far it is, while it is drawn.
    """
    log = read_pose_log(log_file)
    if not log.frames:
        return NotDrawn(problem=NO_ROBOT)
    scene = replace(scene, robots=log.robots)
    recorder = Recorder(lambda _: {}, 0.0)
    recorder.rate = RATE
    recorder.clips = [Clip("", log.frames)]

    def report(frame: str) -> None:
        announce(f"{RECORDING}: {frame}")
        if progress is not None:
            progress.write_text(f"{file.name}: {frame}", encoding="utf-8")

    def make() -> Video:
        renderer = SceneRenderer(scene, log.frames[-1], log.corners, ())
        return draw_video(
            renderer,
            recorder,
            file,
            report,
            looks=LOOKS,
            with_surroundings=True,
        )

    announce(RECORDING)
    return drawn(make)

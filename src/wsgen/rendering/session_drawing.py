"""Draws the scene of a session: as it is now, and its last seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.rendering.drawing import drawn, poses_now
from wsgen.rendering.recording import Clip, Recorder, why_no_video
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.rendering.video import draw_video
from wsgen.simulation.scene import NotDrawn, Picture

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.running_scene import RunningScene
    from wsgen.simulation.scene import Video


def draw_picture(running: RunningScene, file: Path) -> Picture | NotDrawn:
    """Draw the robots as they are now."""
    return drawn(lambda: Picture(tile=_renderer(running).draw(file)))


def draw_last_seconds(running: RunningScene, file: Path) -> Video | NotDrawn:
    """Draw the frames that the scene remembers."""
    problem = why_no_video(file)
    if problem is None and not running.frames:
        problem = "nothing was recorded"
    if problem is not None:
        return NotDrawn(problem=problem)
    recorder = Recorder(running.engine.link_poses, 0.0)
    recorder.rate = running.rate
    recorder.clips = [Clip("", [poses for _, poses in running.frames])]
    return drawn(lambda: draw_video(_renderer(running), recorder, file, lambda _: None))


def _renderer(running: RunningScene) -> SceneRenderer:
    now = poses_now(running.engine, running.scene, running.refused)
    return SceneRenderer(running.scene, now.poses, now.corners, running.refused)

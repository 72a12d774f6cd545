"""What the child process of a simulation draws when it is over, and what kept it from doing so."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import WsgenError
from wsgen.isolation.child import announce
from wsgen.rendering.recording import Recorder, why_no_video
from wsgen.simulation.scene import DRAWING, RECORDING

if TYPE_CHECKING:
    from collections.abc import Callable, Container
    from pathlib import Path

    from wsgen.model.transform import Vector
    from wsgen.rendering.render_items import Poses
    from wsgen.rendering.scene_renderer import SceneRenderer
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.scene import Scene


NO_RENDERER = "PyBullet draws it, and has no wheel for this Python"


class Standing(NamedTuple):
    """What pictures are about: where everything was at the end of the robots' standing."""

    poses: Poses
    corners: dict[str, list[Vector]]  # m, of boxes around what can touch, and the links' frames


def remember(engine: Engine, scene: Scene, refused: Container[str]) -> Standing | None:
    """Look at everything, if a picture or a video is wanted."""
    if (scene.picture, scene.world_picture, scene.record) == (None, None, None):
        return None
    entities = [robot.entity for robot in scene.robots if robot.entity not in refused]
    poses: Poses = {entity: engine.link_poses(entity) for entity in entities}
    return Standing(
        poses,
        {
            entity: [*engine.corners(entity), *(pose.xyz for pose in poses[entity].values())]
            for entity in entities
        },
    )


def recorder_for(engine: Engine, scene: Scene) -> Recorder | None:
    """Who is to watch the simulation, if a video of it is wanted and can be written."""
    if scene.record is None or why_no_video(scene.record) is not None:
        return None
    static = [robot.entity for robot in scene.robots if robot.robot.is_static]
    behaving = sum(behavior_run.behavior.seconds for behavior_run in scene.behavior_runs)
    return Recorder(engine.link_poses, max(scene.seconds, behaving), immobile=static)


def draw(
    scene: Scene, refused: Container[str], recorder: Recorder | None, standing: Standing | None
) -> dict[str, Any]:
    """Draw what the scene wants; `standing` is what was remembered of it.

    Returns:
        `picture_tile` and `world_picture_tile`, the edge of a square in the picture (m) or None;
        `video`, the fields of a `Video` but its file. For what was wanted and could not be drawn
        there is a reason instead: `picture_problem`, `world_picture_problem`, `film_problem`.
    """
    told: dict[str, Any] = {}
    if scene.record is not None and recorder is None:
        told["film_problem"] = why_no_video(scene.record)
    has_static_models = any(
        robot.is_static_model for robot in scene.robots if robot.entity not in refused
    )
    wanted = {
        "picture": scene.picture is not None,
        "world_picture": scene.world_picture is not None and has_static_models,
        "video": recorder is not None,
    }
    if standing is None or not any(wanted.values()):
        return told
    announce(DRAWING)
    try:
        told |= _draw_all(scene, refused, recorder, standing, has_static_models=has_static_models)
    except Exception as error:  # noqa: BLE001  whatever it is, the simulation counts without pictures
        told |= {
            f"{kind}_problem": _reason(error) for kind, is_wanted in wanted.items() if is_wanted
        }
    return told


def _draw_all(
    scene: Scene,
    refused: Container[str],
    recorder: Recorder | None,
    standing: Standing,
    *,
    has_static_models: bool,
) -> dict[str, Any]:
    # NumPy's and Pillow's loading would cost every simulation as much as its simulation does, and
    # where
    # PyBullet has no wheels there is no picture.
    from wsgen.rendering.scene_renderer import SceneRenderer  # noqa: PLC0415

    scene_renderer = SceneRenderer(scene, standing.poses, standing.corners, refused)
    told: dict[str, Any] = {}
    if scene.picture is not None:
        file = scene.picture
        told |= _behavior_run("picture", "picture_tile", lambda: scene_renderer.draw(file))
    if scene.world_picture is not None and has_static_models:
        world_file = scene.world_picture
        told |= _behavior_run(
            "world_picture", "world_picture_tile", lambda: scene_renderer.draw_world(world_file)
        )
    if scene.record is not None and recorder is not None:
        video_file, progress = scene.record, scene.progress
        told |= _behavior_run(
            "video", "video", lambda: _video(scene_renderer, recorder, video_file, progress)
        )
    return told


def _video(
    scene_renderer: SceneRenderer, recorder: Recorder, file: Path, progress: Path | None
) -> dict[str, Any]:
    from wsgen.rendering.video import draw_video  # noqa: PLC0415  as above

    def tell(frame: str) -> None:
        announce(f"{RECORDING}: {frame}")
        if progress is not None:
            progress.write_text(f"{RECORDING}: {frame}", encoding="utf-8")

    announce(RECORDING)
    video = draw_video(scene_renderer, recorder, file, tell)
    return {key: value for key, value in asdict(video).items() if key != "file"}


def _behavior_run(kind: str, key: str, task: Callable[[], object]) -> dict[str, Any]:
    """What the task gives, under that key, or why it gives nothing."""
    try:
        return {key: task()}
    except Exception as error:  # noqa: BLE001  whatever it is, the rest counts without it
        return {f"{kind}_problem": _reason(error)}


def _reason(error: Exception) -> str:
    if isinstance(error, ImportError):
        return NO_RENDERER
    if isinstance(error, WsgenError):
        return f"{error.message[0].lower()}{error.message[1:].rstrip('.')}"
    return getattr(error, "strerror", None) or str(error) or repr(error)

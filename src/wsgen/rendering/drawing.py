"""What the child process of a simulation records and draws, when it is over, or why it cannot.

A recorder knows where all links are during a simulation. A session draws its scene as it is now,
and its last seconds.
"""

from __future__ import annotations

import math
import os
from dataclasses import field, replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from wsgen.errors import NotFoundError, WsgenError
from wsgen.isolation.child import announce
from wsgen.model.outcome import SceneView
from wsgen.rendering.render_items import subjects
from wsgen.simulation.scene import DRAWING, RECORDING, NotDrawn, Picture
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Container, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.transform import Pose, Vector
    from wsgen.rendering.render_items import Poses
    from wsgen.rendering.scene_renderer import SceneRenderer
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.running_scene import RunningScene
    from wsgen.simulation.scene import Scene, Video


EVERY = 5  # hundredths of a second, what GIF counts time in: 20 frames a second
MOST_FRAMES = 600  # of a long simulation there are fewer a second
ENCODER = "av"  # PyAV, which brings FFmpeg with it; wheels for every Python that wsgen runs on


def require_encoder(file: Path) -> None:
    """Check that what a video of that name needs is installed.

    Raises:
        NotFoundError: PyAV is not.
    """
    if _lacks_encoder(file):
        raise NotFoundError(
            "PyAV, which writes .mp4, is not installed.",
            hint="Install it: pip install 'wsgen[video]'; or record a .gif.",
        )


def _lacks_encoder(file: Path) -> bool:
    return file.suffix.lower() == ".mp4" and find_spec(ENCODER) is None


def why_no_video(file: Path) -> str | None:
    """What keeps a video from being written there, in a sentence with what to do; None if nothing.

    It is cheap; ask before a simulation.
    """
    if file.suffix.lower() not in {".gif", ".mp4"}:
        return f"`{file.name}` is neither a .gif nor an .mp4 file"
    if _lacks_encoder(file):
        return "an .mp4 file needs PyAV: name a .gif file, or pip install 'wsgen[video]'"
    if not file.parent.is_dir():
        return f"the folder {file.parent} does not exist"
    is_special = file.is_dir() or file.is_fifo()
    if is_special or not os.access(file if file.exists() else file.parent, os.W_OK):
        return f"{file} is not writable"
    return None


@dataclass(frozen=True)
class Clip:
    """A part of a video, without a cut."""

    name: str = ""  # of the behavior that it shows; empty for what every robot does: stand
    frames: list[Poses] = field(default_factory=list)


class Recorder:
    """An observer of a simulation: keeps the poses of all links at a fixed rate.

    `link_poses` gives those of a robot, as an engine does; robots that are `immobile` are asked
    about once. `seconds` is how long the video is about to be, in simulated time.
    """

    def __init__(
        self,
        link_poses: Callable[[str], Mapping[str, Pose]],
        seconds: float,
        *,
        immobile: Collection[str] = (),
    ) -> None:
        self.rate = 100 / max(EVERY, math.ceil(100 * seconds / MOST_FRAMES))  # frames a second
        self.clips = [Clip()]
        self._began = 0.0  # the last clip, s
        self._link_poses = link_poses
        self._immobile = immobile

    def begin(self, name: str, seconds: float) -> None:
        """A behavior begins now: what is seen from here on is a clip of its own."""
        self.clips.append(Clip(name))
        self._began = seconds

    @property
    def shown(self) -> list[Clip]:
        """What the video is of: the behaviors, or the standing where there are none."""
        return [clip for clip in self.clips[1:] if clip.frames] or self.clips[:1]

    def __call__(self, seconds: float, entities: Sequence[str]) -> None:
        """Look, if it is time for the next frame."""
        frames = self.clips[-1].frames
        if (seconds - self._began) * self.rate < len(frames) - 1e-6:
            return
        before = frames[-1] if frames else {}
        frames.append(
            {
                entity: before[entity]
                if entity in before and entity in self._immobile
                else self._link_poses(entity)
                for entity in entities
            }
        )


T = TypeVar("T")


class StandingPoses(NamedTuple):
    """What pictures show: where everything was when the robots had stood."""

    poses: Poses
    corners: dict[str, list[Vector]]  # m, of boxes around what can touch, and the links' frames


def remember(engine: Engine, scene: Scene, refused: Container[str]) -> StandingPoses | None:
    """Where everything is now, if a picture, a view or a video is wanted."""
    files = (scene.picture, scene.world_picture, scene.record)
    if files == (None, None, None) and not scene.view_triangles:
        return None
    return poses_now(engine, scene, refused)


def poses_now(engine: Engine, scene: Scene, refused: Container[str]) -> StandingPoses:
    """Where everything is now."""
    entities = [robot.entity for robot in scene.robots if robot.entity not in refused]
    poses: Poses = {entity: engine.link_poses(entity) for entity in entities}
    return StandingPoses(
        poses,
        {
            entity: [*engine.corners(entity), *(pose.xyz for pose in poses[entity].values())]
            for entity in entities
        },
    )


def recorder_for(engine: Engine, scene: Scene) -> Recorder | None:
    """What records the simulation, if a video of it is wanted and can be written."""
    if scene.record is None or why_no_video(scene.record) is not None:
        return None
    static = [robot.entity for robot in scene.robots if robot.robot.is_static]
    behaving = sum(behavior_run.behavior.seconds for behavior_run in scene.behavior_runs)
    return Recorder(engine.link_poses, max(scene.seconds, behaving), immobile=static)


@dataclass(frozen=True, kw_only=True)
class Drawings:
    """What became of the pictures and the video of a scene; None where one is not wanted."""

    picture: Picture | NotDrawn | None = None
    world_picture: Picture | NotDrawn | None = None
    video: Video | NotDrawn | None = None
    view: SceneView | NotDrawn | None = None

    def seen(self) -> SceneView | None:
        """The view, which says itself why it is empty."""
        if isinstance(self.view, NotDrawn):
            return SceneView(problem=self.view.problem)
        return self.view


def draw(
    scene: Scene, refused: Container[str], recorder: Recorder | None, standing: StandingPoses | None
) -> Drawings:
    """Draw what the scene wants; `standing` is what was remembered of it."""
    problem = None
    if scene.record is not None and recorder is None:
        problem = why_no_video(scene.record)
    drawings = Drawings(video=None if problem is None else NotDrawn(problem=problem))
    seen = subjects(scene)
    has_others = any(robot not in seen for robot in scene.robots if robot.entity not in refused)
    wanted = {
        "picture": scene.picture is not None,
        "world_picture": scene.world_picture is not None and has_others,
        "video": recorder is not None,
        "view": bool(scene.view_triangles),
    }
    if standing is None or not any(wanted.values()):
        return drawings
    announce(DRAWING)
    try:
        drawn = _draw_all(scene, refused, recorder, standing, has_others=has_others)
    except Exception as error:  # noqa: BLE001  whatever it is, the simulation counts without pictures
        not_drawn = NotDrawn(problem=_reason(error))
        return replace(
            drawings, **{kind: not_drawn for kind, is_wanted in wanted.items() if is_wanted}
        )
    return replace(drawn, video=drawn.video or drawings.video)


def _draw_all(
    scene: Scene,
    refused: Container[str],
    recorder: Recorder | None,
    standing: StandingPoses,
    *,
    has_others: bool,
) -> Drawings:
    # Loading NumPy and Pillow would cost every simulation as much as it takes itself.
    from wsgen.rendering.scene_renderer import SceneRenderer  # noqa: PLC0415

    scene_renderer = SceneRenderer(scene, standing.poses, standing.corners, refused)
    picture = world_picture = video = view = None
    if scene.picture is not None:
        file = scene.picture
        picture = drawn(lambda: Picture(tile=scene_renderer.draw(file)))
    if scene.world_picture is not None and has_others:
        world_file = scene.world_picture
        world_picture = drawn(lambda: Picture(tile=scene_renderer.draw_world(world_file)))
    if scene.view_triangles:  # before the video moves everything
        view = drawn(lambda: scene_renderer.view(scene.view_triangles))
    if scene.record is not None and recorder is not None:
        video_file, progress = scene.record, scene.progress
        video = drawn(lambda: _video(scene_renderer, recorder, video_file, progress))
    return Drawings(picture=picture, world_picture=world_picture, video=video, view=view)


def _video(
    scene_renderer: SceneRenderer, recorder: Recorder, file: Path, progress: Path | None
) -> Video:
    from wsgen.rendering.video import draw_video  # noqa: PLC0415  as above

    def report(frame: str) -> None:
        announce(f"{RECORDING}: {frame}")
        if progress is not None:
            progress.write_text(f"{RECORDING}: {frame}", encoding="utf-8")

    announce(RECORDING)
    return draw_video(scene_renderer, recorder, file, report)


def drawn(task: Callable[[], T]) -> T | NotDrawn:
    """What the task gives, or why it gives nothing."""
    try:
        return task()
    except Exception as error:  # noqa: BLE001  whatever it is, the rest counts without it
        return NotDrawn(problem=_reason(error))


def _reason(error: Exception) -> str:
    if isinstance(error, WsgenError):
        return f"{error.message[0].lower()}{error.message[1:].rstrip('.')}"
    return getattr(error, "strerror", None) or str(error) or repr(error)


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
    from wsgen.rendering.video import draw_video  # noqa: PLC0415  see `_draw_all`

    recorder = Recorder(running.engine.link_poses, 0.0)
    recorder.rate = running.rate
    recorder.clips = [Clip("", [poses for _, poses in running.frames])]
    return drawn(lambda: draw_video(_renderer(running), recorder, file, lambda _: None))


def _renderer(running: RunningScene) -> SceneRenderer:
    from wsgen.rendering.scene_renderer import SceneRenderer  # noqa: PLC0415  see `_draw_all`

    now = poses_now(running.engine, running.scene, running.refused)
    return SceneRenderer(running.scene, now.poses, now.corners, running.refused)

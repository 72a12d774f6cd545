"""Draw the video of a live run when it is over."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died
from wsgen.live.recording import Recorded
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.simulation.live_scene import SCENE_FILE, LiveScene
from wsgen.simulation.pose_log import NO_ROBOT, POSE_LOG_FILE
from wsgen.simulation.run import no_video
from wsgen.simulation.scene import NotDrawn, Video

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener


TASK = "wsgen.pipeline.tasks.video:draw"
PROGRESS_FILE = "drawn"  # in the live folder: how far the drawing is
LONGER = (
    "Have the run go on until a spawner has put a robot into the world: its output above says what "
    "it waits for."
)


def draw_video(
    folder: Path, file: Path, recorded: Callable[[Recorded], None], listener: Listener | None
) -> tuple[Diagnostic, ...]:
    """Draw what the simulator has left in the folder of its run; gives why it cannot be drawn.

    `recorded` is called when the file is complete. The files of the robots' meshes must be there.
    """
    if not (folder / POSE_LOG_FILE).exists():
        return (no_video(NO_ROBOT, LONGER),)
    clock = Clock("launch", listener)
    with (
        clock.step(DRAW, file.name, takes_long=True) as step,
        clock.watch(DRAW, folder / PROGRESS_FILE),
    ):
        drawn = _draw(folder, file)
        step.succeeded = isinstance(drawn, Video)
    if not isinstance(drawn, Video):
        return (no_video(drawn.problem, LONGER if drawn.problem == NO_ROBOT else None),)
    recorded(Recorded(file, drawn.frames / drawn.frames_per_second))
    return ()


def _draw(folder: Path, file: Path) -> Video | NotDrawn:
    live = decode(json.loads((folder / SCENE_FILE).read_text(encoding="utf-8")), LiveScene)
    outcome = parent.run(TASK, live.scene, folder / POSE_LOG_FILE, file, folder / PROGRESS_FILE)
    if isinstance(outcome, Died):
        return NotDrawn(problem=f"the renderer {outcome.reason} while it was {outcome.step}")
    kind: Any = Video | NotDrawn
    drawn: Video | NotDrawn = decode(outcome.value, kind)
    return drawn

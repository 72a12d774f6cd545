"""Draw the video of a live run when it is over."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died
from wsgen.pipeline.clock import Clock
from wsgen.simulation.film import FILM_FILE
from wsgen.simulation.live_scene import SCENE_FILE, LiveScene
from wsgen.simulation.run import no_video
from wsgen.simulation.scene import NotDrawn, Video

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener


TASK = "wsgen.tasks.film:draw"
NO_ROBOT = "the run ended before the simulator had a robot"


def draw_film(folder: Path, file: Path, listener: Listener | None) -> tuple[Diagnostic, ...]:
    """Draw what the simulator has left in the folder of its run; gives why it cannot be drawn.

    The files of the robots' meshes must be there.
    """
    if not (folder / FILM_FILE).exists():
        return (no_video(NO_ROBOT),)
    with Clock("launch", listener).step("draw", file.name) as step:
        drawn = _draw(folder, file)
        step.succeeded = isinstance(drawn, Video)
    return () if isinstance(drawn, Video) else (no_video(drawn.problem),)


def _draw(folder: Path, file: Path) -> Video | NotDrawn:
    live = decode(json.loads((folder / SCENE_FILE).read_text(encoding="utf-8")), LiveScene)
    outcome = parent.run(TASK, live.scene, folder / FILM_FILE, file)
    if isinstance(outcome, Died):
        return NotDrawn(problem=f"the renderer {outcome.reason} while it was {outcome.step}")
    kind: Any = Video | NotDrawn
    drawn: Video | NotDrawn = decode(outcome.value, kind)
    return drawn

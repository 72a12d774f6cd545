"""Draw the video of a live run when it is over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died
from wsgen.simulation.film import FILM_FILE
from wsgen.simulation.scene import NotDrawn, Video

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.scene import Scene


TASK = "wsgen.tasks.film:draw"


def draw_film(scene: Scene, folder: Path, file: Path) -> Video | NotDrawn:
    """Draw what the simulator has left in the folder of its run.

    Args:
        scene: What was simulated; the files of its meshes are there.
        folder: That of the live run.
        file: The video, .gif or .mp4.
    """
    film = folder / FILM_FILE
    if not film.exists():
        return NotDrawn(problem="the simulator was not started, or ended before a robot was there")
    outcome = parent.run(TASK, scene, film, file)
    if isinstance(outcome, Died):
        return NotDrawn(problem=f"the renderer {outcome.reason} while it was {outcome.step}")
    return decode(outcome.value, Video | NotDrawn)  # type: ignore[arg-type]

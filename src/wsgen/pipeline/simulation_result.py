"""What a simulation measured; apart from what runs it, which takes long to import."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

from wsgen.pipeline.clock import DRAW
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.outcome import RobotOutcome, SceneView
    from wsgen.pipeline.clock import Step
    from wsgen.pipeline.requests import ValidateRequest


@dataclass(frozen=True, kw_only=True)
class SimulationResult:
    """What a simulation measured, and what is reported about it."""

    robots: tuple[RobotOutcome, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()  # of the run alone
    causes: Mapping[Diagnostic, Diagnostic] = field(default_factory=dict)  # about descriptions:
    # as reported before, and with what followed from it in the run
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: Path | None = None
    video: Path | None = None
    view: SceneView | None = None
    seconds: Mapping[str, float] | None = None  # wall-clock: load, simulate, draw

    def diagnostics_after(self, before: Iterable[Diagnostic]) -> list[Diagnostic]:
        """What was reported before the run, and what the run adds to it."""
        return [*(self.causes.get(one, one) for one in before), *self.diagnostics]

    def report_drawing(self, step: Step, request: ValidateRequest) -> None:
        """Note in the step of the simulation what was drawn in it, and how long that took."""
        wanted = [request.video] if request.video else []
        if request.picture_folder is not None:
            wanted += [file for file in (self.picture, self.world_picture) if file]
        step.drawing = (self.seconds or {}).get(DRAW, 0.0) if wanted else 0.0
        step.drawn = ", ".join(file.name for file in wanted) if step.drawing else ""
        step.is_drawn = self.video is not None or request.video is None

"""What all runs have in common that differ only in parameters of wsgen's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.prepare import PreparedRobot


@dataclass(frozen=True, kw_only=True)
class Blueprint:
    """What `wsgen validate` has before it simulates: all of it can be pickled.

    The paths of its meshes are those of files of the machine that prepared it.
    """

    name: str  # of the package or file
    world: World | None  # None: it could not be read; the diagnostics say why
    prepared: tuple[PreparedRobot, ...] = ()  # robots, and models of the world
    behavior_plan: BehaviorPlan | None = None
    diagnostics: tuple[Diagnostic, ...] = ()  # that are reported before the simulation
    allow: tuple[str, ...] = ()  # names of rules that the package breaks on purpose
    push: Vector = (0.0, 0.0, 0.0)  # N, in the world, on the root link of each robot
    push_seconds: float = 0.5  # how long it acts; it begins after a third of the simulated time

"""Evaluate a launch file, and read from its plan which simulator and robots it starts."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Severity, has_errors
from wsgen.launch.evaluate import evaluate
from wsgen.launch.simulators import find_simulator
from wsgen.pipeline.gazebo_models import find_robots

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import Simulator, Spawn
    from wsgen.pipeline.selection import ValidateRequest
    from wsgen.workspace.overlay import Overlay


class Started(NamedTuple):
    """What a launch file starts."""

    plan: LaunchPlan
    simulator: Simulator | None
    spawns: tuple[Spawn, ...]
    diagnostics: tuple[Diagnostic, ...]  # of the plan; of simulator and spawners if it has no error
    # Or a robot in its world; in a plan that stopped at an error, a spawner before that.
    has_spawner: bool
    seconds: float  # wall-clock
    is_evaluated: bool  # to its end; or without helpers that are missing, where it spawns robots


def start(
    launch_file: Path, package: str | None, overlay: Overlay, request: ValidateRequest, run: Run
) -> Started:
    """Evaluate a launch file of a package with the arguments of the request; see `evaluate`."""
    before = time.perf_counter()
    plan = evaluate(
        launch_file,
        package=package,
        arguments=request.launch_arguments,
        environment=overlay.environment,
        answers=request.answers,
        run=run,
    )
    simulator, no_simulator = find_simulator(plan)
    robots = find_robots(plan, overlay.environment, overlay.share)
    lacks_something = has_errors(plan.diagnostics)
    found = tuple(
        one
        for one in (*no_simulator, *robots.diagnostics)
        if not lacks_something or one.severity is Severity.INFO
    )
    # A helper that is missing does not keep the robots from being simulated.
    is_evaluated = not lacks_something or (plan.is_complete and robots.are_meant)
    return Started(
        plan=plan,
        simulator=simulator,
        spawns=robots.spawns if is_evaluated else (),
        diagnostics=(*plan.diagnostics, *found),
        has_spawner=robots.are_meant,
        seconds=time.perf_counter() - before,
        is_evaluated=is_evaluated,
    )

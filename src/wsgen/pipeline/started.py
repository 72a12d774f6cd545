"""Evaluate a launch file, and read from its plan which simulator and robots it starts."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import has_errors
from wsgen.launch.evaluate import evaluate
from wsgen.launch.spawning import NO_ROBOT, find_simulator, find_spawns

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
    has_spawner: bool  # in a plan that stopped at an error, a spawner before that
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
    spawns, no_spawns = find_spawns(plan)
    lacks_something = has_errors(plan.diagnostics)
    found = () if lacks_something else (*no_simulator, *no_spawns)
    # A helper that is missing does not keep the robots from being simulated.
    is_evaluated = not lacks_something or (plan.is_complete and bool(spawns))
    return Started(
        plan=plan,
        simulator=simulator,
        spawns=spawns if is_evaluated else (),
        diagnostics=(*plan.diagnostics, *found),
        # A spawner that was created and not added is named as the element.
        has_spawner=bool(spawns)
        or any(one.code != NO_ROBOT.code or one.element for one in no_spawns),
        seconds=time.perf_counter() - before,
        is_evaluated=is_evaluated,
    )

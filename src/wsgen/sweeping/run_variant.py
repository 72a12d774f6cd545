"""One run of a sweep: what `wsgen validate` says of a blueprint with some parameters."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from wsgen.checks.rules.catalogue import without_allowed
from wsgen.diagnostics import Severity, has_errors
from wsgen.isolation.codec import decode
from wsgen.isolation.parent import run_here
from wsgen.isolation.result import Answered, Died
from wsgen.model.outcome import summed_up
from wsgen.model.sweep import Row
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.pipeline.simulation_result import SimulationResult
from wsgen.simulation.scene import Push, SceneResult
from wsgen.sweeping.apply import apply
from wsgen.sweeping.figures import figures_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.sweep import Variant
    from wsgen.simulation.scene import RobotRun
    from wsgen.sweeping.blueprint import Blueprint


PUSHED_AFTER = 1 / 3  # of the simulated time: until then most robots have come to rest
REPORTED = (Severity.ERROR, Severity.WARNING)


def run_variant(blueprint: Blueprint, variant: Variant, seconds: float, engine: str) -> Row:
    """Simulate one variant for so many seconds in an engine, in this process.

    This process should be a child that `isolation` started: the engine may crash.
    """
    return _run(blueprint, variant, seconds, engine, run_here)


def run_variants(
    blueprint: Blueprint, variants: Sequence[Variant], seconds: float, engine: str, longest: float
) -> list[Row]:
    """Simulate variants one after the other, as `run_variant`.

    None is begun after `longest` seconds of wall-clock time. Gives the rows of those that were
    simulated: at least of the first one.
    """
    until = time.monotonic() + longest
    rows: list[Row] = []
    for variant in variants:
        if rows and time.monotonic() > until:
            break
        rows.append(run_variant(blueprint, variant, seconds, engine))
    return rows


def row_without_run(blueprint: Blueprint, variant: Variant) -> Row:
    """The row of a blueprint that cannot be simulated: what is reported about it says why."""
    return _row(blueprint, variant, SimulationResult(), ())


def row_of_death(
    blueprint: Blueprint, variant: Variant, seconds: float, engine: str, death: Died
) -> Row:
    """The row of a variant that ends each process that simulates it."""

    def die(*_: object, **__: object) -> Died:
        return death

    return _run(blueprint, variant, seconds, engine, die)


def can_run(blueprint: Blueprint) -> bool:
    """Whether it has a robot in a world."""
    return blueprint.world is not None and not all(
        robot.is_static_model for robot in blueprint.prepared
    )


def can_be_pushed(blueprint: Blueprint) -> bool:
    """Whether a push moves one of its robots."""
    return any(
        not (robot.is_static_model or robot.lumped.fixed_to_world or robot.lumped.is_static)
        for robot in blueprint.prepared
    )


def _run(blueprint: Blueprint, variant: Variant, seconds: float, engine: str, run: Run) -> Row:
    varied = apply(blueprint, variant.values)
    if varied.world is None or not can_run(varied):
        return row_without_run(blueprint, variant)
    measured: list[RobotRun] = []

    def run_and_keep(*arguments: Any, **keywords: Any) -> Answered | Died:
        outcome = run(*arguments, **keywords)
        if isinstance(outcome, Answered):
            result = decode(outcome.value, SceneResult)
            measured[:] = result.robot_runs
        return outcome

    simulated = simulate_robots(
        varied.world,
        varied.prepared,
        ValidateRequest(seconds=seconds, engines=(engine,)),
        varied.name,
        run=run_and_keep,
        behavior_plan=varied.behavior_plan,
        pushes=pushes_of(varied, seconds),
        keep_engines=True,
    )
    return _row(varied, variant, simulated, measured)


def pushes_of(blueprint: Blueprint, seconds: float) -> tuple[Push, ...]:
    """The pushes on its robots, when so many seconds are simulated."""
    if not any(blueprint.push):
        return ()
    return tuple(
        Push(
            entity=robot.entity,
            link=robot.lumped.root,
            force=blueprint.push,
            begin=seconds * PUSHED_AFTER,
            seconds=blueprint.push_seconds,
        )
        for robot in blueprint.prepared
        if not robot.is_static_model
    )


def _row(
    blueprint: Blueprint,
    variant: Variant,
    simulated: SimulationResult,
    measured: Iterable[RobotRun],
) -> Row:
    found = simulated.diagnostics_after(blueprint.diagnostics)
    reported = summed_up(without_allowed(found, blueprint.allow))
    return Row(
        number=variant.number,
        passed=bool(simulated.robots) and not has_errors(reported),
        codes=tuple(sorted({found.code for found in reported if found.severity in REPORTED})),
        diagnostic=_first_error(reported),
        figures=figures_of(blueprint, simulated.robots, measured),
    )


def _first_error(reported: Iterable[Diagnostic]) -> str | None:
    for found in reported:
        if found.severity is Severity.ERROR:
            return f"{found.code} {found.name}: {found.message}"
    return None

"""Simulate prepared robots in a world, in one engine or more, and check what was measured."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.isolation.result import Limits
from wsgen.model.outcome import Rest, RobotOutcome, Simulated
from wsgen.pipeline.clock import DRAW
from wsgen.rules.check import check_run
from wsgen.rules.consequences import fold_consequences, joints_beyond_limits
from wsgen.rules.runs import (
    KEEPS_MOVING,
    OVERLAPPING_ROBOTS,
    SPAWNED_IN_GROUND,
    STUCK_IN_GROUND,
    TIPS_OVER,
    engines_disagree,
)
from wsgen.simulation.contact_shapes import MOST_LINKS, most_parts
from wsgen.simulation.run import missing_engines, run_simulation
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.clock import Step
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.selection import ValidateRequest
    from wsgen.simulation.scene import RobotRun, SimulationOutcome


# What models of a world may do that are no robots: lie in each other or in the ground, and move.
MOVES = {
    rule.code
    for rule in (KEEPS_MOVING, TIPS_OVER, STUCK_IN_GROUND, SPAWNED_IN_GROUND, OVERLAPPING_ROBOTS)
}
ENGINE_NAMES = {"bullet": "PyBullet", "dart": "DART"}


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


def simulate_robots(  # noqa: PLR0913  what is simulated, and how
    world: World,
    prepared: Sequence[PreparedRobot],
    request: ValidateRequest,
    name: str,
    *,
    run: Run,
    behavior_plan: BehaviorPlan | None = None,
    progress: Path | None = None,
) -> SimulationResult:
    """Simulate the robots that can be simulated, and check all; `name` is the picture's.

    `behavior_plan` is what they must do beyond standing; the child process writes the progress of a
    video to the file `progress`.
    """
    runnable = [robot for robot in prepared if robot.can_run]
    robots = [robot for robot in prepared if not robot.is_static_model]
    not_run = () if behavior_plan is None else behavior_plan.diagnostics
    nothing = tuple(_outcome(robot, None, behavior_plan=behavior_plan) for robot in robots)
    if all(robot.is_static_model for robot in runnable):
        return SimulationResult(robots=nothing, diagnostics=not_run)
    changes = tuple(_beyond_bullet(runnable)) if "bullet" in request.engines else ()
    if changes:
        request = replace(request, engines=("dart",))
    limits = _limits(request, behavior_plan)
    outcomes = [
        run_simulation(
            replace(
                _scene(world, runnable, request, name, engine=engine, behavior_plan=behavior_plan),
                progress=progress,
            ),
            limits=limits,
            run=run,
        )
        for engine in request.engines
    ]
    found: list[Diagnostic] = [*not_run, *changes]
    failed: set[str] = set()
    for engine, outcome in zip(request.engines, outcomes, strict=True):
        checked, failed_here = _check(world, runnable, outcome, behavior_plan)
        found += checked if engine == request.engines[0] else _others(checked, found, engine)
        failed |= failed_here
    first, *others = outcomes
    for other in others:
        found += _compare(first, other)
    measured = {robot_run.entity: robot_run for robot_run in first.robot_runs}
    causes, found = _fold(runnable, found)
    return SimulationResult(
        robots=tuple(
            _outcome(
                robot,
                measured.get(robot.entity),
                engine=request.engines[0],
                passed=robot.can_run and robot.entity not in failed,
                behavior_plan=behavior_plan,
                found=found,
            )
            for robot in robots
        ),
        diagnostics=tuple(found),
        causes=causes,
        picture=first.picture,
        picture_tile=first.picture_tile,
        world_picture=first.world_picture,
        video=first.video.file if first.video else None,
        seconds=first.seconds,
    )


ENGINE_CHANGED = Rule(
    code="SPN089",
    name="engine-changed",
    severity=Severity.INFO,
    summary="The robot is too complex for PyBullet; DART simulates it.",
    what="Counts the links, and further parts where a link has several frictions.",
    why="PyBullet does not simulate robots with more parts than its limit.",
    example="wsgen validate my_robot",
    instead="wsgen validate my_robot --engine dart",
)


def _beyond_bullet(robots: Sequence[PreparedRobot]) -> Iterator[Diagnostic]:
    """For each robot that is too much for PyBullet, report that DART simulates it."""
    if missing_engines(["dart"]):
        return  # PyBullet says what to install
    for robot in robots:
        parts = most_parts(robot.lumped)
        if parts > MOST_LINKS:
            yield ENGINE_CHANGED.at(
                None,
                element=robot.entity,
                message=f"The robot has {parts} links with separate friction, more than the "
                f"{MOST_LINKS} that PyBullet simulates: DART simulates it.",
                hint="Add --engine dart to choose DART yourself.",
            )


def _limits(request: ValidateRequest, behavior_plan: BehaviorPlan | None) -> Limits:
    """How long a simulation may take.

    Large robots are slower than real time; the limit is for a simulation that hangs.
    """
    seconds = request.seconds
    if behavior_plan is not None:  # before each it stands again
        seconds += behavior_plan.seconds + request.seconds * len(behavior_plan.behavior_runs)
    return Limits(seconds=60.0 + 20.0 * seconds)


def _check(
    world: World,
    runnable: Sequence[PreparedRobot],
    outcome: SimulationOutcome,
    behavior_plan: BehaviorPlan | None,
) -> tuple[list[Diagnostic], set[str]]:
    """The diagnostics of the simulation in one engine, and the entities that do not pass it."""
    failed: set[str] = set()
    static_models = {robot.entity for robot in runnable if robot.is_static_model}
    found = [_soften(one) if one.element in static_models else one for one in outcome.diagnostics]
    measured = {robot_run.entity: robot_run for robot_run in outcome.robot_runs}
    free = [robot for robot in runnable if not robot.lumped.is_static]
    for robot in runnable:
        robot_run = measured.get(robot.entity)
        checked = (
            ()
            if robot_run is None
            else check_run(
                robot.lumped,
                world,
                robot_run,
                height=robot.height,
                is_alone=len(free) == 1,
                static_models=static_models,
                pushed=joints_beyond_limits(robot.diagnostics),
            )
        )
        if robot.is_static_model:
            checked = tuple(_about_model(one, robot.entity) for one in checked)
        elif robot.may_move:
            checked = tuple(_soften(one) if one.code in MOVES else one for one in checked)
        elif behavior_plan is not None:
            checked = (*checked, *(behavior_plan.check(robot_run) if robot_run else ()))
            if behavior_plan.fails(robot.entity):
                failed.add(robot.entity)
        if robot_run is None or has_errors(checked):
            failed.add(robot.entity)
        found += checked
    return found, failed


def _fold(
    robots: Sequence[PreparedRobot], found: Sequence[Diagnostic]
) -> tuple[dict[Diagnostic, Diagnostic], list[Diagnostic]]:
    """Causes in the descriptions with what follows from them, and all other diagnostics."""
    causes: dict[Diagnostic, Diagnostic] = {}
    left = list(found)
    for robot in robots:
        own = [one for one in left if one.element == robot.entity]
        folded = fold_consequences(robot.diagnostics, own)
        changed = zip(robot.diagnostics, folded.prepared, strict=True)
        causes |= {before: after for before, after in changed if before != after}
        left = [one for one in left if one not in own or one in folded.run]
    return causes, left


def _soften(diagnostic: Diagnostic) -> Diagnostic:
    """A warning instead of an error: the robots that are validated do not fail for it."""
    is_error = diagnostic.severity is Severity.ERROR
    return replace(diagnostic, severity=Severity.WARNING) if is_error else diagnostic


def _about_model(diagnostic: Diagnostic, entity: str) -> Diagnostic:
    """What is said of a model of the world, which is no robot."""
    message = diagnostic.message.replace("The robot", f"The model `{entity}`", 1)
    return _soften(replace(diagnostic, message=message))


def _others(
    checked: Sequence[Diagnostic], reported: Sequence[Diagnostic], engine: str
) -> list[Diagnostic]:
    """The diagnostics of a second engine that the first did not have, with its name."""
    known = {(found.code, found.element) for found in reported}
    return [
        replace(found, message=f"In {ENGINE_NAMES[engine]}: {found.message}")
        for found in checked
        if (found.code, found.element) not in known
    ]


def _compare(first: SimulationOutcome, other: SimulationOutcome) -> Iterator[Diagnostic]:
    measured = {robot_run.entity: robot_run for robot_run in other.robot_runs}
    for robot_run in first.robot_runs:
        if robot_run.entity in measured:
            yield from engines_disagree(robot_run, measured[robot_run.entity])


def _scene(  # noqa: PLR0913  what is in it, and how it is played
    world: World,
    runnable: Sequence[PreparedRobot],
    request: ValidateRequest,
    name: str,
    *,
    engine: str,
    behavior_plan: BehaviorPlan | None,
) -> Scene:
    is_first = engine == request.engines[0]
    folder = request.picture_folder.absolute() if request.picture_folder and is_first else None
    return Scene(
        world=world,
        robots=tuple(
            SpawnedRobot(
                entity=robot.entity,
                robot=robot.lumped,
                pose_in_world=robot.spawn_pose,
                on_the_ground=robot.on_the_ground,
                is_static_model=robot.is_static_model,
            )
            for robot in runnable
        ),
        seconds=request.seconds,
        behavior_runs=() if behavior_plan is None else behavior_plan.behavior_runs,
        engine=engine,
        picture=folder / f"{name}.png" if folder else None,
        world_picture=folder / f"{name}-world.png" if folder else None,
        record=request.video.absolute() if request.video and is_first else None,
    )


def _outcome(  # noqa: PLR0913  what is known of it; most have defaults
    prepared: PreparedRobot,
    robot_run: RobotRun | None,
    *,
    engine: str = "",
    passed: bool = False,
    behavior_plan: BehaviorPlan | None = None,
    found: Sequence[Diagnostic] = (),
) -> RobotOutcome:
    written = prepared.written
    return RobotOutcome(
        entity=prepared.entity,
        spawn_pose=prepared.spawn_pose if robot_run is None else robot_run.spawn_pose,
        links=len(written.links),
        joints=len(written.joints),
        movable_joints=len(written.movable_joints),
        mass=written.mass,
        simulated=None
        if robot_run is None
        else Simulated(
            engine=engine,
            links=robot_run.links,
            movable_joints=robot_run.movable_joints,
            mass=robot_run.mass,
        ),
        rest=None
        if robot_run is None
        else Rest(
            pose_in_world=robot_run.rest_pose,
            settled_after=robot_run.settled_after,
            speed=robot_run.speed,
            joint_positions=robot_run.joint_positions,
        ),
        behaviors=()
        if behavior_plan is None
        else behavior_plan.outcomes(prepared.entity, robot_run, found),
        passed=passed,
    )

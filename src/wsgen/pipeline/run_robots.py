"""Try described robots in one world or more, and check what was measured."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.isolation.outcome import Limits
from wsgen.model.outcome import Rest, RobotOutcome, Simulated
from wsgen.pipeline.clock import DRAW
from wsgen.rules.causes import fold_consequences, joints_beyond_limits
from wsgen.rules.check import check_run
from wsgen.rules.scenes import engines_disagree
from wsgen.simulation.contact_shapes import MOST_LINKS, most_parts
from wsgen.simulation.run import missing_engines, run_simulation
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.behaviors import BehaviorPlan
    from wsgen.pipeline.clock import Step
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.simulation.scene import RobotRun, SimulationOutcome


MOVES = {"SPN058", "SPN059"}  # keeps moving, tips over
ENGINE_NAMES = {"bullet": "PyBullet", "dart": "DART"}


@dataclass(frozen=True, kw_only=True)
class SimulationResult:
    """What came of a simulation."""

    robots: tuple[RobotOutcome, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()  # of the run alone
    causes: Mapping[Diagnostic, Diagnostic] = field(default_factory=dict)  # about descriptions:
    # as reported before, and with what followed from it in the run
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: Path | None = None
    video: Path | None = None
    seconds: Mapping[str, float] | None = None  # wall-clock: load, simulate, draw

    def told_after(self, before: Iterable[Diagnostic]) -> list[Diagnostic]:
        """What was reported before the run, and what the run adds to it."""
        return [*(self.causes.get(one, one) for one in before), *self.diagnostics]

    def tell_drawing(self, step: Step, request: ValidateRequest) -> None:
        """Say of the step of the simulation what was to be drawn in it, and how long that took."""
        wanted = [request.video] if request.video else []
        if request.picture_folder is not None:
            wanted += [file for file in (self.picture, self.world_picture) if file]
        step.drawing = (self.seconds or {}).get(DRAW, 0.0) if wanted else 0.0
        step.drawn = ", ".join(file.name for file in wanted) if step.drawing else ""
        step.is_drawn = self.video is not None or request.video is None


def try_robots(  # noqa: PLR0913  what is tried, and how
    world: World,
    prepared: Sequence[PreparedRobot],
    request: ValidateRequest,
    name: str,
    *,
    run: Run,
    behavior_plan: BehaviorPlan | None = None,
    progress: Path | None = None,
) -> SimulationResult:
    """Simulate the sound robots, if there are any, and check all; `name` is the picture's.

    `behavior plan` is what they must do beyond standing; into the file `progress` the child process
    writes how far a video is.
    """
    sound = [robot for robot in prepared if robot.is_sound]
    robots = [robot for robot in prepared if not robot.is_static_model]
    untried = () if behavior_plan is None else behavior_plan.diagnostics
    nothing = tuple(_outcome(robot, None, behavior_plan=behavior_plan) for robot in robots)
    if all(robot.is_static_model for robot in sound):
        return SimulationResult(robots=nothing, diagnostics=untried)
    changes = tuple(_beyond_bullet(sound)) if "bullet" in request.engines else ()
    if changes:
        request = replace(request, engines=("dart",))
    limits = _limits(request, behavior_plan)
    outcomes = [
        run_simulation(
            replace(
                _scene(world, sound, request, name, engine=engine, behavior_plan=behavior_plan),
                progress=progress,
            ),
            limits=limits,
            run=run,
        )
        for engine in request.engines
    ]
    found: list[Diagnostic] = [*untried, *changes]
    failed: set[str] = set()
    for engine, outcome in zip(request.engines, outcomes, strict=True):
        checked, failed_here = _check(world, sound, outcome, behavior_plan)
        found += checked if engine == request.engines[0] else _others(checked, found, engine)
        failed |= failed_here
    first, *others = outcomes
    for other in others:
        found += _compared(first, other)
    measured = {robot_run.entity: robot_run for robot_run in first.robot_runs}
    causes, found = _fold(sound, found)
    return SimulationResult(
        robots=tuple(
            _outcome(
                robot,
                measured.get(robot.entity),
                engine=request.engines[0],
                passed=robot.is_sound and robot.entity not in failed,
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


def _beyond_bullet(robots: Sequence[PreparedRobot]) -> Iterator[Diagnostic]:
    """For each robot that is too much for PyBullet, that DART takes its place, if it can."""
    if missing_engines(["dart"]):
        return  # PyBullet says what to install
    for robot in robots:
        parts = most_parts(robot.lumped)
        if parts > MOST_LINKS:
            yield Diagnostic(
                code="SPN089",
                severity=Severity.INFO,
                message=f"The robot has {parts} links with a friction of their own, more than the "
                f"{MOST_LINKS} that PyBullet simulates: it is simulated in DART.",
                element=robot.entity,
                hint="Add --engine dart to choose DART yourself.",
            )


def _limits(request: ValidateRequest, behavior_plan: BehaviorPlan | None) -> Limits:
    """How long a simulation may take.

    Large robots are slower than their own time; this is about hanging, not about slow.
    """
    seconds = request.seconds
    if behavior_plan is not None:  # before each it stands again
        seconds += behavior_plan.seconds + request.seconds * len(behavior_plan.behavior_runs)
    return Limits(seconds=60.0 + 20.0 * seconds)


def _check(
    world: World,
    sound: Sequence[PreparedRobot],
    outcome: SimulationOutcome,
    behavior_plan: BehaviorPlan | None,
) -> tuple[list[Diagnostic], set[str]]:
    """What is found in the simulation of one engine, and the entities that do not pass it."""
    failed: set[str] = set()
    static_models = {robot.entity for robot in sound if robot.is_static_model}
    found = [_soften(one) if one.element in static_models else one for one in outcome.diagnostics]
    measured = {robot_run.entity: robot_run for robot_run in outcome.robot_runs}
    free = [robot for robot in sound if not robot.lumped.is_static]
    for robot in sound:
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
            checked = tuple(map(_soften, checked))
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
    """Causes in the descriptions with what follows from them, and what is found besides."""
    causes: dict[Diagnostic, Diagnostic] = {}
    left = list(found)
    for robot in robots:
        own = [one for one in left if one.element == robot.entity]
        folded = fold_consequences(robot.diagnostics, own)
        changed = zip(robot.diagnostics, folded.prepared, strict=True)
        causes |= {before: after for before, after in changed if before != after}
        left = [one for one in left if one not in own or one in folded.run]
    return causes, left


def _soften(finding: Diagnostic) -> Diagnostic:
    """A finding about the scenery: worth telling, and no fault of the robots that are checked."""
    is_error = finding.severity is Severity.ERROR
    return replace(finding, severity=Severity.WARNING) if is_error else finding


def _others(
    checked: Sequence[Diagnostic], told: Sequence[Diagnostic], engine: str
) -> list[Diagnostic]:
    """The findings of a second engine that the first had not, with its name."""
    known = {(finding.code, finding.element) for finding in told}
    return [
        replace(finding, message=f"In {ENGINE_NAMES[engine]}: {finding.message}")
        for finding in checked
        if (finding.code, finding.element) not in known
    ]


def _compared(first: SimulationOutcome, other: SimulationOutcome) -> Iterator[Diagnostic]:
    measured = {robot_run.entity: robot_run for robot_run in other.robot_runs}
    for robot_run in first.robot_runs:
        if robot_run.entity in measured:
            yield from engines_disagree(robot_run, measured[robot_run.entity])


def _scene(  # noqa: PLR0913  what is in it, and how it is played
    world: World,
    sound: Sequence[PreparedRobot],
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
            for robot in sound
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

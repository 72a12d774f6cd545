"""Try described robots in one world or more, and judge what was measured."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.isolation.outcome import Limits
from wsgen.model.outcome import Rest, RobotOutcome, Simulated
from wsgen.pipeline.clock import DRAW
from wsgen.rules.causes import fold_consequences, joints_beyond_limits
from wsgen.rules.check import judge_trial
from wsgen.rules.scenes import engines_disagree
from wsgen.simulation.contact_shapes import MOST_LINKS, most_parts
from wsgen.simulation.run import missing_engines, run_trial
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.behaviors import Programme
    from wsgen.pipeline.clock import Step
    from wsgen.pipeline.prepare import Described
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.simulation.scene import RobotTrial, TrialOutcome


MOVES = {"SPN058", "SPN059"}  # keeps moving, tips over
ENGINE_NAMES = {"bullet": "PyBullet", "dart": "DART"}


@dataclass(frozen=True, kw_only=True)
class Tried:
    """What came of a trial."""

    robots: tuple[RobotOutcome, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()  # of the run alone
    causes: Mapping[Diagnostic, Diagnostic] = field(default_factory=dict)  # about descriptions:
    # as reported before, and with what followed from it in the run
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: Path | None = None
    film: Path | None = None
    seconds: Mapping[str, float] | None = None  # wall-clock: load, simulate, draw

    def told_after(self, before: Iterable[Diagnostic]) -> list[Diagnostic]:
        """What was reported before the run, and what the run adds to it."""
        return [*(self.causes.get(one, one) for one in before), *self.diagnostics]

    def tell_drawing(self, step: Step, request: ValidateRequest) -> None:
        """Say of the step of the trial what was to be drawn in it, and how long that took."""
        wanted = [request.film] if request.film else []
        if request.picture_folder is not None:
            wanted += [file for file in (self.picture, self.world_picture) if file]
        step.drawing = (self.seconds or {}).get(DRAW, 0.0) if wanted else 0.0
        step.drawn = ", ".join(file.name for file in wanted) if step.drawing else ""
        step.is_drawn = self.film is not None or request.film is None


def try_robots(  # noqa: PLR0913  what is tried, and how
    world: World,
    described: Sequence[Described],
    request: ValidateRequest,
    name: str,
    *,
    run: Run,
    programme: Programme | None = None,
    progress: Path | None = None,
) -> Tried:
    """Simulate the sound robots, if there are any, and judge all; `name` is the picture's.

    `programme` is what they must do beyond standing; into the file `progress` the child process
    writes how far a video is.
    """
    sound = [robot for robot in described if robot.is_sound]
    robots = [robot for robot in described if not robot.is_scenery]
    untried = () if programme is None else programme.diagnostics
    nothing = tuple(_outcome(robot, None, programme=programme) for robot in robots)
    if all(robot.is_scenery for robot in sound):
        return Tried(robots=nothing, diagnostics=untried)
    changes = tuple(_beyond_bullet(sound)) if "bullet" in request.engines else ()
    if changes:
        request = replace(request, engines=("dart",))
    limits = _limits(request, programme)
    outcomes = [
        run_trial(
            replace(
                _scene(world, sound, request, name, engine=engine, programme=programme),
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
        judged, failed_here = _judge(world, sound, outcome, programme)
        found += judged if engine == request.engines[0] else _others(judged, found, engine)
        failed |= failed_here
    first, *others = outcomes
    for other in others:
        found += _compared(first, other)
    measured = {trial.entity: trial for trial in first.trials}
    causes, found = _fold(sound, found)
    return Tried(
        robots=tuple(
            _outcome(
                robot,
                measured.get(robot.entity),
                engine=request.engines[0],
                passed=robot.is_sound and robot.entity not in failed,
                programme=programme,
                found=found,
            )
            for robot in robots
        ),
        diagnostics=tuple(found),
        causes=causes,
        picture=first.picture,
        picture_tile=first.picture_tile,
        world_picture=first.world_picture,
        film=first.film.file if first.film else None,
        seconds=first.seconds,
    )


def _beyond_bullet(robots: Sequence[Described]) -> Iterator[Diagnostic]:
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


def _limits(request: ValidateRequest, programme: Programme | None) -> Limits:
    """How long a trial may take.

    Large robots are slower than their own time; this is about hanging, not about slow.
    """
    seconds = request.seconds
    if programme is not None:  # before each it stands again
        seconds += programme.seconds + request.seconds * len(programme.attempts)
    return Limits(seconds=60.0 + 20.0 * seconds)


def _judge(
    world: World,
    sound: Sequence[Described],
    outcome: TrialOutcome,
    programme: Programme | None,
) -> tuple[list[Diagnostic], set[str]]:
    """What is found in the trial of one engine, and the entities that do not pass it."""
    failed: set[str] = set()
    scenery = {robot.entity for robot in sound if robot.is_scenery}
    found = [_soften(one) if one.element in scenery else one for one in outcome.diagnostics]
    measured = {trial.entity: trial for trial in outcome.trials}
    free = [robot for robot in sound if not robot.lumped.is_static]
    for robot in sound:
        trial = measured.get(robot.entity)
        judged = (
            ()
            if trial is None
            else judge_trial(
                robot.lumped,
                world,
                trial,
                height=robot.height,
                is_alone=len(free) == 1,
                scenery=scenery,
                pushed=joints_beyond_limits(robot.diagnostics),
            )
        )
        if robot.is_scenery:
            judged = tuple(map(_soften, judged))
        elif robot.may_move:
            judged = tuple(_soften(one) if one.code in MOVES else one for one in judged)
        elif programme is not None:
            judged = (*judged, *(programme.judge(trial) if trial else ()))
            if programme.fails(robot.entity):
                failed.add(robot.entity)
        if trial is None or has_errors(judged):
            failed.add(robot.entity)
        found += judged
    return found, failed


def _fold(
    robots: Sequence[Described], found: Sequence[Diagnostic]
) -> tuple[dict[Diagnostic, Diagnostic], list[Diagnostic]]:
    """Causes in the descriptions with what follows from them, and what is found besides."""
    causes: dict[Diagnostic, Diagnostic] = {}
    left = list(found)
    for robot in robots:
        own = [one for one in left if one.element == robot.entity]
        folded = fold_consequences(robot.diagnostics, own)
        changed = zip(robot.diagnostics, folded.described, strict=True)
        causes |= {before: after for before, after in changed if before != after}
        left = [one for one in left if one not in own or one in folded.run]
    return causes, left


def _soften(finding: Diagnostic) -> Diagnostic:
    """A finding about the scenery: worth telling, and no fault of the robots that are judged."""
    is_error = finding.severity is Severity.ERROR
    return replace(finding, severity=Severity.WARNING) if is_error else finding


def _others(
    judged: Sequence[Diagnostic], told: Sequence[Diagnostic], engine: str
) -> list[Diagnostic]:
    """The findings of a second engine that the first had not, with its name."""
    known = {(finding.code, finding.element) for finding in told}
    return [
        replace(finding, message=f"In {ENGINE_NAMES[engine]}: {finding.message}")
        for finding in judged
        if (finding.code, finding.element) not in known
    ]


def _compared(first: TrialOutcome, other: TrialOutcome) -> Iterator[Diagnostic]:
    measured = {trial.entity: trial for trial in other.trials}
    for trial in first.trials:
        if trial.entity in measured:
            yield from engines_disagree(trial, measured[trial.entity])


def _scene(  # noqa: PLR0913  what is in it, and how it is played
    world: World,
    sound: Sequence[Described],
    request: ValidateRequest,
    name: str,
    *,
    engine: str,
    programme: Programme | None,
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
                is_scenery=robot.is_scenery,
            )
            for robot in sound
        ),
        seconds=request.seconds,
        attempts=() if programme is None else programme.attempts,
        engine=engine,
        picture=folder / f"{name}.png" if folder else None,
        world_picture=folder / f"{name}-world.png" if folder else None,
        record=request.film.absolute() if request.film and is_first else None,
    )


def _outcome(  # noqa: PLR0913  what is known of it; most have defaults
    described: Described,
    trial: RobotTrial | None,
    *,
    engine: str = "",
    passed: bool = False,
    programme: Programme | None = None,
    found: Sequence[Diagnostic] = (),
) -> RobotOutcome:
    written = described.written
    return RobotOutcome(
        entity=described.entity,
        spawn_pose=described.spawn_pose if trial is None else trial.spawn_pose,
        links=len(written.links),
        joints=len(written.joints),
        movable_joints=len(written.movable_joints),
        mass=written.mass,
        simulated=None
        if trial is None
        else Simulated(
            engine=engine,
            links=trial.links,
            movable_joints=trial.movable_joints,
            mass=trial.mass,
        ),
        rest=None
        if trial is None
        else Rest(
            pose_in_world=trial.rest_pose,
            settled_after=trial.settled_after,
            speed=trial.speed,
            joint_positions=trial.joint_positions,
        ),
        behaviours=() if programme is None else programme.outcomes(described.entity, trial, found),
        passed=passed,
    )

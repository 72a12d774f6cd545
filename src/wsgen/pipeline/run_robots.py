"""Simulate prepared robots in a world, in one engine or more, and check what was measured."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.check_run import check_run
from wsgen.checks.rules.consequences import fold_consequences, joints_beyond_limits
from wsgen.checks.rules.runs import (
    ENGINE_UNSTABLE,
    GAINS_ENERGY,
    KEEPS_MOVING,
    NO_BUOYANCY,
    OVERLAPPING_ROBOTS,
    SPAWNED_IN_GROUND,
    STATE_NOT_FINITE,
    STUCK_IN_GROUND,
    TIPS_OVER,
    UNACTUATED_JOINTS_MOVE,
    engines_disagree,
)
from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.events import OneAtATime
from wsgen.isolation.result import Limits
from wsgen.model.behavior import ELEMENT
from wsgen.model.engines import ENGINES, GAZEBO, name_engines
from wsgen.model.outcome import EngineOutcome, Rest, RobotOutcome, Simulated
from wsgen.model.robot import MOST_LINKS
from wsgen.pipeline.parallel import run_parallel
from wsgen.pipeline.requests import SimulationResult
from wsgen.simulation.contact_shapes import most_parts
from wsgen.simulation.run import installed_engines, run_simulation
from wsgen.simulation.scene import Scene, SimulationOutcome, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.real_gazebo import Judged, RealGazebo
    from wsgen.pipeline.requests import ValidateRequest
    from wsgen.simulation.scene import Push, RobotRun


# What models of a world may do that are no robots: lie in each other or in the ground, and move.
MOVES = {
    rule.code
    for rule in (KEEPS_MOVING, TIPS_OVER, STUCK_IN_GROUND, SPAWNED_IN_GROUND, OVERLAPPING_ROBOTS)
}

GAZEBO_SIM_ENGINE = "dart"  # what is unstable in it is so in Gazebo Sim


class _EngineResult(NamedTuple):
    """What is known of a simulation in one engine."""

    engine: str
    runs: Mapping[str, RobotRun]  # by entity
    diagnostics: list[Diagnostic]
    failed: set[str]  # the entities that do not pass
    untried: set[str]  # of these, those whose behaviors cannot be simulated, and that pass besides
    version: str = ""  # of the user's own Gazebo


def simulate_robots(  # noqa: PLR0913  what is simulated, and how
    world: World,
    prepared: Sequence[PreparedRobot],
    request: ValidateRequest,
    name: str,
    *,
    run: Run,
    behavior_plan: BehaviorPlan | None = None,
    progress: Path | None = None,
    pushes: tuple[Push, ...] = (),
    keep_engines: bool = False,
    gazebo: RealGazebo | None = None,
) -> SimulationResult:
    """Simulate the robots that can be simulated, and check all; `name` is the picture's.

    `behavior_plan` is what they must do beyond standing; the child process writes the progress of a
    video to the file `progress`. `pushes` act on robots while they stand. An engine that is
    unstable with a robot is replaced by one that is not, unless `keep_engines`. `gazebo` is the
    user's own, which simulates the same.
    """
    simulate = partial(
        _simulate,
        world,
        prepared,
        name=name,
        run=run,
        behavior_plan=behavior_plan,
        progress=progress,
        pushes=pushes,
        gazebo=gazebo,
    )
    simulated, results = simulate(request)
    unstable = {one.engine: gains for one in results if (gains := _unstable_robots(one))}
    # What has run live for the behaviors was measured in the engines of the request alone.
    is_live = behavior_plan is not None and bool(behavior_plan.live)
    if keep_engines or is_live or not unstable or GAZEBO_SIM_ENGINE in unstable:
        return simulated
    engines = tuple(one.engine for one in results)
    others = tuple(engine for engine in engines if engine not in unstable)
    others = others or tuple(
        engine for engine in reversed(installed_engines()) if engine not in engines
    )
    # One is enough, if no comparison is asked for.
    others = others if engines[1:] else others[:1]
    found = _report_unstable(unstable, others)
    if not others:
        return replace(simulated, diagnostics=(*simulated.diagnostics, *found))
    again, results = simulate(replace(request, engines=others), found)
    runnable = {robot.entity for robot in prepared if robot.can_run}
    is_stable = not any(_unstable_robots(one) or runnable - one.runs.keys() for one in results)
    return again if is_stable else simulated


def _simulate(  # noqa: PLR0913  as above
    world: World,
    prepared: Sequence[PreparedRobot],
    request: ValidateRequest,
    known: Sequence[Diagnostic] = (),
    *,
    name: str,
    run: Run,
    behavior_plan: BehaviorPlan | None,
    progress: Path | None,
    pushes: tuple[Push, ...],
    gazebo: RealGazebo | None,
) -> tuple[SimulationResult, Sequence[_EngineResult]]:
    """Simulate the robots in the engines of the request, and check all.

    `known` is what is reported of them already.
    """
    runnable = [robot for robot in prepared if robot.can_run]
    robots = [robot for robot in prepared if not robot.is_static_model]
    not_run = () if behavior_plan is None else behavior_plan.diagnostics
    if gazebo is None and all(robot.is_static_model for robot in runnable):
        nothing = tuple(_outcome(robot, (), behavior_plan, ()) for robot in robots)
        return SimulationResult(robots=nothing, diagnostics=not_run), ()
    changes = tuple(_beyond_bullet(runnable, request.engines))
    if changes:
        request = replace(request, engines=engines_for(runnable, request.engines))
    scenes = [
        replace(
            _scene(world, runnable, request, name, engine=engine, behavior_plan=behavior_plan),
            progress=progress,
            pushes=pushes,
        )
        for engine in request.engines
    ]
    is_moving = not all(robot.is_static_model for robot in runnable)
    outcomes = [SimulationOutcome()] * len(scenes)  # Gazebo alone takes what wsgen refuses
    if is_moving:
        outcomes = _run_scenes(scenes, _limits(request, behavior_plan), request.jobs, run)
    results = [
        _check(world, runnable, engine, outcome, behavior_plan)
        for engine, outcome in zip(request.engines, outcomes, strict=True)
    ]
    own = results
    if gazebo is not None:
        judged = gazebo.simulate(world, robots, results[0].runs, request.seconds)
        not_run = (*not_run, *judged.diagnostics)
        if judged.asked:
            results = [*results, _check_gazebo(world, runnable, robots, judged)]
    found = [*not_run, *changes, *of_all_engines((one.engine, one.diagnostics) for one in results)]
    found += [*_compare(runnable, results), *known]
    shown = {} if behavior_plan is None else behavior_plan.entities
    causes, left = _fold(runnable, found, shown)
    first = outcomes[0]
    simulated = SimulationResult(
        robots=tuple(_outcome(robot, results, behavior_plan, found) for robot in robots),
        diagnostics=tuple(left),
        causes=causes,
        picture=first.picture,
        picture_tile=first.picture_tile,
        world_picture=first.world_picture,
        video=first.video.file if first.video else None,
        view=first.view,
        seconds=first.seconds,
    )
    return simulated, own


ENGINE_CHANGED = Rule(
    code="SPN089",
    name="engine-changed",
    severity=Severity.INFO,
    summary="The robot is too complex for PyBullet; another engine simulates it.",
    what="Counts the links, and additional parts for links with several friction values.",
    why="PyBullet cannot simulate robots with more parts than its limit.",
    example="wsgen validate my_robot",
    instead="wsgen validate my_robot --engine mujoco",
)


def _unstable_robots(result: _EngineResult) -> dict[str, str]:
    """The robots with which an engine is unstable, and how that shows."""
    codes = {(one.code, one.element) for one in result.diagnostics if has_errors((one,))}
    shown: dict[str, str] = {}
    for entity, robot_run in result.runs.items():
        if (STATE_NOT_FINITE.code, entity) in codes:
            shown[entity] = "its pose becomes infinite or not-a-number"
        elif (GAINS_ENERGY.code, entity) in codes:
            shown[entity] = f"it gains {robot_run.energy_gain:.3g} J although it is not driven"
    return shown


def _report_unstable(
    unstable: Mapping[str, Mapping[str, str]], others: Sequence[str]
) -> list[Diagnostic]:
    """Report in which engines robots are unstable, where those in `others` are not."""
    tried = name_engines(unstable)
    found = []
    for entity, shown in next(iter(unstable.values())).items():
        if not others:
            message = (
                f"Only {tried} simulated the robot: the cause may be the engine, not the robot."
            )
            hint = (
                "Install DART, the engine of Gazebo Sim, for a second result: pip install "
                "'wsgen[dart]'"
            )
        else:
            other = name_engines(others)
            message = f"{tried} cannot simulate the robot stably: {shown}. The result is {other}'s."
            hint = (
                "Check the inertias, which are usually too small for the masses; or select the "
                f"engine with --engine {others[0]}."
            )
        found.append(ENGINE_UNSTABLE.at(None, element=entity, message=message, hint=hint))
    return found


def _engines_without_bullet(engines: Sequence[str]) -> tuple[str, ...]:
    """The other engines of a request; if it has none, the next one that is installed, if any."""
    others = tuple(engine for engine in engines if engine != "bullet")
    return others or tuple(name for name in installed_engines() if name != "bullet")[:1]


def engines_for(robots: Sequence[PreparedRobot], engines: Sequence[str]) -> Sequence[str]:
    """The engines of a request that simulate these robots, or another one that does."""
    changes = any(_beyond_bullet(robots, engines))
    return _engines_without_bullet(engines) if changes else engines


def _beyond_bullet(robots: Sequence[PreparedRobot], engines: Sequence[str]) -> Iterator[Diagnostic]:
    """For each robot that is too much for PyBullet, report which engines simulate it."""
    others = _engines_without_bullet(engines) if "bullet" in engines else ()
    if not others:
        return  # PyBullet is not asked for, or says what to install
    for robot in robots:
        parts = most_parts(robot.lumped)
        if parts > MOST_LINKS:
            yield ENGINE_CHANGED.at(
                None,
                element=robot.entity,
                message=f"The robot has {parts} links with separate friction, more than the "
                f"{MOST_LINKS} that PyBullet simulates: {name_engines(others)} "
                f"simulate{'s' if len(others) == 1 else ''} it.",
                hint=f"Add --engine {others[0]} to choose {ENGINES[others[0]].title} yourself."
                if len(engines) == 1
                else "No action is needed; the comparison does not include PyBullet.",
            )


def _run_scenes(
    scenes: Sequence[Scene], limits: Limits, jobs: int, run: Run
) -> list[SimulationOutcome]:
    """Simulate each scene, `jobs` at a time."""
    if min(jobs, len(scenes)) == 1:
        return [run_simulation(scene, limits=limits, run=run) for scene in scenes]
    ended: list[SimulationOutcome] = []
    run_parallel(
        lambda run: [partial(run_simulation, scene, limits=limits, run=run) for scene in scenes],
        jobs,
        OneAtATime(None),
        ended,
    )
    return ended


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
    engine: str,
    outcome: SimulationOutcome,
    behavior_plan: BehaviorPlan | None,
) -> _EngineResult:
    """Check a simulation in one engine."""
    failed: set[str] = set()
    untried: set[str] = set()
    static_models = {robot.entity for robot in runnable if robot.is_static_model}
    found = [_soften(one) if one.element in static_models else one for one in outcome.diagnostics]
    measured = {robot_run.entity: robot_run for robot_run in outcome.robot_runs}
    for robot in runnable:
        robot_run = measured.get(robot.entity)
        checked = () if robot_run is None else check_robot(world, runnable, robot, robot_run)
        if robot.is_static_model:
            checked = tuple(_about_model(one, robot.entity) for one in checked)
        elif robot.may_move:
            checked = tuple(_soften(one) if one.code in MOVES else one for one in checked)
        elif behavior_plan is not None:
            checked = (*checked, *(behavior_plan.check(robot_run, engine) if robot_run else ()))
            if behavior_plan.fails(robot.entity):
                untried.add(robot.entity)
        is_described = robot.is_static_model or not has_errors(robot.diagnostics)
        if robot_run is None or not is_described or has_errors(checked):
            failed.add(robot.entity)
        found += checked
    return _EngineResult(engine, measured, found, failed | untried, untried - failed)


def _check_gazebo(
    world: World,
    runnable: Sequence[PreparedRobot],
    robots: Sequence[PreparedRobot],
    judged: Judged,
) -> _EngineResult:
    """Check what the user's own Gazebo did, as what the engines did is checked."""
    found: list[Diagnostic] = []
    failed = set(judged.asked - judged.runs.keys())
    for robot in robots:
        # What wsgen refuses is not known well enough to be checked.
        robot_run = judged.runs.get(robot.entity) if robot.can_run else None
        checked = () if robot_run is None else check_robot(world, runnable, robot, robot_run)
        if robot.may_move:
            checked = tuple(_soften(one) if one.code in MOVES else one for one in checked)
        failed |= {robot.entity} if has_errors(checked) else set()
        found += checked
    return _EngineResult(GAZEBO, judged.runs, found, failed, set(), judged.version)


def check_robot(
    world: World, runnable: Sequence[PreparedRobot], robot: PreparedRobot, robot_run: RobotRun
) -> tuple[Diagnostic, ...]:
    """Check what was measured of one of the robots of a scene."""
    return check_run(
        robot.lumped,
        world,
        robot_run,
        height=robot.height,
        is_alone=sum(not one.lumped.is_static for one in runnable) == 1,
        static_models={
            one.entity for one in runnable if one.is_static_model or one.lumped.is_static
        },
        pushed=joints_beyond_limits(robot.diagnostics),
    )


def _fold(
    robots: Sequence[PreparedRobot], found: Sequence[Diagnostic], shown: Mapping[str, str]
) -> tuple[dict[Diagnostic, Diagnostic], list[Diagnostic]]:
    """Causes in the descriptions with what follows from them, and all other diagnostics.

    `shown` says which robot shows a behavior, by its name.
    """
    causes: dict[Diagnostic, Diagnostic] = {}
    left = list(found)
    for robot in robots:
        names = {ELEMENT.format(name) for name, entity in shown.items() if entity == robot.entity}
        own = [one for one in left if one.element in {robot.entity, *names}]
        if any(one.code == SPAWNED_IN_GROUND.code and has_errors((one,)) for one in own):
            left = [one for one in left if one.element not in names]  # it never stood
            own = [one for one in own if one in left]
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


def of_all_engines(
    results: Iterable[tuple[str, Iterable[Diagnostic]]],
) -> Iterator[Diagnostic]:
    """The diagnostics of all engines, by engine; those of one rule about one element once.

    They are those of the engine that reports the worst, and name the engines that report it, if
    these are not all. What is about no element is about one engine, or about its pictures.
    """
    reported: dict[tuple[str, str], dict[str, list[Diagnostic]]] = {}
    number = 0  # of engines
    for engine, diagnostics in results:
        number += 1
        for found in diagnostics:
            if found.element is None:
                yield found
            else:
                engines = reported.setdefault((found.code, found.element), {})
                engines.setdefault(engine, []).append(found)
    for engines in reported.values():
        worst = min(engines.values(), key=_worst_severity)
        prefix = "" if len(engines) == number else f"In {name_engines(engines)}: "
        yield from (replace(found, message=f"{prefix}{found.message}") for found in worst)


def _compare(
    runnable: Sequence[PreparedRobot], results: Sequence[_EngineResult]
) -> Iterator[Diagnostic]:
    """Say where the engines disagree about a robot."""
    reported = {(one.code, one.element) for result in results for one in result.diagnostics}
    on_hull = {
        entity
        for result in results
        for robot_run in result.runs.values()
        for gap in robot_run.hull_gaps
        for entity in (robot_run.entity, gap.other_entity)
    }
    for robot in runnable:
        entity = robot.entity
        if (NO_BUOYANCY.code, entity) in reported:
            continue  # each engine lets it fall in its own way
        yield from engines_disagree(
            {result.engine: result.runs[entity] for result in results if entity in result.runs},
            is_on_hull=entity in on_hull,
            has_passive_joints=(UNACTUATED_JOINTS_MOVE.code, entity) in reported,
        )


def _worst_severity(found: Iterable[Diagnostic]) -> int:
    return min(list(Severity).index(one.severity) for one in found)


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
        robots=spawned_robots(runnable),
        seconds=request.seconds,
        behavior_runs=() if behavior_plan is None else behavior_plan.behavior_runs,
        engine=engine,
        samples=request.samples,
        picture=folder / f"{name}.png" if folder else None,
        world_picture=folder / f"{name}-world.png" if folder else None,
        record=request.video.absolute() if request.video and is_first else None,
        view_triangles=request.view_triangles if is_first else 0,
    )


def spawned_robots(runnable: Iterable[PreparedRobot]) -> tuple[SpawnedRobot, ...]:
    """What a scene has of robots that are ready for an engine."""
    return tuple(
        SpawnedRobot(
            entity=robot.entity,
            robot=robot.lumped,
            pose_in_world=robot.spawn_pose,
            on_the_ground=robot.on_the_ground,
            is_static_model=robot.is_static_model,
            is_of_world=robot.may_move,
            drive=robot.drive,
        )
        for robot in runnable
    )


def _outcome(
    prepared: PreparedRobot,
    results: Sequence[_EngineResult],
    behavior_plan: BehaviorPlan | None,
    found: Sequence[Diagnostic],
) -> RobotOutcome:
    """What is known of a robot; `found` are the diagnostics of all engines."""
    written, entity = prepared.written, prepared.entity
    runs = [result.runs.get(entity) for result in results]
    first = runs[0] if runs else None
    return RobotOutcome(
        entity=entity,
        spawn_pose=prepared.spawn_pose if first is None else first.spawn_pose,
        links=len(written.links),
        joints=len(written.joints),
        movable_joints=len(written.movable_joints),
        mass=written.mass,
        engines=tuple(_in_engine(prepared, result, behavior_plan) for result in results),
        behaviors=()
        if behavior_plan is None
        else behavior_plan.outcomes(entity, first, found, results[0].engine if results else None),
        passed=bool(results)
        and prepared.can_run
        and not any(entity in one.failed for one in results),
        description=written,
    )


def _in_engine(
    prepared: PreparedRobot, result: _EngineResult, behavior_plan: BehaviorPlan | None
) -> EngineOutcome:
    entity = prepared.entity
    robot_run = result.runs.get(entity)
    is_gazebo = result.engine == GAZEBO
    behavior_plan = None if is_gazebo else behavior_plan  # it only stands there
    behaviors = (
        ()
        if behavior_plan is None
        else behavior_plan.outcomes(entity, robot_run, result.diagnostics, result.engine)
    )
    live = () if behavior_plan is None else behavior_plan.live_series(entity, result.engine)
    if robot_run is None:
        return EngineOutcome(engine=result.engine, version=result.version, behaviors=behaviors)
    return EngineOutcome(
        engine=result.engine,
        version=result.version,
        simulated=Simulated(
            engine=result.engine,
            links=robot_run.links,
            movable_joints=robot_run.movable_joints,
            mass=robot_run.mass,
        ),
        rest=Rest(
            pose_in_world=robot_run.rest_pose,
            settled_after=robot_run.settled_after,
            speed=robot_run.speed,
            tilt=robot_run.tilt,
            joint_positions=robot_run.joint_positions,
        ),
        behaviors=behaviors,
        passed=(prepared.can_run or is_gazebo) and entity not in result.failed,
        is_untried=prepared.can_run and entity in result.untried,
        codes=frozenset(one.code for one in result.diagnostics if one.element == entity),
        time_series=(*robot_run.time_series, *live),
    )

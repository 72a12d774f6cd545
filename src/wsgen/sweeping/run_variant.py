"""One run of a sweep: what `wsgen validate` says of a blueprint with some parameters, as a row.

A blueprint varies by parameters of wsgen's own without reading anything. Poses, and all that is
measured, stay relative to the ground: on a slope gravity is tilted instead, so that "up" is the
ground's normal. Columns are in SI units.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wsgen.checks.rules.catalogue import without_allowed
from wsgen.diagnostics import Severity, has_errors
from wsgen.isolation.codec import decode
from wsgen.isolation.parent import run_here
from wsgen.isolation.result import Answered, Died
from wsgen.model.behavior import Drive, Reach
from wsgen.model.outcome import summed_up
from wsgen.model.sweep import Column, Row, free_name
from wsgen.model.transform import Pose
from wsgen.pipeline.requests import SimulationResult, ValidateRequest
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.simulation.scene import Push, SceneResult
from wsgen.sweeping.parameters import (
    FRICTION,
    FRICTION_SCALE,
    GRAVITY,
    INERTIA_SCALE,
    MASS_SCALE,
    PUSH_DIRECTION,
    PUSH_FORCE,
    PUSH_SECONDS,
    SLOPE,
    SPAWN_PITCH,
    SPAWN_ROLL,
    SPAWN_X,
    SPAWN_Y,
    SPAWN_YAW,
    SPAWN_Z,
    own_values,
)
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.behavior import Behavior, BehaviorOutcome
    from wsgen.model.outcome import RobotOutcome
    from wsgen.model.robot import Inertial, Link, Robot, Surface
    from wsgen.model.sweep import Figure, Value, Variant
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.pipeline.behavior_plan import BehaviorPlan
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.scene import RobotRun


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
    """Simulate variants as `run_variant`, one after the other; see `rows_until`."""
    return rows_until(longest, variants, lambda one: run_variant(blueprint, one, seconds, engine))


def rows_until(
    longest: float, variants: Sequence[Variant], run: Callable[[Variant], Row]
) -> list[Row]:
    """The rows of the variants that were run: at least of the first one.

    None is begun after `longest` seconds of wall-clock time.
    """
    until = time.monotonic() + longest
    rows: list[Row] = []
    for variant in variants:
        if rows and time.monotonic() > until:
            break
        rows.append(run(variant))
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


OF_THE_SPAWN_POSE = (SPAWN_X, SPAWN_Y, SPAWN_Z, SPAWN_ROLL, SPAWN_PITCH, SPAWN_YAW)
OF_THE_WORLD = (SLOPE, GRAVITY)
OF_THE_LINKS = (FRICTION, MASS_SCALE, INERTIA_SCALE, FRICTION_SCALE)


def apply(blueprint: Blueprint, values: Mapping[str, Value]) -> Blueprint:
    """The blueprint with the values of those parameters that are wsgen's own.

    Models of the world around the robots stay as they are. Parameters of other names, which have
    had their effect on the blueprint already, are left out.
    """
    own = own_values(values)
    if not own:
        return blueprint
    world = blueprint.world
    return replace(
        blueprint,
        world=None if world is None else _tilted(world, own),
        prepared=tuple(
            robot if robot.is_static_model else _varied(robot, own) for robot in blueprint.prepared
        ),
        push=_push(own) if PUSH_FORCE in own else blueprint.push,
        push_seconds=own.get(PUSH_SECONDS, blueprint.push_seconds),
    )


def _tilted(world: World, own: Mapping[str, float]) -> World:
    """The world with its gravity, seen from a ground that falls along +x."""
    if not any(name in own for name in OF_THE_WORLD):
        return world
    x, y, z = world.gravity
    strength = math.hypot(x, y, z)
    if GRAVITY in own:
        factor = own[GRAVITY] / strength if strength else 0.0
        x, y, z = (factor * x, factor * y, factor * z) if strength else (0.0, 0.0, -own[GRAVITY])
    slope = own.get(SLOPE, 0.0)
    sin, cos = math.sin(slope), math.cos(slope)
    return replace(world, gravity=(x * cos - z * sin, y, x * sin + z * cos))


def _push(own: Mapping[str, float]) -> Vector:
    """The force in the world; without a direction along +x."""
    direction = own.get(PUSH_DIRECTION, 0.0)
    return own[PUSH_FORCE] * math.cos(direction), own[PUSH_FORCE] * math.sin(direction), 0.0


def _varied(prepared: PreparedRobot, own: Mapping[str, float]) -> PreparedRobot:
    if any(name in own for name in OF_THE_SPAWN_POSE):
        prepared = _moved(prepared, own)
    if not any(name in own for name in OF_THE_LINKS):
        return prepared
    vary = _link_varier(own)
    return replace(
        prepared,
        written=_with_links(prepared.written, vary),
        lumped=_with_links(prepared.lumped, vary),
        readable=None if prepared.readable is None else _with_links(prepared.readable, vary),
    )


def _moved(prepared: PreparedRobot, own: Mapping[str, float]) -> PreparedRobot:
    (x, y, z), (roll, pitch, yaw) = prepared.spawn_pose.xyz, prepared.spawn_pose.rpy
    pose = Pose(
        xyz=(own.get(SPAWN_X, x), own.get(SPAWN_Y, y), own.get(SPAWN_Z, z)),
        rpy=(own.get(SPAWN_ROLL, roll), own.get(SPAWN_PITCH, pitch), own.get(SPAWN_YAW, yaw)),
    )
    if SPAWN_Z not in own:
        return replace(prepared, spawn_pose=pose)
    # No launch file gives this height: hints must not name one.
    return replace(prepared, spawn_pose=pose, on_the_ground=False, height=None)


def _with_links(robot: Robot, vary: Callable[[Link], Link]) -> Robot:
    return replace(robot, links=tuple(map(vary, robot.links)))


def _link_varier(own: Mapping[str, float]) -> Callable[[Link], Link]:
    """What makes of a link the one with other masses, inertias and frictions."""
    mass = own.get(MASS_SCALE, 1.0)
    inertia = mass * own.get(INERTIA_SCALE, 1.0)
    scale, ground = own.get(FRICTION_SCALE, 1.0), own.get(FRICTION, math.inf)
    has_friction = FRICTION_SCALE in own or FRICTION in own
    has_inertia = MASS_SCALE in own or INERTIA_SCALE in own

    def surface_of(surface: Surface) -> Surface:
        # Two that touch have the friction of the smaller coefficient.
        return replace(
            surface,
            mu1=min(ground, scale * surface.mu1),
            mu2=min(ground, scale * surface.mu2),
        )

    def inertial_of(inertial: Inertial) -> Inertial:
        xx, xy, xz, yy, yz, zz = (inertia * moment for moment in inertial.inertia)
        return replace(inertial, mass=mass * inertial.mass, inertia=(xx, xy, xz, yy, yz, zz))

    def vary(link: Link) -> Link:
        if has_inertia and link.inertial is not None:
            link = replace(link, inertial=inertial_of(link.inertial))
        if has_friction and link.collisions:
            link = replace(
                link,
                collisions=tuple(
                    replace(shape, surface=surface_of(shape.surface)) for shape in link.collisions
                ),
            )
        return link

    return vary


# Of each robot: name, kind and meaning.
OF_A_ROBOT = (
    ("rest_x", "m, of the root link's frame at the end, in the world"),
    ("rest_y", "m, likewise"),
    ("rest_z", "m, likewise"),
    ("rest_roll", "rad, of the root link's frame at the end, in the world"),
    ("rest_pitch", "rad, likewise"),
    ("rest_yaw", "rad, likewise"),
    ("tilt", "rad, between what was up in the robot when spawned and up, at the end"),
    ("settled_after", "s, simulated: from then on it was at rest; none if it moved at the end"),
    ("drift", "m, horizontally, from where it was spawned to where it was at the end"),
    ("highest_joint_speed", "rad/s or m/s, of the joint that was the fastest at any time"),
    ("highest_speed", "m/s, of the root link's center of mass"),
    ("seconds", "s, simulated until the end; fewer where a state was not finite any more"),
)


def columns(blueprint: Blueprint) -> tuple[Column, ...]:
    """The columns that runs of a blueprint fill, without those of parameters.

    Where it has one robot, these have bare names; else `ENTITY.` is before them.
    """
    entities = _entities(blueprint)
    found = [
        Column(name=f"{_prefix(entity, entities)}{name}", kind="number", meaning=meaning)
        for entity in entities
        for name, meaning in OF_A_ROBOT
    ]
    plan = blueprint.behavior_plan
    for behavior in () if plan is None else plan.behaviors:
        found += _of_behavior(behavior)
    return tuple(found)


def _of_behavior(behavior: Behavior) -> Iterator[Column]:
    name = f"behavior.{behavior.name}"
    yield Column(name=f"{name}.passed", kind="boolean", meaning="whether it did what it must")
    if isinstance(behavior.task, Drive):
        frame = "of where it was when it began"
        yield Column(name=f"{name}.x", kind="number", meaning=f"m, moved along x {frame}")
        yield Column(name=f"{name}.y", kind="number", meaning=f"m, moved along y {frame}")
        yield Column(name=f"{name}.yaw", kind="number", meaning="rad, turned, whole turns included")
        return
    if not isinstance(behavior.task, Reach):
        return
    for heading in _of_joints(name, behavior.task).values():
        yield Column(name=heading, kind="number", meaning="rad or m, at its end")


def _of_joints(name: str, task: Reach) -> dict[str, str]:
    """The columns of a behavior's joints, by joint; one may be called `passed`."""
    headings = {joint: f"{name}.{joint}" for joint in task.positions}
    if "passed" in headings:
        headings["passed"] = free_name("passed", headings.values(), "joint.", f"{name}.")
    return headings


def figures_of(
    blueprint: Blueprint,
    robots: Iterable[RobotOutcome],
    robot_runs: Iterable[RobotRun],
) -> dict[str, Figure]:
    """What was measured, by column; a number that is not finite is None."""
    entities = _entities(blueprint)
    measured = {robot_run.entity: robot_run for robot_run in robot_runs}
    figures: dict[str, Figure] = {}
    for robot in robots:
        robot_run = measured.get(robot.entity)
        if robot_run is not None:
            prefix = _prefix(robot.entity, entities)
            figures |= {f"{prefix}{name}": of for name, of in _of_run(robot_run).items()}
        for behavior in robot.behaviors:
            figures |= _of_outcome(behavior)
    return {name: _finite(figure) for name, figure in figures.items()}


def _of_run(robot_run: RobotRun) -> Mapping[str, Figure]:
    (x, y, z), (roll, pitch, yaw) = robot_run.rest_pose.xyz, robot_run.rest_pose.rpy
    spawned_x, spawned_y, _ = robot_run.spawn_pose.xyz
    return {
        "rest_x": x,
        "rest_y": y,
        "rest_z": z,
        "rest_roll": roll,
        "rest_pitch": pitch,
        "rest_yaw": yaw,
        "tilt": robot_run.tilt,
        "settled_after": robot_run.settled_after,
        "drift": math.hypot(x - spawned_x, y - spawned_y),
        "highest_joint_speed": robot_run.highest_joint_speed,
        "highest_speed": robot_run.highest_speed,
        "seconds": robot_run.seconds,
    }


def _of_outcome(behavior: BehaviorOutcome) -> Mapping[str, Figure]:
    name = f"behavior.{behavior.name}"
    figures: dict[str, Figure] = {f"{name}.passed": behavior.passed}
    if behavior.moved is not None:
        figures |= {
            f"{name}.{part}": moved
            for part, moved in zip(("x", "y", "yaw"), behavior.moved, strict=True)
        }
    if behavior.positions and isinstance(behavior.task, Reach):
        headings = _of_joints(name, behavior.task)
        figures |= {headings[joint]: at for joint, at in behavior.positions.items()}
    return figures


def _finite(figure: Figure) -> Figure:
    return figure if not isinstance(figure, float) or math.isfinite(figure) else None


def _entities(blueprint: Blueprint) -> list[str]:
    return [robot.entity for robot in blueprint.prepared if not robot.is_static_model]


def _prefix(entity: str, entities: list[str]) -> str:
    return "" if len(entities) == 1 else f"{entity}."

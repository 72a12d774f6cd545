"""The columns of the table of a sweep, and what a run puts into them. SI units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.behavior import Drive, Reach
from wsgen.model.sweep import Column, free_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.model.behavior import Behavior, BehaviorOutcome
    from wsgen.model.outcome import RobotOutcome
    from wsgen.model.sweep import Figure
    from wsgen.simulation.scene import RobotRun
    from wsgen.sweeping.blueprint import Blueprint


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

"""The behaviors that a package asks of its robots: which can be simulated, and their results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.behavior import BehaviorOutcome, BehaviorRun, Drive
from wsgen.rules.behaviors import (
    check_behavior,
    command_beyond_limit,
    no_diff_drive,
    unclear_behavior_robot,
    unknown_behavior_joint,
)
from wsgen.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.scene import RobotRun
    from wsgen.workspace.settings import Settings


@dataclass(frozen=True, kw_only=True)
class BehaviorPlan:
    """The behaviors of a package, and the robots that they are for."""

    file: Path  # that they are written in
    entities: dict[str, str]  # which robot shows what, by the name of the behavior
    behaviors: tuple[Behavior, ...]
    behavior_runs: tuple[BehaviorRun, ...]  # those that can be simulated
    diagnostics: tuple[Diagnostic, ...]  # why the rest cannot

    @property
    def seconds(self) -> float:
        """Of simulated time, without what comes before each."""
        return sum(behavior_run.behavior.seconds for behavior_run in self.behavior_runs)

    def check(self, robot_run: RobotRun) -> tuple[Diagnostic, ...]:
        """Check what a robot did."""
        behavior_runs = {
            behavior_run.behavior.name: behavior_run for behavior_run in self.behavior_runs
        }
        return tuple(
            found
            for behaved in robot_run.behaviors
            for found in check_behavior(behavior_runs[behaved.name], behaved, self.file)
        )

    def fails(self, entity: str) -> bool:
        """Whether a behavior of this robot cannot be simulated."""
        simulated = {behavior_run.behavior.name for behavior_run in self.behavior_runs}
        return any(
            name not in simulated for name, shown_by in self.entities.items() if shown_by == entity
        )

    def outcomes(
        self, entity: str, robot_run: RobotRun | None, diagnostics: Iterable[Diagnostic]
    ) -> tuple[BehaviorOutcome, ...]:
        """The results of the behaviors of a robot, with the diagnostics of all engines."""
        failed = {found.element for found in diagnostics}
        measured = {} if robot_run is None else {one.name: one for one in robot_run.behaviors}
        outcomes = []
        for behavior in self.behaviors:
            if self.entities.get(behavior.name) != entity:
                continue
            behaved = measured.get(behavior.name)
            task = behavior.task
            is_drive = isinstance(task, Drive)
            outcomes.append(
                BehaviorOutcome(
                    name=behavior.name,
                    task=task,
                    passed=behaved is not None and f"behavior `{behavior.name}`" not in failed,
                    moved=behaved.moved if behaved and is_drive else None,
                    positions={name: behaved.positions[name] for name in task.positions}
                    if behaved and not isinstance(task, Drive)
                    else None,
                )
            )
        return tuple(outcomes)


def plan_behaviors(
    settings: Settings, prepared: Sequence[PreparedRobot], *, simulator: str | None
) -> BehaviorPlan:
    """Assign the behaviors to the robots that are spawned."""
    robots = {robot.entity: robot for robot in prepared if not robot.is_static_model}
    found: list[Diagnostic] = []
    entities: dict[str, str] = {}
    behavior_runs: list[BehaviorRun] = []
    for behavior in settings.behaviors:
        unclear = tuple(unclear_behavior_robot(behavior, list(robots), settings.file))
        found += unclear
        if unclear:
            continue
        entity = next(iter(robots)) if behavior.robot is None else behavior.robot
        entities[behavior.name] = entity
        behavior_run, problems = _behavior_run(behavior, robots[entity], settings.file, simulator)
        found += problems
        if behavior_run is not None:
            behavior_runs.append(behavior_run)
    return BehaviorPlan(
        file=settings.file,
        entities=entities,
        behaviors=settings.behaviors,
        behavior_runs=tuple(behavior_runs),
        diagnostics=tuple(found),
    )


def _behavior_run(
    behavior: Behavior, prepared: PreparedRobot, file: Path, simulator: str | None
) -> tuple[BehaviorRun | None, tuple[Diagnostic, ...]]:
    robot, task = prepared.lumped, behavior.task
    if isinstance(task, Drive):
        drive = find_diff_drive(robot, simulator=simulator)
        if isinstance(drive, NoDrive):
            return None, tuple(
                no_diff_drive(behavior, drive.reason, drive.hint, file, has_plugin=drive.is_there)
            )
        return BehaviorRun(entity=prepared.entity, behavior=behavior, drive=drive), ()
    problems = (
        *unknown_behavior_joint(behavior, task.positions, robot, file),
        *command_beyond_limit(behavior, task.positions, robot.joints, file),
    )
    return (None if problems else BehaviorRun(entity=prepared.entity, behavior=behavior)), problems

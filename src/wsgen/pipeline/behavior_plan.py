"""The behaviors that a package asks of its robots: which can be simulated, and their results."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.behaviors import (
    check_behavior,
    check_live,
    command_beyond_limit,
    launch_not_run,
    no_diff_drive,
    unclear_behavior_robot,
    unknown_behavior_joint,
)
from wsgen.checks.rules.consequences import explains_no_drive
from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.diagnostics import Severity
from wsgen.model.behavior import ELEMENT, BehaviorOutcome, BehaviorRun, Drive, LaunchTask
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior, LiveMeasurement, TimeSeries
    from wsgen.packages.workspace.settings import Settings
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.scene import RobotRun


@dataclass(frozen=True, kw_only=True)
class BehaviorPlan:
    """The behaviors of a package, and the robots that they are for."""

    file: Path  # that they are written in
    entities: dict[str, str]  # which robot shows what, by the name of the behavior
    behaviors: tuple[Behavior, ...]
    behavior_runs: tuple[BehaviorRun, ...]  # those that can be simulated
    diagnostics: tuple[Diagnostic, ...]  # why the rest cannot
    to_run: tuple[BehaviorRun, ...] = ()  # those for which the launch file runs
    # What was measured of these: by engine, then by name. One that is missing was left out.
    live: Mapping[str, Mapping[str, LiveMeasurement]] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Of simulated time, without what comes before each."""
        return sum(behavior_run.behavior.seconds for behavior_run in self.behavior_runs)

    def leave_out(
        self, reason: str, hint: str, severity: Severity = Severity.WARNING
    ) -> BehaviorPlan:
        """The plan that reports why those for which the launch file runs are left out."""
        found = (
            one
            for behavior_run in self.to_run
            for one in launch_not_run(behavior_run.behavior, reason, hint, self.file, severity)
        )
        return replace(self, diagnostics=(*self.diagnostics, *found))

    def without_to_run(self) -> BehaviorPlan:
        """The plan without those for which the launch file runs."""
        return replace(
            self,
            behaviors=tuple(one for one in self.behaviors if not isinstance(one.task, LaunchTask)),
            to_run=(),
        )

    def check(self, robot_run: RobotRun, engine: str) -> tuple[Diagnostic, ...]:
        """Check what a robot did."""
        return (*self._check_simulated(robot_run), *self._check_live(robot_run.entity, engine))

    def _check_live(self, entity: str, engine: str) -> Iterable[Diagnostic]:
        measured = self.live.get(engine, {})
        for behavior_run in self.to_run:
            behavior, task = behavior_run.behavior, behavior_run.behavior.task
            one = measured.get(behavior.name)
            if behavior_run.entity == entity and isinstance(task, LaunchTask) and one is not None:
                yield from check_live(behavior, task, one, self.file)

    def _check_simulated(self, robot_run: RobotRun) -> tuple[Diagnostic, ...]:
        behavior_runs = {
            behavior_run.behavior.name: behavior_run for behavior_run in self.behavior_runs
        }
        return tuple(
            found
            for behaved in robot_run.behaviors
            for found in check_behavior(behavior_runs[behaved.name], behaved, self.file)
        )

    def live_series(self, entity: str, engine: str) -> Iterator[TimeSeries]:
        """How a robot moved while its launch file ran, for each behavior for which it did."""
        measured = self.live.get(engine, {})
        for behavior_run in self.to_run:
            one = measured.get(behavior_run.behavior.name)
            if behavior_run.entity == entity and one is not None and one.time_series is not None:
                yield one.time_series

    def fails(self, entity: str) -> bool:
        """Whether a behavior of this robot cannot be simulated."""
        return any(
            self.entities.get(one.name) == entity and not self._can_run(one)
            for one in self.behaviors
        )

    def _can_run(self, behavior: Behavior) -> bool:
        return any(one.behavior == behavior for one in (*self.behavior_runs, *self.to_run))

    def outcomes(
        self,
        entity: str,
        robot_run: RobotRun | None,
        diagnostics: Iterable[Diagnostic],
        engine: str | None,
    ) -> tuple[BehaviorOutcome, ...]:
        """The results of the behaviors of a robot in an engine; None: it was not simulated.

        The diagnostics are those of the engine, or of all.
        """
        failed = {found.element for found in diagnostics}
        measured = {} if robot_run is None else {one.name: one for one in robot_run.behaviors}
        outcomes = []
        for behavior in self.behaviors:
            if self.entities.get(behavior.name) != entity:
                continue
            behaved = measured.get(behavior.name)
            task = behavior.task
            if isinstance(task, LaunchTask) and self._can_run(behavior):
                live = self.live.get(engine or "", {}).get(behavior.name)
                is_failed = ELEMENT.format(behavior.name) in failed
                outcomes.append(_outcome_of_run(behavior, task, live, is_failed=is_failed))
                continue
            is_drive = isinstance(task, Drive)
            outcomes.append(
                BehaviorOutcome(
                    name=behavior.name,
                    task=task,
                    passed=behaved is not None and ELEMENT.format(behavior.name) not in failed,
                    moved=behaved.moved if behaved and is_drive else None,
                    seconds=behavior.seconds if behaved else None,
                    positions={name: behaved.positions[name] for name in task.positions}
                    if behaved and not isinstance(task, Drive)
                    else None,
                )
            )
        return tuple(outcomes)


def plan_behaviors(
    settings: Settings,
    prepared: Sequence[PreparedRobot],
    *,
    simulator: str | None,
    assumed: Collection[str] = (),
) -> BehaviorPlan:
    """Assign the behaviors to the robots that are spawned.

    A node may spawn the `assumed` ones under other names, which behaviors with `run = true` give.
    """
    robots = {robot.entity: robot for robot in prepared if not robot.is_static_model}
    found: list[Diagnostic] = []
    entities: dict[str, str] = {}
    behavior_runs: list[BehaviorRun] = []
    to_run: list[BehaviorRun] = []
    for behavior in settings.behaviors:
        entity = behavior.robot
        if behavior.runs_launch_file and entity is not None and entity not in robots:
            entity = next((one for one in robots if one in assumed), entity)
        unclear = tuple(
            unclear_behavior_robot(replace(behavior, robot=entity), list(robots), settings.file)
        )
        found += unclear
        if unclear:
            continue
        entity = next(iter(robots)) if entity is None else entity
        entities[behavior.name] = entity
        behavior_run, problems = _behavior_run(behavior, robots[entity], settings.file, simulator)
        found += problems
        if behavior_run is not None:
            is_to_run = isinstance(behavior.task, LaunchTask)
            (to_run if is_to_run else behavior_runs).append(behavior_run)
    return BehaviorPlan(
        file=settings.file,
        entities=entities,
        behaviors=settings.behaviors,
        behavior_runs=tuple(behavior_runs),
        diagnostics=tuple(found),
        to_run=tuple(to_run),
    )


def _outcome_of_run(
    behavior: Behavior, task: LaunchTask, live: LiveMeasurement | None, *, is_failed: bool
) -> BehaviorOutcome:
    """The result of a behavior for which the launch file has run; None: it has not."""
    if live is None:
        return BehaviorOutcome(name=behavior.name, task=task, passed=False, is_left_out=True)
    outcome = BehaviorOutcome(
        name=behavior.name,
        task=task,
        passed=False,
        seconds=live.seconds,
        wall_seconds=live.wall_seconds,
        printed=live.printed,
    )
    if not (live.is_there and live.is_finite):
        return outcome
    return replace(
        outcome,
        passed=not is_failed,
        printed=live.printed if is_failed else (),
        moved=live.moved,
        traveled=live.traveled,
        positions={name: live.positions[name] for name in task.positions if name in live.positions}
        or None,
    )


def _behavior_run(
    behavior: Behavior, prepared: PreparedRobot, file: Path, simulator: str | None
) -> tuple[BehaviorRun | None, tuple[Diagnostic, ...]]:
    robot, task = prepared.lumped, behavior.task
    if isinstance(task, Drive):
        drive = find_diff_drive(robot, simulator=simulator)
        if isinstance(drive, NoDrive) and any(map(explains_no_drive, prepared.diagnostics)):
            return None, ()
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

"""What a package says its robots must do: which of it can be tried, and what came of that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.model.behavior import Attempt, BehaviourOutcome, Drive
from wsgen.rules.behaviors import (
    commanded_beyond_limit,
    joint_cannot_be_commanded,
    judge_behaviour,
    nothing_to_drive_with,
    robot_not_found,
)
from wsgen.urdf.diff_drive import NoDrive, find_diff_drive

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behaviour
    from wsgen.pipeline.prepare import Described
    from wsgen.simulation.scene import RobotTrial
    from wsgen.workspace.settings import Settings


@dataclass(frozen=True, kw_only=True)
class Programme:
    """The behaviours of a package, and the robots that are to show them."""

    file: Path  # that they are written in
    entities: dict[str, str]  # which robot shows what, by the name of the behaviour
    behaviours: tuple[Behaviour, ...]
    attempts: tuple[Attempt, ...]  # what can be tried of them
    diagnostics: tuple[Diagnostic, ...]  # why the rest cannot

    @property
    def seconds(self) -> float:
        """Of simulated time, without what comes before each."""
        return sum(attempt.behaviour.seconds for attempt in self.attempts)

    def judge(self, trial: RobotTrial) -> tuple[Diagnostic, ...]:
        """Judge what a robot did."""
        attempts = {attempt.behaviour.name: attempt for attempt in self.attempts}
        return tuple(
            found
            for behaved in trial.behaviours
            for found in judge_behaviour(attempts[behaved.name], behaved, self.file)
        )

    def fails(self, entity: str) -> bool:
        """Whether something that this robot should do cannot be tried."""
        tried = {attempt.behaviour.name for attempt in self.attempts}
        return any(
            name not in tried for name, shown_by in self.entities.items() if shown_by == entity
        )

    def outcomes(
        self, entity: str, trial: RobotTrial | None, diagnostics: Iterable[Diagnostic]
    ) -> tuple[BehaviourOutcome, ...]:
        """What came of the behaviours of a robot, with the findings of all engines."""
        failed = {found.element for found in diagnostics}
        measured = {} if trial is None else {one.name: one for one in trial.behaviours}
        outcomes = []
        for behaviour in self.behaviours:
            if self.entities.get(behaviour.name) != entity:
                continue
            behaved = measured.get(behaviour.name)
            task = behaviour.task
            is_drive = isinstance(task, Drive)
            outcomes.append(
                BehaviourOutcome(
                    name=behaviour.name,
                    task=task,
                    passed=behaved is not None and f"behaviour `{behaviour.name}`" not in failed,
                    moved=behaved.moved if behaved and is_drive else None,
                    positions={name: behaved.positions[name] for name in task.positions}
                    if behaved and not isinstance(task, Drive)
                    else None,
                )
            )
        return tuple(outcomes)


def make_programme(
    settings: Settings, described: Sequence[Described], *, generation: str | None
) -> Programme:
    """Give the behaviours to the robots that are spawned, as far as these can show them."""
    robots = {robot.entity: robot for robot in described if not robot.is_scenery}
    found: list[Diagnostic] = []
    entities: dict[str, str] = {}
    attempts: list[Attempt] = []
    for behaviour in settings.behaviours:
        wrong = tuple(robot_not_found(behaviour, list(robots), settings.file))
        found += wrong
        if wrong:
            continue
        entity = next(iter(robots)) if behaviour.robot is None else behaviour.robot
        entities[behaviour.name] = entity
        attempt, wrong = _attempt(behaviour, robots[entity], settings.file, generation)
        found += wrong
        if attempt is not None:
            attempts.append(attempt)
    return Programme(
        file=settings.file,
        entities=entities,
        behaviours=settings.behaviours,
        attempts=tuple(attempts),
        diagnostics=tuple(found),
    )


def _attempt(
    behaviour: Behaviour, described: Described, file: Path, generation: str | None
) -> tuple[Attempt | None, tuple[Diagnostic, ...]]:
    robot, task = described.lumped, behaviour.task
    if isinstance(task, Drive):
        drive = find_diff_drive(robot, generation=generation)
        if isinstance(drive, NoDrive):
            return None, tuple(
                nothing_to_drive_with(
                    behaviour, drive.reason, drive.hint, file, has_plugin=drive.is_there
                )
            )
        return Attempt(entity=described.entity, behaviour=behaviour, drive=drive), ()
    wrong = (
        *joint_cannot_be_commanded(behaviour, task.positions, robot, file),
        *commanded_beyond_limit(behaviour, task.positions, robot.joints, file),
    )
    return (None if wrong else Attempt(entity=described.entity, behaviour=behaviour)), wrong

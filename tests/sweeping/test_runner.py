"""Runs are submitted a few at a time, and each becomes a row."""

from __future__ import annotations

import json
import sys
from concurrent.futures import Future
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from simulation.robots import CYLINDER, PLATE, body, cube_mesh, joint, shape, single, tree
from sweeping.blueprints import blueprint, prepared, variant
from wsgen.isolation.codec import encode
from wsgen.isolation.result import Died
from wsgen.model.robot import JointType
from wsgen.model.sweep import Row
from wsgen.model.transform import Pose
from wsgen.simulation.run import missing_engines
from wsgen.sweeping.children import ChildDiedError, LocalExecutor
from wsgen.sweeping.runner import run_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from wsgen.model.sweep import Variant
    from wsgen.sweeping.children import Shared
    from wsgen.sweeping.run_variant import Blueprint


class Scripted:
    """An executor that answers as soon as its window is full."""

    def __init__(self, answer: Callable[[Variant], Any], window: int = 3) -> None:
        self.window = window
        self.submitted: list[tuple[Shared, Variant]] = []
        self.most = self.running = 0
        self._waiting: list[tuple[Future[Any], Variant]] = []
        self._answer = answer

    def submit(self, *args: Any, **_: Any) -> Future[Any]:
        shared, (wanted, *_) = args[1:3]
        self.submitted.append((shared, wanted))
        self.running += 1
        self.most = max(self.most, self.running)
        future: Future[Any] = Future()
        future.add_done_callback(lambda _: setattr(self, "running", self.running - 1))
        self._waiting.append((future, wanted))
        if len(self.submitted) >= self.window:
            while self._waiting:  # the first one ends last
                self._end(*self._waiting.pop())
        return future

    def _end(self, future: Future[Any], wanted: Variant) -> None:
        answer = self._answer(wanted)
        if isinstance(answer, Exception):
            future.set_exception(answer)
        else:
            future.set_result([answer])


def passed(wanted: Variant) -> dict[str, Any]:
    row = Row(number=wanted.number, passed=True, figures={"tilt": 1.0})
    found: dict[str, Any] = json.loads(encode(row))
    return found


def rows(executor: Scripted, made: Blueprint, count: int = 10) -> Iterator[Row]:
    variants = (variant(number) for number in range(count))
    return run_all(executor, lambda _: made, variants, seconds=1.0, engine="bullet")


def test_few_runs_are_submitted_at_a_time_and_the_blueprint_once() -> None:
    executor = Scripted(passed)
    found = sorted(rows(executor, blueprint()), key=lambda row: row.number)
    assert found == [Row(number=n, passed=True, figures={"tilt": 1.0}) for n in range(10)]
    assert executor.most <= 3
    assert len({id(shared) for shared, _ in executor.submitted}) == 1


def test_what_cannot_run_is_a_row_at_once() -> None:
    executor = Scripted(passed)
    found = list(rows(executor, blueprint(world=None), 4))
    assert [(row.number, row.passed) for row in found] == [(n, False) for n in range(4)]
    assert not executor.submitted


def test_what_ends_its_processes_is_a_row_that_says_so() -> None:
    death = Died(reason="crashed (SIGSEGV)", step="simulating 1 s", output="")
    executor = Scripted(lambda wanted: ChildDiedError(death) if wanted.number else passed(wanted))
    found = {row.number: row for row in rows(executor, blueprint(), 5)}
    assert found[0].passed
    assert {row.diagnostic for number, row in found.items() if number} == {
        "SPN031 engine-died: The physics engine (PyBullet) crashed (SIGSEGV) while simulating 1 s."
    }


def test_other_errors_are_raised() -> None:
    with pytest.raises(RuntimeError, match="The cluster is gone"):
        list(rows(Scripted(lambda _: RuntimeError("The cluster is gone.")), blueprint()))


def machine(folder: Path) -> Blueprint:
    """Something of all that an engine may keep in mind: joints, a mesh, two robots that touch."""
    mesh = cube_mesh(folder)
    arm = joint("base", "arm", JointType.REVOLUTE, Pose((0.3, 0.0, 0.2)), axis_in_joint=(0, 1, 0))
    wheel = joint("base", "wheel", JointType.CONTINUOUS, Pose((0.0, 0.4, 0.2)), damping=50.0)
    robot = tree(
        body(PLATE),
        (arm, body(CYLINDER, name="arm", mu=0.3)),
        (wheel, body(CYLINDER, name="wheel")),
    )
    small = replace(mesh, scale=(0.1, 0.1, 0.1))
    block = replace(body(PLATE, mass=0.5), collisions=(shape(small),))
    return blueprint(
        prepared(robot, "machine", Pose((0.0, 0.0, 0.4))),
        prepared(single(block), "block", Pose((0.0, 0.0, 1.5), (0.3, 0.2, 0.1))),
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="compares children of one machine")
@pytest.mark.parametrize("engine", ["bullet", "dart", "mujoco"])
def test_a_run_is_the_same_whatever_its_child_has_run_before(engine: str, tmp_path: Path) -> None:
    if missing_engines([engine]):
        pytest.skip(f"{engine} is not installed")
    made = machine(tmp_path)
    variants = [
        variant(number, world__slope=0.1 * (number % 5), push__force=3.0 * (number % 5))
        for number in range(25)
    ]

    def texts(jobs: int, some: list[Variant]) -> dict[int, str]:
        with LocalExecutor(jobs) as executor:
            found = run_all(executor, lambda _: made, some, seconds=0.5, engine=engine)
            return {row.number: encode(replace(row, number=0)) for row in found}

    one = texts(1, variants)
    assert {number: one[number % 5] for number in range(25)} == one
    assert len(set(one.values())) == 5
    assert texts(2, variants[::-1]) == one
    assert texts(1, [variants[23]]) == {23: one[23]}

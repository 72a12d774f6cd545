"""Samples of how robots move: how many, of what, and that they cost nothing unless wanted."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.fake_engine import FakeEngine
from simulation.movers import AT, arm, drive, reach, two_wheeled
from simulation.robots import GROUND
from wsgen.isolation.codec import decode, encode
from wsgen.model.transform import Pose, quaternion_of_rpy
from wsgen.pipeline.tasks.simulation import simulate
from wsgen.simulation.engine import State
from wsgen.simulation.run import run_simulation
from wsgen.simulation.scene import RobotRun, Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.model.world import World


def rising(seconds: float) -> State:
    """A meter a second upwards, and a radian a second about x."""
    return State((0, 0, 1 + seconds), quaternion_of_rpy((0.5 + seconds, 0, 0)), 1.0, 1.0, 0.0)


def scene_of(**changes: object) -> Scene:
    robot = SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=AT)
    scene = Scene(world=GROUND, robots=(robot,), seconds=1.0, samples=20)
    return replace(scene, **changes)  # type: ignore[arg-type]


def fake(motion: Callable[[float], State]) -> Callable[[World], FakeEngine]:
    return lambda _world: FakeEngine(motion, positions=lambda seconds: {"left": -seconds})


def test_none_are_taken_unless_wanted() -> None:
    (robot_run,) = simulate(scene_of(samples=0), fake(rising)).robot_runs
    assert robot_run.time_series == ()


def test_what_is_sampled() -> None:
    (robot_run,) = simulate(scene_of(), fake(rising)).robot_runs
    (series,) = robot_run.time_series
    assert series.behavior is None
    assert series.seconds == pytest.approx([step / 20 for step in range(21)])
    heights = [z for _, _, z in series.positions]
    assert heights == pytest.approx([1 + seconds for seconds in series.seconds])
    assert series.speeds == pytest.approx([1.0] * 21)
    assert series.tilts == pytest.approx(series.seconds, abs=1e-5)  # from how it was spawned
    assert series.joint_positions["left"] == pytest.approx([-one for one in series.seconds])
    assert decode(json.loads(encode(robot_run)), RobotRun) == robot_run


def test_a_short_simulation_has_no_more_samples_than_looks() -> None:
    (robot_run,) = simulate(scene_of(seconds=0.1, samples=200), fake(rising)).robot_runs
    assert len(robot_run.time_series[0].seconds) == 11


def test_samples_end_where_numbers_do() -> None:
    def exploding(seconds: float) -> State:
        return replace(rising(seconds), speed=math.inf if seconds > 0.5 else 0.0)

    (robot_run,) = simulate(scene_of(), fake(exploding)).robot_runs
    (series,) = robot_run.time_series
    assert series.seconds[-1] == 0.5
    assert not robot_run.is_finite


@pytest.mark.slow
def test_each_behavior_has_its_own_samples() -> None:
    away = Pose((0.0, 5.0, 0.0))
    other = SpawnedRobot(entity="other", robot=arm(), pose_in_world=away)
    ahead, up, turn = wanted = (
        drive(2.0, linear=0.2),
        replace(reach(0.5, j1=0.1), entity="other"),
        drive(1.0, angular=0.5),
    )
    scene = scene_of(robots=(*scene_of().robots, other), behavior_runs=wanted)
    first, second = run_simulation(replace(scene, engine="bullet")).robot_runs
    names = [one.behavior.name for one in (ahead, up, turn)]
    assert [one.behavior for one in first.time_series] == [None, names[0], names[2]]
    assert [one.behavior for one in second.time_series] == [None, names[1]]
    standing, driving, turning = first.time_series
    assert [len(one.seconds) for one in first.time_series] == [21, 21, 21]
    assert [one.seconds[-1] for one in first.time_series] == pytest.approx([1.0, 2.0, 1.0])
    assert driving.seconds[0] == turning.seconds[0] == 0.0
    (x, y, _), (end_x, end_y, _) = driving.positions[0], driving.positions[-1]
    assert math.hypot(end_x - x, end_y - y) == pytest.approx(first.behaviors[0].moved[0], abs=1e-3)
    assert max(driving.speeds) > 0.15 > max(standing.speeds[-5:])
    assert second.time_series[1].joint_positions.keys() == {"j1", "j2"}


def test_models_of_the_world_are_left_out() -> None:
    (robot,) = scene_of().robots
    table = replace(robot, entity="table", is_static_model=True)
    found = simulate(scene_of(robots=(robot, table)), fake(rising)).robot_runs
    assert [len(one.time_series) for one in found] == [1, 0]

"""All rules together: which findings a trial ends with."""

import math
from dataclasses import replace

import pytest

from wsgen.checks.judge import judge_trial
from wsgen.model.pose import Pose
from wsgen.model.robot import Inertial, Link, Robot
from wsgen.model.world import World
from wsgen.simulation.scene import RobotTrial

WORLD = World(name="w", has_ground_plane=True)
BODY = Inertial(mass=1.0, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
ROBOT = Robot(name="r", root="base", links=(Link(name="base", inertial=BODY),))
SPAWNED = Pose((0.0, 0.0, 0.3))
STANDS = RobotTrial(
    entity="r",
    links=1,
    movable_joints=0,
    mass=1.0,
    lowest_point=0.05,
    penetration=0.0,
    lowest_point_at_end=0.0,
    is_finite=True,
    settled_after=0.5,
    rest_pose=Pose((0.0, 0.0, 0.25)),
    speed=0.0,
    turning=0.0,
    joint_speed=0.0,
    highest_speed=1.0,
    highest_point=0.3,
    tilt=0.0,
)


def codes(trial: RobotTrial, *, robot: Robot = ROBOT, world: World = WORLD) -> list[str]:
    return [found.code for found in judge_trial(robot, SPAWNED, world, trial)]


def test_a_robot_that_stands() -> None:
    assert codes(STANDS) == []


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        ({"mass": 2.0}, ["SPN050"]),
        ({"movable_joints": 1}, ["SPN051"]),
        ({"is_finite": False, "tilt": 3.0}, ["SPN052"]),
        ({"penetration": 0.25, "lowest_point": -0.25}, ["SPN053"]),
        ({"lowest_point": 2.0}, ["SPN054"]),
        ({"lowest_point_at_end": -0.1}, ["SPN055"]),
        ({"lowest_point_at_end": -0.1, "settled_after": None}, ["SPN055"]),
        ({"lowest_point_at_end": -44.0, "settled_after": None, "tilt": 1.0}, ["SPN056"]),
        ({"highest_point": 20.0}, ["SPN057"]),
        ({"settled_after": None, "speed": 1.0}, ["SPN058"]),
        ({"tilt": math.pi / 2}, ["SPN059"]),
    ],
)
def test_each_fault_is_found_and_nothing_else(
    measured: dict[str, float], expected: list[str]
) -> None:
    assert codes(replace(STANDS, **measured)) == expected  # type: ignore[arg-type]


def test_without_a_ground_there_is_nothing_to_be_born_in() -> None:
    trial = replace(STANDS, lowest_point=5.0)
    assert codes(trial, world=replace(WORLD, has_ground_plane=False)) == []


def test_a_robot_that_is_fixed_to_the_world_stands_by_that() -> None:
    fixed = replace(ROBOT, fixed_to_world=True)
    trial = replace(STANDS, lowest_point=2.0, lowest_point_at_end=-0.01, tilt=1.0)
    assert codes(trial, robot=fixed) == []
    swings = replace(trial, settled_after=None, speed=0.0)
    assert codes(swings, robot=fixed) == ["SPN058"]

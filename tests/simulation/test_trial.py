"""The logic of a trial, over an engine that plays a script."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.model.pose import Pose
from wsgen.model.robot import Inertial, Link, Robot
from wsgen.model.transform import quaternion_of_rpy
from wsgen.model.world import World
from wsgen.simulation.engine import State
from wsgen.simulation.fake import FakeEngine
from wsgen.simulation.scene import (
    RobotTrial,
    Scene,
    SpawnedRobot,
    trial_from_json,
    trial_to_json,
)
from wsgen.simulation.trial import play

if TYPE_CHECKING:
    from collections.abc import Callable

BALL = Robot(
    name="ball",
    root="ball",
    links=(Link(name="ball", inertial=Inertial(mass=2.0, inertia=(1, 0, 0, 1, 0, 1))),),
)


SPAWN = Pose((0.0, 0.0, 1.0))


def still(z: float, *, speed: float = 0.0, rpy: tuple[float, float, float] = (0, 0, 0)) -> State:
    return State((0.0, 0.0, z), quaternion_of_rpy(rpy), speed, 0.0, 0.0)


def trial_of(
    motion: Callable[[float], State], *, ground: bool = True, spawn: Pose = SPAWN
) -> RobotTrial:
    world = World(name="w", has_ground_plane=ground)
    scene = Scene(world=world, robots=(SpawnedRobot(entity="e", robot=BALL, pose_in_world=spawn),))
    (trial,), refused = play(FakeEngine(motion, reach=0.5), scene, lambda _: None)
    assert refused == {}
    return trial


def test_what_the_engine_says() -> None:
    trial = trial_of(lambda _: still(1.0))
    assert (trial.links, trial.movable_joints, trial.mass) == (1, 0, 2.0)
    assert (trial.lowest_point, trial.penetration) == (0.5, 0.0)
    assert trial.settled_after == 0.0


def test_settling() -> None:
    trial = trial_of(lambda seconds: still(1.0, speed=1.0 if seconds < 0.7005 else 0.001))
    assert trial.settled_after == pytest.approx(0.7)
    assert trial.highest_speed == 1.0
    assert trial.speed == 0.001


def test_slow_at_the_last_moment_is_not_at_rest() -> None:
    trial = trial_of(lambda seconds: still(1.0, speed=1.0 if seconds < 2.95 else 0.0))
    assert trial.settled_after is None


@pytest.mark.parametrize(
    "state",
    [
        State((0, 0, 1), (0, 0, 0, 1), 0.0, 1.0, 0.0),
        State((0, 0, 1), (0, 0, 0, 1), 0.0, 0.0, 1.0),
    ],
)
def test_turning_and_swinging_are_motion(state: State) -> None:
    assert trial_of(lambda _: state).settled_after is None


def test_penetration_is_that_at_the_start() -> None:
    trial = trial_of(lambda seconds: still(0.2 if seconds == 0 else 0.5))
    assert trial.penetration == pytest.approx(0.3)
    assert trial.lowest_point_at_end == 0.0


def test_no_penetration_without_ground() -> None:
    assert trial_of(lambda _: still(-5.0), ground=False).penetration == 0.0


def test_highest_point() -> None:
    trial = trial_of(lambda seconds: still(1.0 + math.sin(seconds)))
    assert trial.highest_point == pytest.approx(2.0, abs=1e-4)


def test_tilt_is_seen_from_the_spawn_pose() -> None:
    lying = (math.pi / 2, 0.0, 0.7)
    assert trial_of(lambda _: still(1.0, rpy=lying)).tilt == pytest.approx(math.pi / 2)
    spawned = Pose((0.0, 0.0, 1.0), lying)
    assert trial_of(lambda _: still(1.0, rpy=lying), spawn=spawned).tilt == pytest.approx(
        0, abs=1e-7
    )


def test_not_a_number() -> None:
    trial = trial_of(lambda seconds: still(math.nan if seconds > 1 else 2.0))
    assert not trial.is_finite
    assert trial.settled_after is None
    assert trial.rest_pose.xyz[2] == 2.0  # the last that was finite


def test_seconds_and_step() -> None:
    engine = FakeEngine(lambda _: still(1.0), step_seconds=0.004)
    scene = Scene(
        world=World(name="w", step=0.004),
        robots=(SpawnedRobot(entity="e", robot=BALL),),
        seconds=1.0,
    )
    play(engine, scene, lambda _: None)
    assert engine.steps == 250


def test_refused_robots_do_not_stop_the_others() -> None:
    said: list[str] = []
    robots = tuple(SpawnedRobot(entity=name, robot=BALL) for name in ("good", "bad"))
    engine = FakeEngine(lambda _: still(1.0), refuses=frozenset({"bad"}))
    trials, refused = play(engine, Scene(world=World(name="w"), robots=robots), said.append)
    assert [trial.entity for trial in trials] == ["good"]
    assert set(refused) == {"bad"}
    assert said == ["loading the robot `good`", "loading the robot `bad`", "simulating 3 s"]


def test_a_trial_travels_as_json() -> None:
    trial = trial_of(lambda _: still(1.0))
    assert trial_from_json(trial_to_json(trial)) == trial

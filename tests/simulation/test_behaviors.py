"""What is done with a behavior, whatever the engine: placed, settled, driven, measured."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.fake_engine import FakeEngine
from simulation.movers import AT, DRIVE, arm, drive, reach, two_wheeled
from simulation.robots import GROUND, joint, tree
from wsgen.isolation.codec import decode, encode
from wsgen.model.behavior import Bounds
from wsgen.model.robot import JointLimit, JointType, Link, Robot
from wsgen.model.transform import quaternion_of_rpy
from wsgen.simulation.controllers import (
    DiffDriveController,
    PositionController,
    controller_for,
)
from wsgen.simulation.engine import Motor, State
from wsgen.simulation.scene import BehaviorMeasurement, RobotRun, Scene, SpawnedRobot
from wsgen.simulation.simulate import run_behaviors, run_scene

if TYPE_CHECKING:
    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.transform import Pose


def at(x: float, y: float, yaw: float, speed: float = 0.0) -> State:
    return State((x, y, 0.1), quaternion_of_rpy((0.0, 0.0, yaw)), speed, 0.0, 0.0)


class Engine(FakeEngine):
    """Remembers its calls, in order."""

    def __init__(self, *arguments: object, **more: object) -> None:
        super().__init__(*arguments, **more)  # type: ignore[arg-type]
        self.calls: list[object] = []

    def place(self, entity: str, pose_in_world: Pose) -> None:
        self.calls.append(("place", entity, pose_in_world))

    def drive(self, entity: str, motors: object) -> None:
        super().drive(entity, motors)  # type: ignore[arg-type]
        self.calls.append(motors)

    def release(self, entity: str) -> None:
        super().release(entity)
        self.calls.append("release")


def simulated(
    engine: FakeEngine,
    *behavior_runs: BehaviorRun,
    robot: Robot | None = None,
    seconds: float = 1.0,
) -> RobotRun:
    spawned = SpawnedRobot(entity="e", robot=robot or two_wheeled(), pose_in_world=AT)
    scene = Scene(world=GROUND, robots=(spawned,), seconds=seconds, behavior_runs=behavior_runs)
    robot_runs, _ = run_scene(engine, scene, lambda _: None)
    (robot_run,) = run_behaviors(engine, scene, robot_runs, lambda _: None)
    return robot_run


def test_a_way_is_seen_from_where_it_began() -> None:
    """Along a circle of 2 m to the left, from a pose that looks along y; once around and more."""

    def motion(seconds: float) -> State:
        angle = max(0.0, seconds - 1.1)  # stands for a second, and settles within 0.1 s
        return at(5 - 2 + 2 * math.cos(angle), 7 + 2 * math.sin(angle), math.pi / 2 + angle)

    robot_run = simulated(FakeEngine(motion), drive(seconds=8.0, linear=2.0, angular=1.0))
    (behaved,) = robot_run.behaviors
    assert behaved.moved == pytest.approx((2 * math.sin(8.0), 2 - 2 * math.cos(8.0), 8.0), abs=1e-6)
    assert behaved.is_finite


def test_each_begins_where_the_robot_was_spawned_and_at_rest() -> None:
    engine = Engine(lambda _: at(0.0, 0.0, 0.0))
    robot_run = simulated(engine, drive(seconds=0.02, linear=0.5), drive(seconds=0.01, angular=1.0))
    rest = {"left": Motor(0.0, math.inf), "right": Motor(0.0, math.inf)}
    ahead = {"left": Motor(5.0, math.inf), "right": Motor(5.0, math.inf)}
    turn = {"left": Motor(-2.0, math.inf), "right": Motor(2.0, math.inf)}
    placed = ("place", "e", AT)
    first = [placed, *[rest] * 10, ahead, ahead, "release"]
    assert engine.calls == [*first, placed, *[rest] * 10, turn, "release"]
    assert [behaved.name for behaved in robot_run.behaviors] == [
        "d{'linear': 0.5}",
        "d{'angular': 1.0}",
    ]
    assert engine.motors == {}


def test_what_does_not_come_to_rest_begins_after_the_usual_seconds() -> None:
    engine = Engine(lambda _: at(0.0, 0.0, 0.0, speed=1.0))
    simulated(engine, drive(seconds=0.01, linear=0.5), seconds=0.5)
    assert len(engine.calls) == 1 + 50 + 1 + 1


def test_what_explodes_is_reported_and_ends_there() -> None:
    engine = Engine(lambda seconds: at(seconds if seconds < 1.5 else math.nan, 0.0, 0.0))
    robot_run = simulated(engine, drive(seconds=2.0, linear=1.0), drive(linear=0.1))
    first, second = robot_run.behaviors
    assert not first.is_finite
    assert not second.is_finite
    assert all(map(math.isfinite, first.moved))
    positions = Engine(lambda _: at(0.0, 0.0, 0.0), positions=lambda _: {"left": math.inf})
    assert not simulated(positions, drive(seconds=0.1)).behaviors[0].is_finite


def test_time_goes_on_for_who_watches() -> None:
    engine = FakeEngine(lambda _: at(0.0, 0.0, 0.0))
    spawned = SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=AT)
    behavior_runs = (drive(seconds=0.1, linear=0.5), drive(seconds=0.1, linear=0.6))
    scene = Scene(world=GROUND, robots=(spawned,), seconds=1.0, behavior_runs=behavior_runs)
    seen: list[float] = []
    steps: list[str] = []
    begun: list[tuple[str, float]] = []
    robot_runs, _ = run_scene(engine, scene, lambda _: None)
    run_behaviors(
        engine,
        scene,
        robot_runs,
        steps.append,
        observe=lambda seconds, _: seen.append(seconds),
        begun=lambda name, seconds: begun.append((name, round(seconds, 6))),
    )
    # Each comes to rest for 0.1 s, and is seen from then on.
    moments = [*range(110, 121), *range(130, 141)]
    assert seen == pytest.approx([moment / 100 for moment in moments])
    assert begun == [("d{'linear': 0.5}", 1.1), ("d{'linear': 0.6}", 1.3)]
    assert steps[0] == "running the behavior `d{'linear': 0.5}` of `e`"


def test_a_robot_that_is_not_there_does_nothing() -> None:
    engine = FakeEngine(lambda _: at(0.0, 0.0, 0.0))
    assert simulated(engine, replace(drive(), entity="other")).behaviors == ()


def test_measurements_survive_the_way_between_processes() -> None:
    robot_run = simulated(FakeEngine(lambda _: at(0.0, 0.0, 0.0)), drive(seconds=0.1))
    assert robot_run.behaviors == (BehaviorMeasurement("d{}", (0.0, 0.0, 0.0), {}),)
    assert decode(json.loads(encode(robot_run)), RobotRun) == robot_run


def test_who_commands_what() -> None:
    assert isinstance(controller_for(drive(), two_wheeled()), DiffDriveController)
    assert isinstance(controller_for(reach(j1=0.0), arm()), PositionController)


def test_wheels_are_as_strong_as_plugin_or_joint() -> None:
    robot = two_wheeled(JointLimit(effort=3.0, velocity=4.0))
    for using, expected in (
        (DRIVE, Motor(4.0, 3.0)),
        (replace(DRIVE, torque=9.0), Motor(5.0, 9.0)),
    ):
        wheels = controller_for(drive(using=using, linear=0.5), robot)
        assert wheels.motors({}) == {"left": Motor(0.0, expected.effort)} | {
            "right": Motor(0.0, expected.effort)
        }
        wheels.has_begun = True
        assert wheels.motors({}) == {"left": expected, "right": expected}


def test_the_torque_of_a_plugin_of_classic_is_there_instead_of_the_friction() -> None:
    robot = two_wheeled()
    stiff = replace(robot, joints=tuple(replace(one, friction=2.0) for one in robot.joints))
    wheels = controller_for(drive(using=replace(DRIVE, torque=9.0)), stiff)
    assert wheels.motors({})["left"].effort == 11.0  # engines take the friction from it


def test_jerk_has_its_bound() -> None:
    using = replace(DRIVE, linear=Bounds(jerk=100.0))
    wheels = controller_for(drive(using=using, linear=0.5), two_wheeled())
    wheels.has_begun = True
    rims = [wheels.motors({})["left"].speed * DRIVE.pairs[0].radius for _ in range(3)]
    # m/s, after 10 ms each, in which the acceleration grows by 1 m/s².
    assert rims == pytest.approx([0.01, 0.03, 0.06])


def test_servos_hold_what_is_not_named() -> None:
    """A joint that cannot be at 0 is held as near as it can; wheels are left alone."""
    limit = JointLimit(lower=0.2, upper=1.0, effort=2.0, velocity=1.0)
    robot = arm()
    knee = replace(robot.joints[1], limit=limit)
    wheel = joint("j2", "wheel", JointType.CONTINUOUS)
    robot = replace(robot, joints=(robot.joints[0], knee, wheel))
    servos = controller_for(reach(j1=0.01), robot)
    positions = {"j1": 0.0, "j2": 0.0, "wheel": 0.0}
    assert servos.motors(positions) == {"j1": Motor(0.0, 20.0), "j2": Motor(1.0, 2.0)}
    servos.has_begun = True
    moving = servos.motors({**positions, "j2": 0.19})
    assert list(moving["j1"]) == pytest.approx([0.1, 20.0])
    assert list(moving["j2"]) == pytest.approx([0.1, 2.0])
    named = controller_for(reach(wheel=0.5), robot)
    assert named.motors(positions)["wheel"] == Motor(0.0, math.inf)


def test_a_follower_of_what_is_not_commanded_stays_passive() -> None:
    base = Link(name="base")
    wheel = joint("base", "wheel", JointType.CONTINUOUS)
    mimic = arm(mimics=True).joints[1].mimic
    assert mimic is not None
    finger = replace(
        joint("base", "finger", JointType.REVOLUTE), mimic=replace(mimic, joint="wheel")
    )
    robot = tree(base, (wheel, Link(name="wheel")), (finger, Link(name="finger")))
    assert controller_for(reach(), robot).motors({"wheel": 1.0, "finger": 0.0}) == {}

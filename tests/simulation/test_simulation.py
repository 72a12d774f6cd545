"""The logic of a simulation, over an engine that plays a script."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.fake_engine import FakeEngine
from wsgen.isolation.codec import decode, encode
from wsgen.model.robot import Inertial, Link, Robot
from wsgen.model.transform import Pose, quaternion_of_rpy
from wsgen.model.world import World
from wsgen.simulation.engine import Overlap, State
from wsgen.simulation.scene import Overlapping, RobotRun, Scene, SpawnedRobot
from wsgen.simulation.simulate import CLEARANCE, run_scene

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


def run_of(
    motion: Callable[[float], State],
    *,
    ground: bool = True,
    spawn: Pose = SPAWN,
    robot: Robot = BALL,
    on_the_ground: bool = False,
    **script: object,
) -> RobotRun:
    world = World(name="w", has_ground_plane=ground)
    spawned = SpawnedRobot(
        entity="e", robot=robot, pose_in_world=spawn, on_the_ground=on_the_ground
    )
    engine = FakeEngine(motion, **{"reach": 0.5, **script})  # type: ignore[arg-type]
    (robot_run,), refused = run_scene(engine, Scene(world=world, robots=(spawned,)), lambda _: None)
    assert refused == {}
    return robot_run


def test_what_the_engine_says() -> None:
    robot_run = run_of(lambda _: still(1.0))
    assert (robot_run.links, robot_run.movable_joints, robot_run.mass) == (1, 0, 2.0)
    assert (robot_run.lowest_point, robot_run.penetration) == (0.5, 0.0)
    assert robot_run.settled_after == 0.0


def test_settling() -> None:
    robot_run = run_of(lambda seconds: still(1.0, speed=1.0 if seconds < 0.7005 else 0.001))
    assert robot_run.settled_after == pytest.approx(0.7)
    assert robot_run.highest_speed == 1.0
    assert robot_run.speed == 0.001


def test_slow_at_the_last_moment_is_not_at_rest() -> None:
    robot_run = run_of(lambda seconds: still(1.0, speed=1.0 if seconds < 2.95 else 0.0))
    assert robot_run.settled_after is None


@pytest.mark.parametrize(
    "state",
    [
        State((0, 0, 1), (0, 0, 0, 1), 0.0, 1.0, 0.0),
        State((0, 0, 1), (0, 0, 0, 1), 0.0, 0.0, 1.0),
    ],
)
def test_turning_and_swinging_are_motion(state: State) -> None:
    assert run_of(lambda _: state).settled_after is None


def test_penetration_is_that_at_the_start() -> None:
    robot_run = run_of(lambda seconds: still(0.2 if seconds == 0 else 0.5))
    assert robot_run.penetration == pytest.approx(0.3)
    assert robot_run.lowest_point_at_end == 0.0


def test_no_penetration_without_ground() -> None:
    assert run_of(lambda _: still(-5.0), ground=False).penetration == 0.0


def test_highest_point() -> None:
    robot_run = run_of(lambda seconds: still(1.0 + math.sin(seconds)))
    assert robot_run.highest_point == pytest.approx(2.0, abs=1e-4)


def test_tilt_is_seen_from_the_spawn_pose() -> None:
    lying = (math.pi / 2, 0.0, 0.7)
    assert run_of(lambda _: still(1.0, rpy=lying)).tilt == pytest.approx(math.pi / 2)
    spawned = Pose((0.0, 0.0, 1.0), lying)
    assert run_of(lambda _: still(1.0, rpy=lying), spawn=spawned).tilt == pytest.approx(0, abs=1e-7)


def test_not_a_number() -> None:
    robot_run = run_of(lambda seconds: still(math.nan if seconds > 1 else 2.0))
    assert not robot_run.is_finite
    assert robot_run.settled_after is None
    assert robot_run.rest_pose.xyz[2] == 2.0  # the last that was finite


def test_a_joint_that_is_not_a_number() -> None:
    robot_run = run_of(lambda _: still(1.0), positions=lambda t: {"j": math.nan if t > 1 else 0.1})
    assert not robot_run.is_finite
    assert robot_run.joint_positions == {"j": 0.1}


def test_an_energy_that_is_not_a_number() -> None:
    robot_run = run_of(lambda _: still(1.0), energy=lambda t: math.inf if t > 1 else 3.0)
    assert not robot_run.is_finite
    assert robot_run.energy_gain == 0.0


def test_what_is_not_finite_any_more_ends_the_simulation() -> None:
    engine = FakeEngine(lambda seconds: still(math.inf if seconds > 0.5 else 1.0))
    robots = (SpawnedRobot(entity="e", robot=BALL),)
    run_scene(engine, Scene(world=World(name="w"), robots=robots), lambda _: None)
    assert engine.steps * engine.step_seconds == pytest.approx(0.51)


def test_one_state_that_is_not_finite_ends_the_run_of_all() -> None:
    engine = FakeEngine(lambda _: still(1.0))
    state = engine.state
    engine.state = lambda entity: (  # type: ignore[method-assign]
        still(math.nan) if entity == "b" and engine.steps > 500 else state(entity)
    )
    robots = tuple(SpawnedRobot(entity=entity, robot=BALL) for entity in "ab")
    robot_runs, _ = run_scene(engine, Scene(world=World(name="w"), robots=robots), lambda _: None)
    assert engine.steps * engine.step_seconds == pytest.approx(0.51)
    assert [(robot_run.is_finite, robot_run.is_cut_short) for robot_run in robot_runs] == [
        (True, True),
        (False, False),
    ]


def test_how_fast_it_rises_at_the_end() -> None:
    assert run_of(lambda seconds: still(-1.0 + 0.25 * seconds)).climb == pytest.approx(0.25)
    assert run_of(lambda _: still(1.0)).climb == 0.0


def test_the_most_energy_that_was_gained() -> None:
    robot_run = run_of(
        lambda _: still(1.0), energy=lambda t: 5.0 + (2.0 if 1 < t < 2 else -1.0 * t)
    )
    assert robot_run.energy_gain == 2.0
    losing = run_of(lambda _: still(1.0), energy=lambda t: 5.0 - t)
    assert losing.energy_gain == 0.0


def test_how_far_joints_travel_and_where_they_end() -> None:
    robot_run = run_of(
        lambda _: still(1.0),
        positions=lambda t: {"swings": 0.5 - 0.5 * math.cos(math.pi * t), "stays": 0.25},
    )
    assert robot_run.joint_positions == {"swings": pytest.approx(1.0), "stays": 0.25}
    assert robot_run.joint_travel == {"swings": pytest.approx(1.0), "stays": 0.0}
    back = run_of(lambda _: still(1.0), positions=lambda t: {"j": 0.1 + math.sin(math.pi * t)})
    assert back.joint_travel == {"j": pytest.approx(1.0, abs=0.01)}


def test_what_is_to_stand_on_the_ground_is_put_just_above_it() -> None:
    """It moves as from there: what it rose and sank is seen from where it was put."""
    robot_run = run_of(lambda t: still(7.0 - (0.005 if t else 0.0)), on_the_ground=True)
    assert robot_run.spawn_pose.xyz == pytest.approx((0.0, 0.0, 0.5 + CLEARANCE))
    assert robot_run.lowest_point == pytest.approx(CLEARANCE)
    assert robot_run.penetration == 0.0
    assert robot_run.rest_pose.xyz[2] == pytest.approx(0.5)
    assert robot_run.lowest_point_at_end == pytest.approx(0.0, abs=1e-9)
    assert robot_run.highest_point == pytest.approx(0.5 + CLEARANCE)


def test_the_place_and_heading_are_kept_when_it_is_put_on_the_ground() -> None:
    spawn = Pose((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    placed = run_of(lambda _: still(3.0), spawn=spawn, on_the_ground=True).spawn_pose
    assert (placed.xyz[:2], placed.rpy) == ((1.0, 2.0), spawn.rpy)


@pytest.mark.parametrize(
    ("robot", "ground"),
    [
        (BALL, False),
        (replace(BALL, is_static=True), True),
        (replace(BALL, fixed_to_world=True), True),
    ],
)
def test_what_cannot_stand_on_the_ground_stays_where_it_is(robot: Robot, *, ground: bool) -> None:
    robot_run = run_of(lambda _: still(1.0), robot=robot, ground=ground, on_the_ground=True)
    assert robot_run.spawn_pose == SPAWN
    assert robot_run.lowest_point == 0.5


def test_what_is_spawned_in_the_ground_stays_there_unless_told() -> None:
    assert run_of(lambda _: still(0.1)).penetration == pytest.approx(0.4)


def test_overlaps_are_seen_from_both_sides() -> None:
    robots = tuple(SpawnedRobot(entity=name, robot=BALL) for name in ("a", "b", "c"))
    engine = FakeEngine(
        lambda _: still(1.0),
        overlapping=(Overlap("a", "arm", "b", "leg", 0.25), Overlap("b", "leg", "b", "foot", 0.5)),
    )
    robot_runs, _ = run_scene(engine, Scene(world=World(name="w"), robots=robots), lambda _: None)
    assert {robot_run.entity: robot_run.overlaps for robot_run in robot_runs} == {
        "a": (Overlapping(link="arm", other_entity="b", other_link="leg", depth=0.25),),
        "b": (
            Overlapping(link="leg", other_entity="a", other_link="arm", depth=0.25),
            Overlapping(link="leg", other_entity=None, other_link="foot", depth=0.5),
        ),
        "c": (),
    }


def test_overlaps_are_those_at_the_start() -> None:
    """After all robots are where they are put."""
    seen: list[tuple[float, int]] = []

    class Engine(FakeEngine):
        def overlaps(self) -> list[Overlap]:
            seen.append((round(self.state("e").xyz[2], 6), self.steps))
            return []

    robots = (SpawnedRobot(entity="e", robot=BALL, on_the_ground=True),)
    scene = Scene(world=World(name="w", has_ground_plane=True), robots=robots)
    run_scene(Engine(lambda _: still(9.0), reach=0.5), scene, lambda _: None)
    assert seen == [(0.505, 0)]


def test_seconds_and_step() -> None:
    engine = FakeEngine(lambda _: still(1.0), step_seconds=0.004)
    scene = Scene(
        world=World(name="w", step=0.004),
        robots=(SpawnedRobot(entity="e", robot=BALL),),
        seconds=1.0,
    )
    run_scene(engine, scene, lambda _: None)
    assert engine.steps == 250


def test_refused_robots_do_not_stop_the_others() -> None:
    said: list[str] = []
    robots = tuple(SpawnedRobot(entity=name, robot=BALL) for name in ("good", "bad"))
    engine = FakeEngine(lambda _: still(1.0), refuses=frozenset({"bad"}))
    robot_runs, refused = run_scene(
        engine, Scene(world=World(name="w"), robots=robots), said.append
    )
    assert [robot_run.entity for robot_run in robot_runs] == ["good"]
    assert set(refused) == {"bad"}
    assert said == ["loading the robot `good`", "loading the robot `bad`", "simulating 3 s"]


def test_a_run_travels_as_json() -> None:
    robot_run = run_of(
        lambda _: still(1.0),
        positions=lambda t: {"j": t},
        energy=lambda t: t,
        overlapping=(Overlap("e", "a", "f", "b", 0.1), Overlap("e", "a", "e", "c", 0.2)),
    )
    assert len(robot_run.overlaps) == 2
    assert decode(json.loads(encode(robot_run)), RobotRun) == robot_run


@pytest.mark.parametrize(
    ("acceleration", "falls"), [(-9.8, True), (-4.9, False), (0.0, False), (9.8, False)]
)
def test_falling_is_getting_faster_with_gravity(acceleration: float, *, falls: bool) -> None:
    robot_run = run_of(lambda t: still(1.0 - t + acceleration * t * t / 2), ground=False)
    assert robot_run.is_falling == falls


def test_what_rolls_off_an_edge_falls_at_the_end() -> None:
    robot_run = run_of(lambda t: still(1.0 - 4.9 * max(0.0, t - 2.8) ** 2), ground=False)
    assert robot_run.is_falling
    assert not run_of(lambda t: still(1.0 - 4.9 * min(t, 0.4) ** 2), ground=False).is_falling

"""What every engine must do with motors: wheels roll, arms hold, the weak give way."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from simulation.movers import DRIVE, PAIR, RADIUS, arm, drive, reach, simulated, two_wheeled
from simulation.robots import BAR_MOMENT, GROUND, SPACE, VOID, G, NewEngine, lift, pendulum, spawned
from wsgen.model.behavior import Bounds, DiffDrive
from wsgen.model.robot import JointLimit
from wsgen.model.transform import Pose
from wsgen.simulation.engine import Motor
from wsgen.simulation.running_scene import RunningScene
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.simulation.simulate import run_scene

UPRIGHT = Pose((0.0, 0.0, RADIUS + 0.005))


@pytest.mark.slow
def test_a_robot_of_the_right_size_goes_where_it_is_sent(new_engine: NewEngine) -> None:
    ahead, turned, both = simulated(
        new_engine,
        two_wheeled(),
        drive(linear=0.5),
        drive(seconds=4.0, angular=1.0),
        drive(linear=0.5, angular=0.5),
    )
    assert list(ahead.moved) == [
        pytest.approx(1.0, abs=0.05),
        pytest.approx(0.0, abs=0.02),
        pytest.approx(0.0, abs=0.02),
    ]
    assert ahead.positions["left"] == pytest.approx(10.0, abs=0.1)
    x, y, yaw = turned.moved
    assert math.hypot(x, y) < 0.03
    assert yaw == pytest.approx(4.0, rel=0.05)  # more than half a turn
    assert list(both.moved) == [
        pytest.approx(math.sin(1.0), abs=0.05),
        pytest.approx(1 - math.cos(1.0), abs=0.05),
        pytest.approx(1.0, rel=0.06),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_casters_as_low_as_the_wheels_leave_them_their_load(
    new_engine: NewEngine, mu: float
) -> None:
    """One before and one behind the axle; wheels that spin at first keep what they carry."""
    (ahead,) = simulated(new_engine, two_wheeled(casters=(-0.17, 0.17), mu=mu), drive(linear=0.5))
    assert ahead.moved[0] == pytest.approx(1.0, abs=0.13)


@pytest.mark.slow
def test_it_goes_back_and_turns_right(new_engine: NewEngine) -> None:
    back, right = simulated(new_engine, two_wheeled(), drive(linear=-0.5), drive(angular=-1.0))
    assert back.moved[0] == pytest.approx(-1.0, abs=0.05)
    assert right.moved[2] == pytest.approx(-2.0, rel=0.06)


@pytest.mark.slow
def test_wrong_sizes_in_the_plugin_are_seen(new_engine: NewEngine) -> None:
    large = replace(DRIVE, pairs=(replace(PAIR, radius=0.2),))
    wide = replace(DRIVE, pairs=(replace(PAIR, separation=0.8),))
    slow, fast = simulated(
        new_engine, two_wheeled(), drive(using=large, linear=0.5), drive(using=wide, angular=0.5)
    )
    assert slow.moved[0] == pytest.approx(0.5, rel=0.05)
    assert fast.moved[2] == pytest.approx(2.0, rel=0.06)


@pytest.mark.slow
def test_what_the_plugin_bounds(new_engine: NewEngine) -> None:
    slowly = replace(DRIVE, linear=Bounds(fastest=0.2))
    gently = replace(DRIVE, linear=Bounds(braking=-0.25, acceleration=0.25))
    classic = replace(DRIVE, torque=5.0, rim=Bounds(braking=-0.25, acceleration=0.25))
    slow, gentle, rims = simulated(
        new_engine,
        two_wheeled(),
        *(drive(using=using, linear=0.5) for using in (slowly, gently, classic)),
    )
    assert slow.moved[0] == pytest.approx(0.4, rel=0.05)
    assert gentle.moved[0] == pytest.approx(0.5, rel=0.05)
    assert rims.moved[0] == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("torque", [None, 0.0])
def test_wheels_without_strength_stay(new_engine: NewEngine, torque: float | None) -> None:
    """Gazebo Classic asks the plugin how strong they are, Gazebo Sim the joint."""
    robot = two_wheeled(JointLimit(effort=0.0, velocity=30.0))
    (stays,) = simulated(new_engine, robot, drive(using=replace(DRIVE, torque=torque), linear=0.5))
    assert abs(stays.moved[0]) < 0.02


@pytest.mark.slow
def test_joints_of_gazebo_sim_keep_their_speed_limit(new_engine: NewEngine) -> None:
    robot = two_wheeled(JointLimit(effort=5.0, velocity=2.0))
    sim, classic = simulated(
        new_engine,
        robot,
        drive(linear=0.5),
        drive(using=replace(DRIVE, torque=5.0), linear=0.5),
    )
    assert sim.moved[0] == pytest.approx(0.4, rel=0.05)
    assert classic.moved[0] == pytest.approx(1.0, rel=0.05)


@pytest.mark.slow
def test_an_arm_holds_and_reaches(new_engine: NewEngine) -> None:
    held, reached = simulated(new_engine, arm(), reach(j1=0.0), reach(j1=-0.5, j2=0.8), at=Pose())
    assert held.positions == {
        "j1": pytest.approx(0.0, abs=0.01),
        "j2": pytest.approx(0.0, abs=0.01),
    }
    assert reached.positions == {
        "j1": pytest.approx(-0.5, abs=0.01),
        "j2": pytest.approx(0.8, abs=0.01),
    }


def test_an_arm_is_no_faster_than_its_limit(new_engine: NewEngine) -> None:
    (late,) = simulated(new_engine, arm(), reach(seconds=0.5, j2=1.2), at=Pose())
    assert late.positions["j2"] == pytest.approx(0.5, abs=0.03)


def test_a_weak_arm_sags(new_engine: NewEngine) -> None:
    """10 N m carry two thirds of what hangs on the first joint."""
    (sags,) = simulated(new_engine, arm(effort=10.0), reach(j1=0.0), at=Pose())
    assert 0.3 < sags.positions["j1"] < 1.5  # down is the positive way
    assert sags.positions["j2"] == pytest.approx(0.0, abs=0.05)


def test_bounds_below_zero_are_none(new_engine: NewEngine) -> None:
    (reached,) = simulated(
        new_engine, arm(effort=-1.0, velocity=-1.0), reach(j1=-1.0, j2=1.0), at=Pose()
    )
    assert reached.positions["j1"] == pytest.approx(-1.0, abs=0.01)


def test_a_joint_that_mimics_follows(new_engine: NewEngine) -> None:
    (reached,) = simulated(new_engine, arm(mimics=True), reach(j1=-0.4), at=Pose())
    assert reached.positions["j2"] == pytest.approx(0.9, abs=0.02)


def test_a_motor_is_as_strong_as_it_may_be(new_engine: NewEngine) -> None:
    with spawned(new_engine, lift(), world=SPACE) as engine:
        engine.drive("e", {"cabin": Motor(speed=1e3, effort=3.0)})
        engine.advance(500)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(3.0 * 0.5**2 / 2, rel=0.01)
        engine.drive("e", {"cabin": Motor(speed=0.2, effort=math.inf)})
        engine.advance(1000)
        before = engine.joint_positions("e")["cabin"]
        engine.advance(500)
        assert engine.joint_positions("e")["cabin"] - before == pytest.approx(0.1, rel=0.01)


def test_friction_is_taken_from_a_motor(new_engine: NewEngine) -> None:
    with spawned(new_engine, lift(friction=1.0), world=SPACE) as engine:
        engine.drive("e", {"cabin": Motor(speed=1e3, effort=3.0)})
        engine.advance(500)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(2.0 * 0.5**2 / 2, rel=0.02)
    with spawned(new_engine, lift(friction=3.0), world=SPACE) as engine:
        engine.drive("e", {"cabin": Motor(speed=1.0, effort=2.0)})
        engine.advance(500)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("damping", [2.0, 1000.0])
def test_damping_slows_a_motor(new_engine: NewEngine, damping: float) -> None:
    """Be it stiff or not; of 1 kg DART's motors push as if a step's damping were mass."""
    with spawned(new_engine, lift(damping=damping), world=SPACE) as engine:
        engine.drive("e", {"cabin": Motor(speed=1e3, effort=4.0)})
        engine.advance(4000)
        before = engine.joint_positions("e")["cabin"]
        engine.advance(1000)
        gone = engine.joint_positions("e")["cabin"] - before
        assert 0.98 < gone / (4.0 / damping) < 1.02 + damping * 0.001


@pytest.mark.parametrize("damping", [0.0, 50.0, 1000.0])
def test_a_joint_without_its_motor_is_passive_again(new_engine: NewEngine, damping: float) -> None:
    with spawned(new_engine, lift(damping=damping), world=VOID) as engine:
        engine.drive("e", {"cabin": Motor(speed=0.0, effort=100.0)})
        engine.advance(1000)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(0.0, abs=1e-3)
        engine.release("e")
        engine.advance(2000)
        before = engine.joint_positions("e")["cabin"]
        engine.advance(100)
        speed = (before - engine.joint_positions("e")["cabin"]) / 0.1
        expected = G / damping if damping else G * 2.05
        assert speed == pytest.approx(expected, rel=0.05)


def test_a_motor_of_one_joint_leaves_the_others(new_engine: NewEngine) -> None:
    robot = arm()
    with spawned(new_engine, robot, world=VOID) as engine:
        engine.drive("e", {"j1": Motor(speed=0.0, effort=100.0)})
        engine.advance(200)
        positions = engine.joint_positions("e")
        assert positions["j1"] == pytest.approx(0.0, abs=1e-3)
        assert positions["j2"] > 0.1


def test_a_driven_pendulum_reaches_its_speed(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(axis_in_joint=(0.0, 0.0, 1.0)), world=SPACE) as engine:
        engine.drive("e", {"bar": Motor(speed=2.0, effort=BAR_MOMENT)})
        engine.advance(1000)
        assert engine.state("e").joint_speed == pytest.approx(1.0, rel=0.01)
        engine.advance(2000)
        assert engine.state("e").joint_speed == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize(("using", "way"), [(DRIVE, 0.0), (None, 0.55)])
def test_a_plugin_keeps_the_wheels_still_on_a_slope(
    new_engine: NewEngine, using: DiffDrive | None, way: float
) -> None:
    slope = math.radians(5)
    world = replace(GROUND, gravity=(G * math.sin(slope), 0.0, -G * math.cos(slope)))
    robot = SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=UPRIGHT)
    scene = Scene(world=world, robots=(replace(robot, drive=using),), seconds=1.2)
    (run,), _ = run_scene(new_engine(world), scene, lambda _: None)
    assert run.rest_pose.xyz[0] == pytest.approx(way, abs=0.1 * way + 0.01)


def test_it_keeps_them_still_after_a_behavior_too(new_engine: NewEngine) -> None:
    scene = Scene(
        world=replace(GROUND, gravity=(G * math.sin(0.1), 0.0, -G * math.cos(0.1))),
        robots=(
            replace(
                SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=UPRIGHT), drive=DRIVE
            ),
        ),
    )
    running = RunningScene(scene, new_engine)
    running.drive("e", DRIVE, 0.5, 0.0)
    running.step(0.5)
    running.release("e")
    running.step(0.2)
    place = running.step(0.0).states[0].pose_in_world.xyz[0]
    assert place > 0.2
    # It rocks on its wheels; rolling, it would go half a meter.
    assert running.step(0.5).states[0].pose_in_world.xyz[0] == pytest.approx(place, abs=0.05)

"""What every engine must do with joints: passive, damped, sprung, limited, weightless."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from simulation.robots import (
    BAR_MOMENT,
    SPACE,
    VOID,
    G,
    NewEngine,
    joint,
    lift,
    pendulum,
    run_of,
    spawned,
)
from wsgen.model.robot import Inertial, JointLimit, JointType, Link
from wsgen.model.transform import Pose, compose
from wsgen.simulation.engine import Motor

TORQUE = G * 0.5  # N m, of the bar held out sideways


def speed_after(new_engine: NewEngine, steps: int, **more: object) -> float:
    with spawned(new_engine, pendulum(**more)) as engine:  # type: ignore[arg-type]
        engine.advance(steps)
        return engine.state("e").joint_speed


def test_joints_are_passive_and_the_world_holds(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum()) as engine:
        engine.advance(100)
        state = engine.state("e")
        assert state.xyz == (0.0, 0.0, 0.0)
        assert (state.speed, state.turning) == (0.0, 0.0)
        # About y, down is the positive way.
        fallen = TORQUE / BAR_MOMENT * 0.1**2 / 2
        assert engine.joint_positions("e") == {"bar": pytest.approx(fallen, rel=0.02)}
        assert state.joint_speed == pytest.approx(TORQUE / BAR_MOMENT * 0.1, rel=0.01)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -G), (0.0, G, 0.0), (0.0, G * 0.6, -G * 0.8)])
def test_a_ball_swings_whatever_way_it_is_pulled(
    new_engine: NewEngine, gravity: tuple[float, float, float]
) -> None:
    world = replace(VOID, gravity=gravity)
    # Gazebo reads none of these of a ball joint.
    robot = pendulum(JointType.BALL, axis_in_joint=(0.0, 0.0, 1.0))
    with spawned(new_engine, robot, world=world) as engine:
        before = engine.energy("e")
        engine.advance(100)
        fallen = TORQUE / BAR_MOMENT * 0.1**2 / 2
        assert engine.joint_positions("e") == {"bar": pytest.approx(fallen, rel=0.02)}
        assert engine.state("e").joint_speed == pytest.approx(TORQUE / BAR_MOMENT * 0.1, rel=0.01)
        assert engine.energy("e") == pytest.approx(before, abs=0.05)
        end = compose(engine.link_poses("e")["bar"], Pose((0.5, 0.0, 0.0))).xyz
        way = [part * 0.5 * math.sin(fallen) / G for part in gravity]
        assert end == pytest.approx((0.5 * math.cos(fallen), way[1], 2.0 + way[2]), abs=0.002)
        engine.advance(400)
        assert engine.joint_positions("e")["bar"] > math.radians(90)
        engine.place("e", Pose())
        assert engine.joint_positions("e") == {"bar": pytest.approx(0.0)}
        assert engine.state("e").joint_speed == 0.0


def test_friction_of_a_joint_is_taken_from_the_torque(new_engine: NewEngine) -> None:
    for friction in (1.0, 3.0):
        speed = speed_after(new_engine, 50, friction=friction)
        assert speed == pytest.approx((TORQUE - friction) / BAR_MOMENT * 0.05, rel=0.02)
    assert speed_after(new_engine, 3000, friction=TORQUE * 1.05) < 1e-3


@pytest.mark.parametrize("damping", [5.0, 50.0, 500.0, 5e4])
def test_the_speed_of_a_damped_fall(new_engine: NewEngine, damping: float) -> None:
    """Damping takes all of the weight at this speed, be it stiff (above 500 N s/m) or not."""
    with spawned(new_engine, lift(damping=damping)) as engine:
        engine.advance(2000)
        before = engine.joint_positions("e")["cabin"]
        engine.advance(500)
        fallen = before - engine.joint_positions("e")["cabin"]
        assert fallen / 0.5 == pytest.approx(G / damping, rel=0.05, abs=2e-4)


@pytest.mark.parametrize("damping", [100.0, 1000.0])
def test_a_stiffly_damped_hinge_creeps(new_engine: NewEngine, damping: float) -> None:
    with spawned(new_engine, pendulum(damping=damping)) as engine:
        engine.advance(1000)
        before = engine.joint_positions("e")["bar"]
        engine.advance(1000)
        turned = engine.joint_positions("e")["bar"] - before
        assert turned == pytest.approx(TORQUE / damping, rel=0.05)


@pytest.mark.parametrize(("damping", "friction"), [(50.0, G / 2), (1000.0, 1.1 * G)])
def test_damping_and_friction_together(
    new_engine: NewEngine, damping: float, friction: float
) -> None:
    with spawned(new_engine, lift(damping=damping, friction=friction)) as engine:
        engine.advance(1000)
        before = engine.joint_positions("e")["cabin"]
        engine.advance(500)
        fallen = before - engine.joint_positions("e")["cabin"]
        expected = max(0.0, G - friction) / damping
        # DART lets friction work on the speed that its damping has already made smaller.
        assert fallen / 0.5 == pytest.approx(expected, rel=0.1, abs=2e-4)


def test_a_light_link_with_a_stiff_damper_does_not_explode(new_engine: NewEngine) -> None:
    """A finger of 1 g that is damped as if it weighed 1 kg; TIAGo and iCub have such."""
    finger = Link(
        name="finger",
        inertial=Inertial(
            mass=1e-3, pose_in_link=Pose((0.02, 0.0, 0.0)), inertia=(1e-7, 0, 0, 1e-7, 0, 1e-7)
        ),
    )
    hinge = joint(
        "bar", "finger", JointType.CONTINUOUS, Pose((1.0, 0.0, 0.0)), axis_in_joint=(0, 1, 0)
    )
    arm = pendulum(damping=0.5)
    robot = replace(
        arm, links=(*arm.links, finger), joints=(*arm.joints, replace(hinge, damping=0.5))
    )
    robot_run = run_of(new_engine, robot, world=VOID)
    assert robot_run.is_finite
    assert robot_run.energy_gain < 0.01
    assert robot_run.joint_travel["finger"] < 0.05


def test_limits_hold(new_engine: NewEngine) -> None:
    limit = JointLimit(lower=-0.2, upper=0.5, effort=1.0, velocity=1.0)
    robot_run = run_of(new_engine, pendulum(JointType.REVOLUTE, limit=limit), world=VOID)
    assert robot_run.joint_positions["bar"] == pytest.approx(0.5, abs=0.02)
    assert robot_run.joint_travel["bar"] == pytest.approx(0.5, abs=0.05)
    assert robot_run.settled_after is not None
    held = pendulum(JointType.REVOLUTE, limit=JointLimit(effort=1.0))
    assert run_of(new_engine, held, world=VOID).joint_travel["bar"] < 0.01
    assert run_of(new_engine, lift(limit=limit), world=VOID).joint_positions[
        "cabin"
    ] == pytest.approx(-0.2, abs=0.01)


def test_a_joint_that_starts_beyond_its_limit_is_pushed_back(new_engine: NewEngine) -> None:
    """Without a jump: the bar in space is not faster than DART pushes, 10 rad/s."""
    limit = JointLimit(lower=0.4, upper=1.0, effort=1.0, velocity=1.0)
    robot = pendulum(JointType.REVOLUTE, limit=limit, damping=0.5)
    with spawned(new_engine, robot, world=SPACE) as engine:
        engine.advance(10)
        assert engine.state("e").joint_speed < 10.1
        engine.advance(490)
        assert 0.38 < engine.joint_positions("e")["bar"] < 1.02


def test_a_continuous_joint_has_no_limits(new_engine: NewEngine) -> None:
    limit = JointLimit(lower=-0.2, upper=0.5, effort=1.0, velocity=1.0)
    with spawned(new_engine, pendulum(limit=limit)) as engine:
        engine.advance(300)
        assert engine.joint_positions("e")["bar"] > 0.55


@pytest.mark.parametrize(
    "limit",
    [
        None,
        JointLimit(lower=-math.inf, upper=math.inf, effort=math.inf, velocity=math.inf),
        JointLimit(lower=-1e16, upper=1e16),
    ],
)
def test_joints_without_bounds(new_engine: NewEngine, limit: JointLimit | None) -> None:
    """SDF has them: without <limit>, or with its default of 1e16."""
    with spawned(new_engine, pendulum(JointType.REVOLUTE, limit=limit)) as engine:
        engine.advance(100)
        assert engine.state("e").joint_speed == pytest.approx(TORQUE / BAR_MOMENT * 0.1, rel=0.01)
        engine.advance(500)
        assert engine.joint_positions("e")["bar"] > 1.5
    with spawned(new_engine, lift(limit=limit)) as engine:
        engine.advance(1000)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(-G / 2, rel=0.01)


@pytest.mark.parametrize("reference", [0.3, -0.2])
def test_the_period_of_a_spring(new_engine: NewEngine, reference: float) -> None:
    """Let go at 0, it swings to twice its rest position and back."""
    upright = pendulum(
        axis_in_joint=(0.0, 0.0, 1.0), spring_stiffness=20.0, spring_reference=reference
    )
    for robot, name, resistance in (
        (upright, "bar", BAR_MOMENT),
        (
            lift(axis_in_joint=(1.0, 0.0, 0.0), spring_stiffness=20.0, spring_reference=reference),
            "cabin",
            1.0,
        ),
    ):
        half = round(1000 * math.pi * math.sqrt(resistance / 20.0))
        with spawned(new_engine, robot) as engine:
            engine.advance(half // 2)
            assert engine.joint_positions("e")[name] == pytest.approx(reference, rel=0.02)
            engine.advance(half - half // 2)
            assert engine.joint_positions("e")[name] == pytest.approx(2 * reference, rel=0.01)
            engine.advance(half)
            assert engine.joint_positions("e")[name] == pytest.approx(0.0, abs=0.01)


def test_a_spring_with_friction_and_damping_comes_to_rest(new_engine: NewEngine) -> None:
    """Where the spring carries the weight."""
    robot = lift(spring_stiffness=100.0, damping=20.0)
    robot_run = run_of(new_engine, robot, world=VOID)
    assert robot_run.joint_positions["cabin"] == pytest.approx(-G / 100.0, rel=0.01)
    assert robot_run.settled_after is not None


def test_a_held_joint_stays_and_can_be_driven(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(is_held=True, damping=0.5)) as engine:
        engine.advance(1000)
        assert engine.joint_positions("e") == {"bar": pytest.approx(0.0, abs=1e-4)}
        engine.drive("e", {"bar": Motor(speed=-0.5, effort=100.0)})
        engine.advance(500)
        driven = engine.joint_positions("e")["bar"]
        assert driven == pytest.approx(-0.25, abs=0.02)
        engine.release("e")
        engine.advance(500)
        assert engine.joint_positions("e")["bar"] == pytest.approx(driven, abs=0.01)

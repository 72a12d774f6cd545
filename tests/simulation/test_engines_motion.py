"""What every engine must do with bodies that move: energy, missing gravity, kinematics."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from simulation.robots import (
    BAR,
    GROUND,
    PLATE,
    SPACE,
    G,
    NewEngine,
    body,
    joint,
    pendulum,
    single,
    spawned,
    tree,
)
from wsgen.model.robot import Box, Inertial, JointLimit, JointType, Link
from wsgen.model.transform import Pose, compose, rotate, rotation_of_rpy
from wsgen.simulation.scene import SpawnedRobot


def test_a_spring_is_part_of_the_energy(new_engine: NewEngine) -> None:
    """What a wound-up spring gives to the robot does not come from nowhere."""
    robot = pendulum(axis_in_joint=(0.0, 0.0, 1.0), spring_stiffness=20.0, spring_reference=1.0)
    with spawned(new_engine, robot) as engine:
        before = engine.energy("e")
        for _ in range(5):
            engine.advance(80)
            assert engine.energy("e") == pytest.approx(before, abs=0.03 * 10.0)


def test_a_link_without_gravity_floats(new_engine: NewEngine) -> None:
    link = body(Box(size=(0.1, 0.2, 0.3)), at=Pose((0.3, 0.2, 0.1), (0.5, 0.4, 0.3)))
    with spawned(new_engine, single(replace(link, gravity=False))) as engine:
        before = engine.energy("e")
        engine.advance(1000)
        assert engine.state("e").xyz == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
        assert engine.state("e").turning < 1e-6
        assert engine.energy("e") == pytest.approx(before, abs=1e-9)


def test_a_hanging_link_without_gravity_stays(new_engine: NewEngine) -> None:
    arm = pendulum()
    bar = replace(BAR, gravity=False)
    with spawned(new_engine, replace(arm, links=(arm.links[0], bar))) as engine:
        engine.advance(1000)
        assert abs(engine.joint_positions("e")["bar"]) < 1e-6


def test_the_energy_of_a_robot_that_is_partly_without_gravity(new_engine: NewEngine) -> None:
    """A heavy bar and a balloon at its end, which has mass and no weight."""
    balloon = joint("bar", "balloon", JointType.CONTINUOUS, Pose((1.0, 0.0, 0.0)))
    arm = pendulum()
    light = replace(body(None, name="balloon"), gravity=False)
    robot = replace(arm, links=(*arm.links, light), joints=(*arm.joints, balloon))
    with spawned(new_engine, robot) as engine:
        before = engine.energy("e")
        for _ in range(5):
            engine.advance(100)
            assert engine.energy("e") == pytest.approx(before, abs=0.01 * G)


def test_free_fall_conserves_energy(new_engine: NewEngine) -> None:
    """Of a body that tumbles, with products of inertia and its mass off its frame."""
    hub = Link(
        name="hub",
        inertial=Inertial(
            mass=2.0,
            pose_in_link=Pose((0.1, -0.2, 0.3), (0.4, 0.5, 0.6)),
            inertia=(0.3, 0.02, -0.03, 0.25, 0.04, 0.2),
        ),
    )
    robot = tree(
        hub, (joint("hub", "bar", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0)), BAR)
    )
    with spawned(
        new_engine,
        replace(
            robot, joints=(replace(robot.joints[0], spring_stiffness=3.0, spring_reference=2),)
        ),
        Pose((0.0, 0.0, 20.0), (0.3, 0.2, 0.1)),
    ) as engine:
        before = engine.energy("e")
        engine.advance(1000)
        assert engine.state("e").turning > 0.3
        fallen = 3.0 * G * G / 2
        assert engine.energy("e") == pytest.approx(before, abs=1e-3 * 3.0 * G * fallen)


def test_a_falling_stone_conserves_energy(new_engine: NewEngine) -> None:
    stone = single(body(Box(size=(0.1, 0.2, 0.3)), mass=2.0))
    with spawned(new_engine, stone, Pose((0.0, 0.0, 10.0))) as engine:
        assert engine.energy("e") == pytest.approx(2.0 * G * 10.0)
        engine.advance(1000)
        assert engine.state("e").speed == pytest.approx(G, rel=1e-6)
        assert engine.energy("e") == pytest.approx(2.0 * G * 10.0, rel=1e-3)


def test_a_pendulum_conserves_energy(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum()) as engine:
        before = engine.energy("e")
        assert before == pytest.approx(G * 2.0)
        swing = G * 0.5  # J, that go into motion and back
        for _ in range(30):
            engine.advance(100)
            assert engine.energy("e") == pytest.approx(before, abs=0.01 * swing)


def test_energy_does_not_hang_on_the_mass_of_what_stands_still(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(), Pose((0.0, 0.0, 3.0)), world=SPACE) as engine:
        assert engine.energy("e") == pytest.approx(0.0, abs=1e-12)


def test_link_poses_are_those_of_forward_kinematics(new_engine: NewEngine) -> None:
    """An arm of three links with turned joints, after it has swung for a while."""
    turned = [
        Pose((0.1, 0.2, 0.3), (0.4, -0.5, 0.6)),
        Pose((0.3, 0.0, 0.1), (-1.2, 0.3, 2.0)),
        Pose((0.0, -0.4, 0.2), (0.7, 0.8, -0.9)),
    ]
    kinds = (JointType.CONTINUOUS, JointType.PRISMATIC, JointType.REVOLUTE)
    axes = ((0.0, 0.6, 0.8), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    limit = JointLimit(lower=-1.0, upper=1.0, effort=1.0, velocity=1.0)
    parents = ("base", "a", "b")
    joints = [
        joint(parent, child, kind, at, axis_in_joint=axis, limit=limit)
        for parent, child, kind, at, axis in zip(
            parents, ("a", "b", "c"), kinds, turned, axes, strict=True
        )
    ]
    links = [
        body(Box(size=(0.1, 0.2, 0.3)), name=name, at=Pose((0.1, 0.1, 0.0), (0.3, 0.2, 0.1)))
        for name in ("a", "b", "c")
    ]
    wound = [replace(one, spring_stiffness=2.0, spring_reference=0.5) for one in joints]
    robot = tree(body(None, mass=5.0), *zip(wound, links, strict=True))
    with spawned(new_engine, robot, Pose((1.0, 2.0, 3.0), (0.3, 0.2, 0.1))) as engine:
        for steps in (0, 300):
            engine.advance(steps)
            positions = engine.joint_positions("e")
            poses = engine.link_poses("e")
            assert (max(map(abs, positions.values())) > 0.05) == bool(steps)
            expected = {"base": poses["base"]}
            for one in joints:
                moved = _moved(one.axis_in_joint, positions[one.name], one.type)
                expected[one.child] = compose(
                    compose(expected[one.parent], one.pose_in_parent), moved
                )
                assert poses[one.child].xyz == pytest.approx(expected[one.child].xyz, abs=1e-5)
                _same_rotation(poses[one.child], expected[one.child])
            state = engine.state("e")
            assert poses["base"].xyz == pytest.approx(state.xyz)


def _moved(axis: tuple[float, float, float], position: float, kind: JointType) -> Pose:
    x, y, z = axis
    if kind is JointType.PRISMATIC:
        return Pose((x * position, y * position, z * position))
    # Turn an axis of the y-z plane or z into x by a rotation about x, and turn about that.
    tip = math.atan2(y, z)
    tipped = Pose(rpy=(-tip, 0.0, 0.0))
    back = Pose(rpy=(tip, 0.0, 0.0))
    return compose(compose(tipped, Pose(rpy=(0.0, 0.0, position))), back)


def _same_rotation(one: Pose, other: Pose) -> None:
    for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        turned = [rotate(rotation_of_rpy(pose.rpy), axis) for pose in (one, other)]
        assert turned[0] == pytest.approx(turned[1], abs=1e-5)


def test_placed_elsewhere_it_moves_as_if_spawned_there(new_engine: NewEngine) -> None:
    there = Pose((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    with spawned(new_engine, pendulum(), there) as engine:
        engine.advance(700)
        expected = (engine.link_poses("e"), engine.state("e"))
    with spawned(new_engine, pendulum(damping=0.0), Pose((5.0, 0.0, 0.0))) as engine:
        engine.advance(450)
        engine.place("e", there)
        assert engine.joint_positions("e") == {"bar": 0.0}
        assert engine.state("e").joint_speed == 0.0
        engine.advance(700)
        found = (engine.link_poses("e"), engine.state("e"))
    for name, pose in expected[0].items():
        assert found[0][name].xyz == pytest.approx(pose.xyz, abs=1e-9)
    assert found[1].joint_speed == pytest.approx(expected[1].joint_speed)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [1e6, 1e12])  # m/s; the first one gets far away only in time
def test_a_robot_that_flies_away_harms_no_other(new_engine: NewEngine, speed: float) -> None:
    """It is not finite then, or flies on; ODE, which finds contacts for DART, would abort."""
    stays, leaves = (
        SpawnedRobot(entity=name, robot=single(body(PLATE)), pose_in_world=Pose((x, 0.0, 0.1)))
        for name, x in (("stays", 0.0), ("leaves", 3.0))
    )
    engine = new_engine(GROUND)
    for robot in (stays, leaves):
        engine.spawn(robot)
    engine.set_velocity("leaves", (speed, 0.0, speed), (0.0, 0.0, 0.0))
    for _ in range(60):
        engine.advance(500)
    assert engine.look("stays").is_finite
    assert engine.state("stays").xyz[2] == pytest.approx(0.05, abs=0.01)
    engine.cast_rays([(0.0, 0.0, 1.0)], [(0.0, 0.0, -1.0)])
    engine.place("leaves", leaves.pose_in_world)  # as a reset does
    engine.advance(1000)
    assert engine.look("leaves").is_finite
    assert engine.state("leaves").xyz[0] == pytest.approx(3.0, abs=0.01)
    engine.remove("leaves")
    engine.close()

"""What every engine must do with a robot: take it whole, let it fall, let it rest."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from simulation.robots import (
    BAR,
    CYLINDER,
    GROUND,
    PLATE,
    VOID,
    NewEngine,
    body,
    joint,
    loaded,
    run_of,
    single,
    spawned,
    tree,
)
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Geometry,
    Inertial,
    JointType,
    Link,
    Robot,
    Sphere,
)
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation.engine import Loaded
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.simulation.simulate import run_scene

LYING = (0.0, math.pi / 2, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("moment", [0.06, 100.0])
@pytest.mark.parametrize("z", [0.25, 0.255, 0.5])
def test_the_cylinder_of_the_tutorial_comes_to_rest(
    new_engine: NewEngine, z: float, moment: float
) -> None:
    robot_run = run_of(new_engine, single(body(CYLINDER, moment=moment, mu=0.2)), z)
    assert (robot_run.links, robot_run.movable_joints, robot_run.mass) == (1, 0, 1.0)
    assert robot_run.rest_pose.xyz[2] == pytest.approx(0.25, abs=0.0005)
    assert robot_run.tilt < math.radians(0.1)
    assert robot_run.settled_after is not None


@pytest.mark.parametrize(
    ("geometry", "at", "height"),
    [
        (Sphere(radius=0.2), Pose(), 0.2),
        (Box(size=(0.2, 0.3, 0.4)), Pose(), 0.2),
        (CYLINDER, Pose(), 0.25),
        (CYLINDER, Pose(rpy=LYING), 0.4),
        (Capsule(radius=0.1, length=0.3), Pose(rpy=LYING), 0.1),
    ],
)
def test_shapes_rest_on_their_surface(
    new_engine: NewEngine, geometry: Geometry, at: Pose, height: float
) -> None:
    robot_run = run_of(new_engine, single(body(geometry, at=at)), height + 0.01)
    assert robot_run.rest_pose.xyz[2] == pytest.approx(height, abs=0.001)
    assert robot_run.settled_after is not None


def test_the_pose_is_that_of_the_link_not_of_its_center_of_mass(new_engine: NewEngine) -> None:
    """A box whose link frame lies in its bottom, with turned principal axes."""
    link = body(Box(size=(1.0, 1.0, 0.2)), at=Pose((0.2, 0.1, 0.1), (0.0, 0.0, 0.5)))
    robot_run = run_of(new_engine, single(link), 0.002)
    assert robot_run.rest_pose.xyz == pytest.approx((0.0, 0.0, 0.0), abs=0.001)
    assert robot_run.rest_pose.rpy == pytest.approx((0.0, 0.0, 0.0), abs=0.001)


def test_falls_without_ground(new_engine: NewEngine) -> None:
    robot_run = run_of(new_engine, single(body(CYLINDER)), 1.0, world=VOID, seconds=1.0)
    assert robot_run.rest_pose.xyz[2] == pytest.approx(1.0 - 4.9, abs=0.01)
    assert robot_run.lowest_point_at_end == pytest.approx(0.75 - 4.9, abs=0.02)
    assert robot_run.settled_after is None
    assert robot_run.penetration == 0.0


def test_falls_without_collision(new_engine: NewEngine) -> None:
    robot_run = run_of(new_engine, single(body(None)), 1.0, seconds=1.0)
    assert robot_run.rest_pose.xyz[2] == pytest.approx(1.0 - 4.9, abs=0.01)
    assert robot_run.lowest_point == 1.0


def test_falls_below_the_ground(new_engine: NewEngine) -> None:
    robot_run = run_of(new_engine, single(body(CYLINDER)), -50.0, seconds=1.0)
    assert robot_run.lowest_point == pytest.approx(-50.25, abs=0.01)
    assert robot_run.lowest_point_at_end == pytest.approx(-55.15, abs=0.02)


def test_gravity_and_step_of_the_world(new_engine: NewEngine) -> None:
    moon = World(name="moon", gravity=(0.0, 0.3, -1.6), step=0.004)
    robot_run = run_of(new_engine, single(body(CYLINDER)), 10.0, world=moon, seconds=1.0)
    assert robot_run.speed == pytest.approx(math.hypot(0.3, 1.6), abs=0.001)
    # Half a step more or less, by the order in which an engine adds up.
    assert 10.0 - robot_run.rest_pose.xyz[2] == pytest.approx(0.8, abs=1.6 * 0.004)


def test_a_body_that_turns_in_space_goes_on_turning(new_engine: NewEngine) -> None:
    """It is let go off its center: no engine may damp it, as Gazebo Sim does not."""
    robot = tree(
        body(None, name="hub", mass=100.0, moment=100.0),
        (joint("hub", "bar", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0)), BAR),
    )
    with spawned(new_engine, robot) as engine:
        engine.advance(1000)
        assert engine.state("e").speed == pytest.approx(9.8, rel=1e-3)


@pytest.mark.slow
def test_same_scene_same_run(new_engine: NewEngine) -> None:
    robot = tree(
        body(PLATE),
        (joint("base", "bar", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0)), BAR),
    )
    assert run_of(new_engine, robot, 0.3) == run_of(new_engine, robot, 0.3)


def test_two_robots_at_once(new_engine: NewEngine) -> None:
    robots = tuple(
        SpawnedRobot(entity=name, robot=single(body(geometry)), pose_in_world=Pose((x, 0.0, 0.3)))
        for name, x, geometry in (("a", 0.0, CYLINDER), ("b", 3.0, Sphere(radius=0.1)))
    )
    engine = new_engine(GROUND)
    robot_runs, _ = run_scene(engine, Scene(world=GROUND, robots=robots), lambda _: None)
    engine.close()
    assert [robot_run.entity for robot_run in robot_runs] == ["a", "b"]
    assert [robot_run.rest_pose.xyz[2] for robot_run in robot_runs] == pytest.approx(
        [0.25, 0.1], abs=0.001
    )


def test_robots_stand_on_each_other(new_engine: NewEngine) -> None:
    upper = SpawnedRobot(
        entity="upper", robot=single(body(PLATE)), pose_in_world=Pose((0.0, 0.0, 0.16))
    )
    lower = single(body(PLATE))
    with spawned(new_engine, lower, Pose((0.0, 0.0, 0.05)), upper, world=GROUND) as engine:
        engine.advance(1500)
        assert engine.state("upper").xyz[2] == pytest.approx(0.15, abs=0.002)
        assert engine.state("upper").speed < 0.01


def test_the_robot_is_static(new_engine: NewEngine) -> None:
    """Nothing of it moves, and everything stands on it."""
    table = tree(
        body(Box(size=(1.0, 1.0, 0.1)), name="top", mass=3.0),
        (joint("top", "arm", JointType.CONTINUOUS), replace(BAR, name="arm")),
        is_static=True,
    )
    on_it = SpawnedRobot(
        entity="on it", robot=single(body(PLATE)), pose_in_world=Pose((-0.2, 0.0, 1.11))
    )
    assert loaded(new_engine, table) == Loaded(2, 0, 4.0)
    with spawned(new_engine, table, Pose((0.0, 0.0, 1.0)), on_it, world=GROUND) as engine:
        before = engine.link_poses("e")
        engine.advance(1000)
        assert engine.link_poses("e") == before
        assert engine.joint_positions("e") == {}
        assert engine.state("e").joint_speed == engine.state("e").speed == 0.0
        assert engine.state("on it").xyz[2] == pytest.approx(1.1, abs=0.002)


def test_loose_parts_fall_off(new_engine: NewEngine) -> None:
    """A shelf fixed to the world carries a box beside it; the box has a bar on a joint."""
    off = joint("world", "box", JointType.FLOATING, Pose((2.0, 0.0, 1.0)))
    robot = Robot(
        name="r",
        root="world",
        links=(
            Link(name="world"),
            body(PLATE, name="shelf", mass=5.0),
            body(PLATE, name="box", mass=2.0),
            BAR,
        ),
        joints=(
            joint("world", "shelf", JointType.FIXED, Pose((0.0, 0.0, 1.0))),
            joint("box", "bar", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0)),
        ),
        loose=(off,),
        fixed_to_world=True,
    )
    assert loaded(new_engine, robot) == Loaded(3, 1, 8.0)
    with spawned(new_engine, robot, Pose((0.0, 0.0, 0.5))) as engine:
        assert engine.link_poses("e")["box"].xyz == pytest.approx((2.0, 0.0, 1.5))
        engine.advance(500)
        poses = engine.link_poses("e")
        assert poses["shelf"].xyz == pytest.approx((0.0, 0.0, 1.5))
        assert poses["box"].xyz[2] == pytest.approx(1.5 - 9.8 / 8, abs=0.02)


def test_a_chain_that_is_fixed_to_the_world(new_engine: NewEngine) -> None:
    mast = joint("world", "mast", JointType.FIXED, Pose((0.0, 0.0, 1.0)))
    swing = joint("mast", "bar", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0))
    robot = tree(
        Link(name="world"),
        (mast, body(None, name="mast")),
        (swing, BAR),
        fixed_to_world=True,
    )
    with spawned(new_engine, robot, Pose((1.0, 2.0, 3.0), (0.0, 0.0, 1.0))) as engine:
        engine.advance(500)
        assert engine.state("e").xyz == pytest.approx((1.0, 2.0, 3.0))
        assert engine.state("e").joint_speed > 2.0
        assert engine.link_poses("e")["mast"].xyz == pytest.approx((1.0, 2.0, 4.0), abs=1e-9)


def test_a_thin_rod_has_no_inertia_along_itself(new_engine: NewEngine) -> None:
    """Gazebo takes moments of zero (of a point mass); they must not make states infinite."""
    point = Link(
        name="base",
        inertial=Inertial(mass=1.0, inertia=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
        collisions=(Collision(geometry=Sphere(radius=0.1)),),
    )
    robot_run = run_of(new_engine, single(point), 0.11)
    assert robot_run.is_finite

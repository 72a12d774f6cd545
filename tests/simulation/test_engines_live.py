"""What live runs need of every engine: rays, velocities of links, efforts in joints."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from simulation.robots import (
    BAR_MOMENT,
    GROUND,
    PLATE,
    SPACE,
    G,
    NewEngine,
    body,
    cube_mesh,
    joint,
    lift,
    pendulum,
    single,
    spawned,
)
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Geometry,
    JointType,
    Link,
    Sphere,
)
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.engine import Motor
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.engine import Engine

HELD = 0.5 * G  # N m, that hold the bar of the pendulum out sideways


def range_along(
    engine: Engine, start: tuple[float, float, float], end: tuple[float, float, float]
) -> float:
    """How far one ray gets, m."""
    (fraction,) = engine.cast_rays([start], [end])
    return float(fraction) * math.dist(start, end)


@pytest.mark.parametrize(
    ("geometry", "distance"),
    [
        (Box(size=(0.4, 2.0, 2.0)), 1.8),
        (Sphere(radius=0.5), 1.5),
        (Cylinder(radius=0.3, length=1.0), 1.7),
        (Capsule(radius=0.25, length=1.0), 1.75),
    ],
)
def test_rays_see_shapes(new_engine: NewEngine, geometry: Geometry, distance: float) -> None:
    with spawned(new_engine, single(body(geometry)), Pose((2.0, 0.0, 1.0))) as engine:
        seen = range_along(engine, (0.0, 0.0, 1.0), (10.0, 0.0, 1.0))
        assert seen == pytest.approx(distance, abs=6e-3)  # DART: of a capsule
        assert range_along(engine, (0.0, 0.0, 1.0), (-10.0, 0.0, 1.0)) == math.inf
        # An end before the shape.
        assert range_along(engine, (0.0, 0.0, 1.0), (distance - 0.01, 0.0, 1.0)) == math.inf


def test_rays_see_turned_shapes_where_they_are_now(new_engine: NewEngine) -> None:
    box = single(body(Box(size=(1.0, 1.0, 1.0)), at=Pose((0.0, 0.0, 0.2))))
    with spawned(new_engine, box, Pose((3.0, 0.0, 0.8), (0.0, 0.0, math.pi / 4))) as engine:
        ray = (0.0, 0.0, 1.0), (10.0, 0.0, 1.0)
        assert range_along(engine, *ray) == pytest.approx(3.0 - math.sqrt(0.5), abs=2e-3)
        engine.place("e", Pose((5.0, 0.0, 0.8)))
        assert range_along(engine, *ray) == pytest.approx(4.5, abs=2e-3)
        engine.advance(100)
        assert range_along(engine, *ray) == pytest.approx(4.5, abs=2e-3)


def test_rays_see_what_is_there_instead(new_engine: NewEngine) -> None:
    cube = single(body(Box(size=(1.0, 1.0, 1.0))))
    with spawned(new_engine, cube, Pose((3.0, 0.0, 1.0))) as engine:
        ray = (0.0, 0.0, 1.0), (10.0, 0.0, 1.0)
        assert range_along(engine, *ray) == pytest.approx(2.5, abs=2e-3)
        engine.remove("e")
        assert range_along(engine, *ray) == math.inf
        engine.spawn(SpawnedRobot(entity="f", robot=cube, pose_in_world=Pose((5.0, 0.0, 1.0))))
        assert range_along(engine, *ray) == pytest.approx(4.5, abs=2e-3)


def test_many_rays_see_ground_and_walls(new_engine: NewEngine, tmp_path: Path) -> None:
    """A robot in a room: one wall is a box, one a mesh of triangles, and below is the ground."""
    mesh = replace(cube_mesh(tmp_path), scale=(0.1, 2.0, 2.0))
    walls = Link(
        name="walls",
        collisions=(
            Collision(geometry=Box(size=(0.2, 4.0, 4.0)), pose_in_link=Pose((2.1, 0.0, 1.0))),
            Collision(geometry=mesh, pose_in_link=Pose((-3.1, 0.0, 1.0))),
        ),
    )
    room = replace(single(walls), is_static=True)
    with spawned(
        new_engine,
        single(body(PLATE)),
        Pose((0.0, 0.0, 0.5)),
        SpawnedRobot(entity="room", robot=room, is_static_model=True),
        world=GROUND,
    ) as engine:
        ways = np.array(
            [[1, 0, 0], [-1, 0, 0], [0, 0, -1], [0, 1, 0], [0, 0, 1], [1, 0, -1]], float
        )
        starts = np.full((6, 3), (0.0, 0.0, 1.0))
        found = engine.cast_rays(starts, starts + 8.0 * ways) * 8.0
        # The plate is below, its upper side at 0.55 m.
        assert found[:3] == pytest.approx([2.0, 3.0, 0.45], abs=3e-3)
        assert list(found[3:5]) == [math.inf, math.inf]
        assert found[5] == pytest.approx(1.0, abs=3e-3)
        assert found.shape == (6,)
        many = np.repeat(starts[:1], 20_000, axis=0)
        assert engine.cast_rays(many[:200], many[:200] + ways[0] * 8.0) == pytest.approx(
            0.25, abs=1e-3
        )
        assert len(engine.cast_rays(many[:0], many[:0])) == 0


def test_velocities_of_links_are_those_of_their_frames(new_engine: NewEngine) -> None:
    """A bar with its center of mass elsewhere turns about the origin of its frame."""
    with spawned(new_engine, pendulum(), world=SPACE) as engine:
        engine.drive("e", {"bar": Motor(2.0, 1000.0)})
        engine.advance(200)
        linear, angular = engine.link_velocities("e")["bar"]
        assert linear == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
        assert angular == pytest.approx((0.0, 2.0, 0.0), rel=1e-2, abs=1e-3)
        assert engine.link_velocities("e")["world"] == ((0, 0, 0), (0, 0, 0))


def test_velocities_of_a_tip_and_of_a_root(new_engine: NewEngine) -> None:
    tip = joint("bar", "tip", JointType.FIXED, Pose((1.0, 0.0, 0.0)))
    robot = pendulum()
    robot = replace(
        robot,
        links=(*robot.links, body(None, name="tip", mass=0.1)),
        joints=(*robot.joints, tip),
    )
    with spawned(new_engine, robot, world=SPACE) as engine:
        engine.drive("e", {"bar": Motor(1.0, 1000.0)})
        engine.advance(100)
        angle = engine.joint_positions("e")["bar"]
        linear, angular = engine.link_velocities("e")["tip"]
        assert linear == pytest.approx(
            (-math.sin(angle), 0.0, -math.cos(angle)), rel=2e-2, abs=2e-3
        )
        assert angular == pytest.approx((0.0, 1.0, 0.0), rel=1e-2, abs=1e-3)
    aside = single(body(PLATE, at=Pose((0.3, 0.0, 0.0))))
    with spawned(new_engine, aside, Pose((0.0, 0.0, 50.0))) as engine:
        engine.advance(100)
        linear, angular = engine.link_velocities("e")["base"]
        assert linear == pytest.approx((0.0, 0.0, -0.1 * G), rel=2e-2, abs=1e-6)
        assert angular == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_an_effort_acts_until_it_is_replaced(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(), world=SPACE) as engine:
        engine.set_efforts("e", {"bar": 2.0})
        engine.advance(100)
        speed = 0.2 / BAR_MOMENT
        assert engine.joint_velocities("e")["bar"] == pytest.approx(speed, rel=0.03)
        assert engine.joint_efforts("e") == {"bar": pytest.approx(2.0)}
        engine.set_efforts("e", {"bar": 0.0})
        engine.advance(100)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(speed, rel=0.03)
        assert engine.joint_efforts("e") == {"bar": 0.0}
        engine.set_efforts("e", {"bar": 1.0})
        engine.release("e")
        engine.advance(100)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(speed, rel=0.03)


def test_an_effort_carries_a_weight_on_a_slide(new_engine: NewEngine) -> None:
    with spawned(new_engine, lift()) as engine:
        engine.set_efforts("e", {"cabin": G})
        engine.advance(200)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(0.0, abs=1e-3)
        engine.set_efforts("e", {"cabin": G + 2.0})
        engine.advance(200)
        assert engine.joint_velocities("e")["cabin"] == pytest.approx(0.4, rel=0.02)


def test_efforts_and_springs_add_up(new_engine: NewEngine) -> None:
    sprung = lift(spring_stiffness=100.0, damping=5.0)
    with spawned(new_engine, sprung, world=SPACE) as engine:
        engine.set_efforts("e", {"cabin": 3.0})
        engine.advance(3000)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(0.03, rel=0.03)


def test_motors_and_efforts_take_each_others_place(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(), world=SPACE) as engine:
        engine.set_efforts("e", {"bar": 2.0})
        engine.drive("e", {"bar": Motor(0.5, 1000.0)})
        engine.advance(200)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(0.5, rel=0.01)
        engine.set_efforts("e", {"bar": 1.0})
        engine.advance(100)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(
            0.5 + 0.1 / BAR_MOMENT, rel=0.03
        )
        engine.drive("e", {"bar": Motor(0.0, 1000.0)})
        engine.advance(200)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(0.0, abs=1e-3)


def test_efforts_of_motors_are_what_they_give(new_engine: NewEngine) -> None:
    """A bar that is held out: its weight times its lever, against gravity."""
    with spawned(new_engine, pendulum()) as engine:
        assert engine.joint_efforts("e") == {"bar": 0.0}
        engine.drive("e", {"bar": Motor(0.0, 100.0)})
        engine.advance(300)
        assert engine.joint_positions("e")["bar"] == pytest.approx(0.0, abs=0.01)
        # About +y, gravity turns it by +HELD.
        assert engine.joint_efforts("e")["bar"] == pytest.approx(-HELD, rel=0.03)
        engine.release("e")
        engine.advance(10)
        assert engine.joint_efforts("e") == {"bar": 0.0}
    with spawned(new_engine, pendulum()) as engine:
        engine.drive("e", {"bar": Motor(0.0, 2.0)})
        engine.advance(50)
        assert engine.joint_efforts("e")["bar"] == pytest.approx(-2.0, rel=0.03)


def test_a_held_joint_gives_way_to_an_effort(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(is_held=True)) as engine:
        engine.advance(100)
        assert engine.joint_positions("e")["bar"] == pytest.approx(0.0, abs=1e-3)
        engine.set_efforts("e", {"bar": 0.0})
        engine.advance(100)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(
            0.1 * HELD / BAR_MOMENT, rel=0.05
        )
        engine.release("e")
        engine.advance(200)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(0.0, abs=1e-3)


def test_efforts_meet_friction_and_stiff_dampers(new_engine: NewEngine) -> None:
    with spawned(new_engine, lift(friction=1.0), world=SPACE) as engine:
        engine.set_efforts("e", {"cabin": 0.9})
        engine.advance(100)
        assert engine.joint_velocities("e")["cabin"] == pytest.approx(0.0, abs=1e-3)
        engine.set_efforts("e", {"cabin": 3.0})
        engine.advance(100)
        assert engine.joint_velocities("e")["cabin"] == pytest.approx(0.2, rel=0.05)
    with spawned(new_engine, lift(damping=5000.0), world=SPACE) as engine:
        engine.set_efforts("e", {"cabin": 100.0})
        engine.advance(1000)
        assert engine.joint_positions("e")["cabin"] == pytest.approx(0.02, rel=0.1)
        assert engine.joint_efforts("e") == {"cabin": 100.0}


def test_other_robots_keep_what_they_have(new_engine: NewEngine) -> None:
    other = SpawnedRobot(entity="o", robot=pendulum(), pose_in_world=Pose((0.0, 3.0, 0.0)))
    with spawned(new_engine, pendulum(), IDENTITY, other, world=SPACE) as engine:
        engine.set_efforts("e", {"bar": 2.0})
        engine.advance(100)
        assert engine.joint_velocities("o")["bar"] == pytest.approx(0.0, abs=1e-6)
        assert engine.joint_efforts("o") == {"bar": 0.0}


def test_a_removed_robot_leaves_the_others_as_they_are(
    new_engine: NewEngine, tmp_path: Path
) -> None:
    box = single(body(Box(size=(0.4, 0.4, 0.4))))
    wall = replace(single(body(cube_mesh(tmp_path), moment=1.0)), is_static=True)
    engine = new_engine(GROUND)
    for entity, robot, x in (("a", box, 0.0), ("wall", wall, 4.0), ("b", box, 2.0)):
        engine.spawn(SpawnedRobot(entity=entity, robot=robot, pose_in_world=Pose((x, 0.0, 1.0))))
    engine.push("a", "base", (1.0, 0.0, 0.0))
    engine.advance(100)
    before = engine.state("b")
    engine.remove("a")
    engine.remove("wall")
    after = engine.state("b")
    assert after.xyz == pytest.approx(before.xyz, abs=1e-9)
    assert after.speed == pytest.approx(before.speed, abs=1e-9)
    assert range_along(engine, (0.0, 0.0, 1.0), (0.0, 0.0, 0.3)) == math.inf
    # The name is free again, and what bears it is touched and seen.
    below = Pose((2.0, 0.0, 0.2))
    engine.spawn(SpawnedRobot(entity="a", robot=box, pose_in_world=below))
    engine.advance(900)
    assert engine.state("b").xyz[2] == pytest.approx(0.6, abs=0.01)
    engine.close()


def test_a_robot_takes_a_velocity_as_that_of_its_frame(new_engine: NewEngine) -> None:
    box = single(body(Box(size=(0.4, 0.4, 0.4)), at=Pose((0.3, 0.0, 0.1))))
    with spawned(
        new_engine, box, Pose((0.0, 0.0, 5.0), (0.0, 0.0, math.pi / 2)), world=SPACE
    ) as engine:
        engine.set_velocity("e", (0.5, 0.2, 0.0), (0.0, 0.1, 1.0))
        ((linear, angular),) = engine.link_velocities("e").values()
        assert linear == pytest.approx((0.5, 0.2, 0.0), abs=1e-9)
        assert angular == pytest.approx((0.0, 0.1, 1.0), abs=1e-9)


def test_joints_are_put_somewhere_at_rest(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(), world=SPACE) as engine:
        engine.drive("e", {"bar": Motor(1.0, 100.0)})
        engine.advance(100)
        engine.set_joint_positions("e", {"bar": 0.7})
        assert engine.joint_positions("e")["bar"] == pytest.approx(0.7, abs=1e-9)
        assert engine.joint_velocities("e")["bar"] == pytest.approx(0.0, abs=1e-9)
        assert engine.link_poses("e")["bar"].rpy == pytest.approx((0.0, 0.7, 0.0), abs=1e-6)
        engine.advance(100)  # the motor goes on
        assert engine.joint_positions("e")["bar"] == pytest.approx(0.8, abs=5e-3)


@pytest.mark.parametrize(
    "geometry",
    [Box(size=(0.2, 0.2, 0.2)), Cylinder(radius=0.1, length=0.2), Sphere(radius=0.1)],
)
def test_rays_do_not_see_what_they_begin_in(new_engine: NewEngine, geometry: Geometry) -> None:
    """A lidar in its housing, which is in another one, sees the wall."""
    around = Collision(geometry=Box(size=(0.5, 0.5, 0.5)), pose_in_link=IDENTITY)
    housing = body(geometry)
    housing = replace(housing, collisions=(*housing.collisions, around))
    wall = SpawnedRobot(
        entity="wall",
        robot=single(body(Box(size=(1.0, 2.0, 2.0)))),
        pose_in_world=Pose((3.0, 0.0, 1.0)),
    )
    with spawned(new_engine, single(housing), Pose((0.0, 0.0, 1.0)), wall) as engine:
        for start in ((0.0, 0.0, 1.0), (0.05, 0.02, 1.01)):
            end = (10.0, start[1], start[2])
            assert range_along(engine, start, end) == pytest.approx(2.5 - start[0], abs=3e-3)
            assert range_along(engine, start, (-10.0, 0.0, 1.0)) == math.inf


def test_rays_leave_spheres_that_are_in_each_other(new_engine: NewEngine) -> None:
    """They go towards the centers, begin off them, and see what is outside."""
    ball = body(Sphere(radius=0.3), at=Pose((0.1, 0.0, 0.0)))
    inner = Collision(geometry=Sphere(radius=0.2), pose_in_link=Pose((0.05, 0.0, 0.0)))
    ball = replace(ball, collisions=(*ball.collisions, inner))
    wall = SpawnedRobot(
        entity="wall",
        robot=single(body(Box(size=(1.0, 2.0, 2.0)))),
        pose_in_world=Pose((3.0, 0.0, 1.0)),
    )
    with spawned(new_engine, single(ball), Pose((0.0, 0.0, 1.0)), wall) as engine:
        assert range_along(engine, (-0.1, 0.05, 1.0), (10.0, 0.05, 1.0)) == pytest.approx(
            2.6, abs=3e-3
        )
        assert range_along(engine, (0.2, 0.0, 1.0), (-10.0, 0.0, 1.0)) == math.inf
        assert range_along(engine, (0.0, 0.1, 1.1), (0.1, 0.0, 1.0)) == math.inf  # ends inside
        # From outside they are seen.
        assert range_along(engine, (-2.0, 0.0, 1.0), (2.0, 0.0, 1.0)) == pytest.approx(
            1.8, abs=3e-3
        )

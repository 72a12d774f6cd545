"""What every engine must know of where things are."""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import (
    CYLINDER,
    GROUND,
    PLATE,
    SPACE,
    NewEngine,
    body,
    cube_mesh,
    joint,
    run_of,
    shape,
    single,
    spawned,
    tree,
)
from wsgen.model.robot import Box, Capsule, Cylinder, Geometry, JointType, Link, Mesh, Sphere
from wsgen.model.transform import Pose, compose
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.world import World


TILTED = Pose((0.3, -0.2, 1.0), (0.4, 0.7, 0.2))
# How far each reaches down from its frame, tilted so: by hand, from the third row of the rotation.
DOWN_X, DOWN_Y, DOWN_Z = (
    math.sin(0.7),
    math.cos(0.7) * math.sin(0.4),
    math.cos(0.7) * math.cos(0.4),
)


@pytest.mark.parametrize("world", [GROUND, SPACE])
@pytest.mark.parametrize(
    ("geometry", "reach"),
    [
        (Box(size=(0.2, 0.4, 0.6)), 0.1 * DOWN_X + 0.2 * DOWN_Y + 0.3 * DOWN_Z),
        (Sphere(radius=0.3), 0.3),
        (Capsule(radius=0.1, length=0.5), 0.1 + 0.25 * DOWN_Z),
        (
            Cylinder(radius=0.2, length=0.5),
            0.25 * DOWN_Z + 0.2 * math.hypot(DOWN_X, DOWN_Y),
        ),
    ],
)
def test_the_lowest_point(
    new_engine: NewEngine, world: World, geometry: Geometry, reach: float
) -> None:
    """Over, in and without the ground; of the link's frame and of a shape that is turned in it."""
    # PyBullet rounds edges by 1 mm; without a ground, it has boxes alone.
    exact = 1e-3 if world is GROUND else 0.2
    for z in (1.0, 0.2):
        pose = replace(TILTED, xyz=(0.3, -0.2, z))
        with spawned(new_engine, single(body(geometry)), pose, world=world) as engine:
            assert engine.lowest_point("e") == pytest.approx(z - reach, abs=exact)
        with spawned(
            new_engine,
            single(body(geometry, at=Pose((0, 0, z), TILTED.rpy))),
            world=world,
        ) as engine:
            assert engine.lowest_point("e") == pytest.approx(z - reach, abs=exact)


def test_the_lowest_point_of_a_mesh(new_engine: NewEngine, tmp_path: Path) -> None:
    mesh = replace(cube_mesh(tmp_path), scale=(0.1, 0.2, 0.3))
    reach = 0.1 * DOWN_X + 0.2 * DOWN_Y + 0.3 * DOWN_Z
    for z in (20.0, 1.0, 0.2):
        pose = replace(TILTED, xyz=(0.3, -0.2, z))
        with spawned(new_engine, single(body(mesh)), pose, world=GROUND) as engine:
            assert engine.lowest_point("e") == pytest.approx(z - reach, abs=1.1e-3)


def test_the_lowest_point_is_that_of_the_lowest_link(new_engine: NewEngine) -> None:
    leg = joint("base", "leg", JointType.CONTINUOUS, Pose((0.5, 0.0, -0.3), (0.0, 1.0, 0.0)))
    robot = tree(body(PLATE), (leg, body(Sphere(radius=0.1), name="leg", at=Pose((0.2, 0.0, 0.0)))))
    with spawned(new_engine, robot, Pose((0.0, 0.0, 2.0)), world=GROUND) as engine:
        expected = 2.0 - 0.3 - 0.2 * math.sin(1.0) - 0.1
        assert engine.lowest_point("e") == pytest.approx(expected, abs=1e-6)
        engine.place("e", Pose((0.0, 0.0, 5.0)))
        assert engine.lowest_point("e") == pytest.approx(expected + 3.0, abs=1e-6)


def test_a_robot_without_shapes_is_where_its_root_is(new_engine: NewEngine) -> None:
    with spawned(new_engine, single(body(None)), Pose((1.0, 2.0, 3.0)), world=GROUND) as engine:
        assert engine.lowest_point("e") == 3.0
        assert engine.corners("e") == [(1.0, 2.0, 3.0)]


def test_the_corners_are_around_all_shapes(new_engine: NewEngine) -> None:
    arm = joint("base", "arm", JointType.CONTINUOUS, Pose((1.0, 0.0, 0.0)))
    robot = tree(body(Box(size=(0.4, 0.2, 0.6))), (arm, body(Sphere(radius=0.1), name="arm")))
    with spawned(new_engine, robot, Pose((0.0, 0.0, 2.0), (0.0, 0.0, math.pi / 2))) as engine:
        for shift in (0.0, 3.0):
            engine.place("e", Pose((shift, 0.0, 2.0), (0.0, 0.0, math.pi / 2)))
            xs, ys, zs = zip(*engine.corners("e"), strict=True)
            low = (min(xs), min(ys), min(zs))
            high = (max(xs), max(ys), max(zs))
            assert low == pytest.approx((shift - 0.1, -0.2, 1.7), abs=0.01)
            assert high == pytest.approx((shift + 0.1, 1.1, 2.3), abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("geometry", [PLATE, CYLINDER])
def test_what_is_to_stand_on_the_ground_is_put_there(
    new_engine: NewEngine, geometry: Geometry
) -> None:
    for z in (-3.0, 0.0, 7.0):
        robot_run = run_of(new_engine, single(body(geometry)), z, on_the_ground=True)
        assert robot_run.lowest_point == pytest.approx(0.005, abs=1e-6)
        assert robot_run.penetration == 0.0
        assert robot_run.settled_after is not None


def test_placed_robots_are_at_rest_and_whole(new_engine: NewEngine) -> None:
    """A robot of two trees that has fallen apart is put together again."""
    off = joint("base", "box", JointType.FLOATING, Pose((2.0, 0.0, 0.5), (0.0, 0.0, 0.3)))
    robot = replace(tree(body(PLATE), (off, body(PLATE, name="box"))), joints=(), loose=(off,))
    there = Pose((1.0, 1.0, 4.0), (0.1, 0.2, 0.3))
    with spawned(new_engine, robot, Pose((0.0, 0.0, 1.0), (0.3, 0.0, 0.0)), world=GROUND) as engine:
        engine.advance(400)
        engine.place("e", there)
        poses = engine.link_poses("e")
        assert poses["base"].xyz == pytest.approx(there.xyz)
        assert poses["box"].xyz == pytest.approx(compose(there, off.pose_in_parent).xyz)
        assert poses["box"].rpy == pytest.approx(compose(there, off.pose_in_parent).rpy)
        assert (engine.state("e").speed, engine.state("e").turning) == (0.0, 0.0)
        before = engine.energy("e")
        engine.advance(300)
        assert engine.energy("e") == pytest.approx(before, rel=1e-3)


def test_a_robot_that_is_placed_in_the_ground_later_is_not_shot_out(new_engine: NewEngine) -> None:
    with spawned(new_engine, single(body(PLATE)), Pose((0.0, 0.0, 0.05)), world=GROUND) as engine:
        engine.advance(500)
        engine.place("e", Pose((0.0, 0.0, -0.04)))
        highest = 0.0
        for _ in range(50):
            engine.advance(20)
            highest = max(highest, engine.state("e").xyz[2])
        assert highest < 0.06


def test_each_world_is_its_own(new_engine: NewEngine) -> None:
    """Two engines at once do not share robots, gravity or ground."""
    robot = SpawnedRobot(entity="e", robot=single(body(PLATE)), pose_in_world=Pose((0, 0, 1.0)))
    with closing(new_engine(GROUND)) as first, closing(new_engine(SPACE)) as second:
        first.spawn(robot)
        second.spawn(robot)
        first.advance(100)
        second.advance(100)
        assert second.state("e").xyz[2] == 1.0
        assert first.state("e").xyz[2] < 0.96


def test_meshes_without_a_file_have_no_place(new_engine: NewEngine) -> None:
    link = Link(
        name="base", inertial=body(None).inertial, collisions=(shape(Mesh(uri="gone.stl")),)
    )
    with spawned(new_engine, single(link), Pose((0.0, 0.0, 0.5)), world=GROUND) as engine:
        assert engine.lowest_point("e") == 0.5

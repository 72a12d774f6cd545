"""What every engine must do where things touch, and where they are."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import pytest

from simulation.robots import (
    CYLINDER,
    GROUND,
    PLATE,
    SPACE,
    G,
    NewEngine,
    body,
    cube_mesh,
    joint,
    lattice,
    run_of,
    shape,
    single,
    slope,
    spawned,
    tree,
)
from wsgen.model.robot import Box, Cylinder, JointType, Robot
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation import contact_shapes
from wsgen.simulation.engine import Engine, Overlap
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path


SLOPE = slope(20.0)


@pytest.mark.slow
@pytest.mark.parametrize("is_mesh", [True, False])
@pytest.mark.parametrize("mu", [0.2, 1.0])
def test_a_rover_with_a_flat_bottom_stays_where_it_lands(
    new_engine: NewEngine, tmp_path: Path, mu: float, *, is_mesh: bool
) -> None:
    mesh = replace(cube_mesh(tmp_path), scale=(0.2, 0.15, 0.05))
    base = body(mesh if is_mesh else Box(size=(0.4, 0.3, 0.1)), mass=5.0, moment=0.05, mu=mu)
    wheels = [
        (
            joint("base", name, JointType.CONTINUOUS, Pose((-0.1, y, 0.0), (math.pi / 2, 0, 0))),
            body(Cylinder(radius=0.05, length=0.03), name=name, mass=0.5, mu=mu),
        )
        for name, y in (("left", 0.17), ("right", -0.17))
    ]
    x, y, z = run_of(new_engine, tree(base, *wheels), 0.1).rest_pose.xyz
    assert math.hypot(x, y) < 0.001
    assert z == pytest.approx(0.05, abs=0.0001)


def sliding(friction: float, degrees: float = 20.0) -> float:
    """The acceleration down a slope, m/s²."""
    angle = math.radians(degrees)
    return G * (math.sin(angle) - friction * math.cos(angle))


def test_friction_is_that_of_the_link(new_engine: NewEngine) -> None:
    slides = run_of(new_engine, single(body(PLATE, mu=0.2)), 0.05, world=SLOPE, seconds=1.0)
    holds = run_of(new_engine, single(body(PLATE, mu=0.9)), 0.05, world=SLOPE, seconds=1.0)
    assert slides.speed == pytest.approx(sliding(0.2), rel=0.05)
    assert holds.speed < 0.01


def test_friction_of_the_ground_is_no_more_than_that_of_gazebos(new_engine: NewEngine) -> None:
    steep = slope(50.0)
    robot_run = run_of(new_engine, single(body(PLATE, mu=50.0)), 0.05, world=steep, seconds=0.5)
    assert robot_run.speed == pytest.approx(sliding(1.0, 50.0) * 0.5, rel=0.05)


def cart(front: float, rear: float) -> Robot:
    """A box in the air on two feet that are fixed to it: neither is the root."""
    foot = Box(size=(0.1, 0.6, 0.1))
    feet = [
        (
            joint("base", name, JointType.FIXED, Pose((x, 0.0, -0.1))),
            body(foot, name=name, mu=mu),
        )
        for name, x, mu in (("front", 0.4, front), ("rear", -0.4, rear))
    ]
    return tree(body(Box(size=(1.0, 0.4, 0.05)), mass=2.0), *feet)


@pytest.mark.parametrize(
    ("front", "rear", "slips"), [(0.1, 0.1, True), (0.9, 0.9, False), (0.1, 0.9, False)]
)
def test_friction_of_a_link_that_is_not_the_root(
    new_engine: NewEngine, front: float, rear: float, *, slips: bool
) -> None:
    with spawned(
        new_engine, cart(front, rear), Pose((0.0, 0.0, 0.15)), world=slope(15.0)
    ) as engine:
        engine.advance(1000)
        speed = engine.state("e").speed
        assert speed == pytest.approx(sliding(0.1, 15.0), rel=0.05) if slips else speed < 0.01


def lumped_caster(first: float, second: float) -> Robot:
    """A chassis with a rear foot of one friction and a front foot of another, all one link."""
    foot = Box(size=(0.1, 0.4, 0.1))
    chassis = body(Box(size=(1.0, 0.4, 0.05)), mass=2.0)
    feet = (
        shape(foot, mu=first, at=Pose((-0.4, 0.0, -0.07))),
        shape(foot, mu=second, at=Pose((0.4, 0.0, -0.07))),
    )
    return single(replace(chassis, collisions=feet))


@pytest.mark.parametrize("frictions", [(0.0, 0.8), (0.8, 0.0)])
def test_friction_is_that_of_the_collision(
    new_engine: NewEngine, frictions: tuple[float, float]
) -> None:
    """Half of the weight stands on each: together they hold at 15 degrees, the caster does not."""
    world = slope(15.0)
    holds = run_of(new_engine, lumped_caster(*frictions), 0.13, world=world, seconds=1.0)
    assert holds.speed < 0.01
    slides = run_of(new_engine, lumped_caster(0.0, 0.0), 0.13, world=world, seconds=1.0)
    assert slides.speed == pytest.approx(sliding(0.0, 15.0), rel=0.05)
    # The mean of both: on one level with the center of mass they would carry the same.
    world = slope(25.0)
    some = run_of(new_engine, lumped_caster(0.2, 0.4), 0.13, world=world, seconds=1.0)
    assert sliding(0.4, 25.0) < some.speed < sliding(0.2, 25.0)


def test_a_wheel_rolls_down_and_stands_on_even_ground(new_engine: NewEngine) -> None:
    lying = Pose(rpy=(math.pi / 2, 0.0, 0.0))
    wheel = single(body(Cylinder(radius=0.1, length=0.05), at=lying))
    rolls = run_of(new_engine, wheel, 0.1, world=slope(5.0), seconds=1.0)
    # A filled cylinder that rolls has two thirds of what one that slides would have.
    assert rolls.speed == pytest.approx(sliding(0.0, 5.0) * 2 / 3, rel=0.05)
    stands = run_of(new_engine, wheel, 0.1)
    assert stands.settled_after is not None
    assert math.hypot(*stands.rest_pose.xyz[:2]) < 0.005


def two_in_one(depth: float, *, collide: bool, kind: JointType = JointType.FIXED) -> Robot:
    """Two cubes on two joints at the base, one `depth` in the other, the base beside them."""
    cube = Box(size=(0.2, 0.2, 0.2))
    children = [
        (
            joint("base", name, kind, Pose((x, 0.0, 0.0)), axis_in_joint=(1.0, 0.0, 0.0)),
            replace(body(cube, name=name), self_collide=collide),
        )
        for name, x in (("a", 1.0), ("b", 1.2 - depth))
    ]
    return tree(replace(body(cube), self_collide=collide), *children)


def pairs(engine: Engine) -> dict[frozenset[tuple[str, str]], float]:
    return {
        frozenset(((found.entity, found.link), (found.other_entity, found.other_link))): found.depth
        for found in engine.overlaps()
    }


@pytest.mark.parametrize("collide", [False, True])
def test_links_in_each_other_are_reported_with_their_depth(
    new_engine: NewEngine, *, collide: bool
) -> None:
    with spawned(new_engine, two_in_one(0.05, collide=collide)) as engine:
        found = pairs(engine)
        assert list(found) == [frozenset((("e", "a"), ("e", "b")))]
        assert found[frozenset((("e", "a"), ("e", "b")))] == pytest.approx(0.05, abs=0.002)


def test_links_that_only_touch_are_no_overlap(new_engine: NewEngine) -> None:
    for depth in (-0.01, 0.0):
        with spawned(new_engine, two_in_one(depth, collide=True)) as engine:
            assert engine.overlaps() == []


def test_neighbors_may_be_in_each_other(new_engine: NewEngine) -> None:
    inside = joint("base", "a", JointType.CONTINUOUS, Pose((0.1, 0.0, 0.0)))
    robot = tree(body(PLATE), (inside, body(PLATE, name="a")))
    with spawned(new_engine, robot) as engine:
        assert engine.overlaps() == []


def test_shapes_of_one_link_may_be_in_each_other(new_engine: NewEngine) -> None:
    """Also those of another friction, which are another link for PyBullet."""
    link = replace(body(PLATE), collisions=(shape(PLATE), shape(CYLINDER, mu=0.1)))
    with spawned(new_engine, single(link)) as engine:
        assert engine.overlaps() == []


def test_the_link_of_a_slippery_part_is_reported(new_engine: NewEngine) -> None:
    """By the name of the description, not of a helper."""
    robot = two_in_one(0.05, collide=True)
    cube = robot.links[1].collisions[0]
    far = replace(cube, pose_in_link=Pose((5.0, 0.0, 0.0)))
    slippery = replace(cube, surface=replace(cube.surface, mu1=0.1, mu2=0.1))
    links = (robot.links[0], replace(robot.links[1], collisions=(far, slippery)), robot.links[2])
    with spawned(new_engine, replace(robot, links=links)) as engine:
        assert set(pairs(engine)) == {frozenset((("e", "a"), ("e", "b")))}
        assert set(engine.link_poses("e")) == {"base", "a", "b"}


def test_robots_in_each_other_are_reported(new_engine: NewEngine) -> None:
    other = SpawnedRobot(
        entity="f", robot=single(body(PLATE, name="plate")), pose_in_world=Pose((0.37, 0.0, 0.0))
    )
    away = SpawnedRobot(entity="g", robot=single(body(PLATE)), pose_in_world=Pose((3.0, 0.0, 0.0)))
    with spawned(new_engine, single(body(PLATE)), IDENTITY, other, away) as engine:
        found = engine.overlaps()
        assert all(isinstance(one, Overlap) for one in found)
        assert pairs(engine) == {
            frozenset((("e", "base"), ("f", "plate"))): pytest.approx(0.03, abs=0.002)
        }
        engine.place("f", Pose((1.0, 0.0, 0.0)))
        assert engine.overlaps() == []


def test_the_ground_is_no_link(new_engine: NewEngine) -> None:
    with spawned(new_engine, single(body(PLATE)), world=GROUND) as engine:
        assert engine.overlaps() == []


def test_only_what_is_asked_to_collides_with_itself(new_engine: NewEngine) -> None:
    """Two cubes on slides, one in the other, in space: they are pushed apart or not."""
    moved = {}
    for collide in (True, False):
        robot = two_in_one(0.05, collide=collide, kind=JointType.PRISMATIC)
        robot = replace(robot, joints=tuple(replace(one, damping=1.0) for one in robot.joints))
        with spawned(new_engine, robot, world=SPACE) as engine:
            engine.advance(2000)
            positions = engine.joint_positions("e")
            moved[collide] = positions["b"] - positions["a"]
    assert moved[True] > 0.0015  # DART takes its time, with 1 mm/s
    assert moved[False] == pytest.approx(0.0, abs=1e-9)


def test_one_of_two_links_with_the_flag_is_not_enough(new_engine: NewEngine) -> None:
    """And the pairs without it stay as they are."""
    both = two_in_one(0.05, collide=False, kind=JointType.PRISMATIC)
    joints = tuple(replace(one, damping=1.0) for one in both.joints)
    moved = {}
    for flagged in (("base", "a"), ("a", "b")):
        links = tuple(replace(link, self_collide=link.name in flagged) for link in both.links)
        with spawned(new_engine, replace(both, links=links, joints=joints), world=SPACE) as engine:
            engine.advance(2000)
            positions = engine.joint_positions("e")
            moved[flagged] = positions["b"] - positions["a"]
    assert moved["a", "b"] > 0.0015
    assert moved["base", "a"] == pytest.approx(0.0, abs=1e-9)


def test_neighbors_do_not_collide_with_each_other(new_engine: NewEngine) -> None:
    slide = joint("base", "a", JointType.PRISMATIC, Pose((0.1, 0.0, 0.0)), axis_in_joint=(1, 0, 0))
    links = [replace(body(PLATE, name=name), self_collide=True) for name in ("base", "a")]
    with spawned(new_engine, tree(links[0], (slide, links[1])), world=SPACE) as engine:
        engine.advance(500)
        assert engine.joint_positions("e")["a"] == pytest.approx(0.0, abs=1e-6)


def test_what_is_fixed_to_a_neighbor_is_no_neighbor(new_engine: NewEngine) -> None:
    """A cube on a slide is in one that is fixed to the slide's base."""
    cube = Box(size=(0.2, 0.2, 0.2))
    base, fixed, slides = (
        replace(body(cube, name=name), self_collide=True) for name in ("base", "fixed", "slides")
    )
    robot = tree(
        base,
        (joint("base", "fixed", JointType.FIXED, Pose((1.0, 0.0, 0.0))), fixed),
        (joint("base", "slides", JointType.PRISMATIC, Pose((1.15, 0.0, 0.0)), damping=1.0), slides),
    )
    with spawned(new_engine, robot, world=SPACE) as engine:
        engine.advance(2000)
        assert engine.joint_positions("e")["slides"] > 0.0015


FLAT = list(product(range(5), range(5), [0]))
RAISED = [(x, y, 1) for x, y, _ in FLAT if {x, y} & {0, 4}]  # a rim on it
WALL = list(product(range(10), [0], range(3)))


@pytest.mark.slow
@pytest.mark.parametrize("cells", [FLAT, FLAT + RAISED[:2], WALL])
def test_of_many_shapes_those_that_span_the_hull_hold_it_as_all_do(
    new_engine: NewEngine, monkeypatch: pytest.MonkeyPatch, cells: list[tuple[int, int, int]]
) -> None:
    robot = lattice(*cells)
    few = run_of(new_engine, robot, on_the_ground=True, seconds=0.4)
    monkeypatch.setattr(contact_shapes, "MOST_STANDING", len(cells))
    all_of_them = run_of(new_engine, robot, on_the_ground=True, seconds=0.4)
    assert few.mass == all_of_them.mass == 5.0
    assert few.rest_pose.xyz == pytest.approx(all_of_them.rest_pose.xyz, abs=1e-4)
    assert few.tilt == pytest.approx(all_of_them.tilt, abs=1e-3)
    assert few.lowest_point == all_of_them.lowest_point
    assert few.settled_after is not None


def test_a_block_of_many_shapes_slides_with_its_friction(new_engine: NewEngine) -> None:
    robot_run = run_of(new_engine, lattice(*FLAT, mu=0.2), 0.05, world=SLOPE, seconds=0.5)
    assert robot_run.speed == pytest.approx(sliding(0.2) * 0.5, rel=0.05)


@pytest.mark.slow
def test_inside_of_the_hull_other_robots_are_touched(new_engine: NewEngine) -> None:
    bowl, cube = lattice(*FLAT, *RAISED), single(body(Box(size=(0.1, 0.1, 0.1))))
    at = Pose((0.0, 0.0, 0.1505))  # in the bowl
    other = SpawnedRobot(entity="cube", robot=cube, pose_in_world=at)
    pose = Pose((0.0, 0.0, 0.1))
    with spawned(new_engine, bowl, pose, other, world=GROUND) as engine:
        assert engine.overlaps() == []
        engine.advance(100)
        assert engine.state("cube").xyz == pytest.approx((0.0, 0.0, 0.15), abs=5e-4)
        engine.place("cube", Pose((0.0, 0.0, 0.12)))
        (overlap,) = engine.overlaps()
    assert overlap.depth == pytest.approx(0.03, abs=2e-3)


@pytest.mark.slow
def test_a_thousand_boxes_do_not_take_long(new_engine: NewEngine) -> None:
    robot = lattice(*product(range(40), range(25), [0]))
    started = time.process_time()
    robot_run = run_of(new_engine, robot, on_the_ground=True, seconds=1.0)
    assert time.process_time() - started < 6  # 13 s and more where the ground touches all
    assert robot_run.rest_pose.xyz[2] == pytest.approx(0.05, abs=1e-4)


@pytest.mark.parametrize("count", [1, 2])
def test_parts_of_one_robot_with_frictions_of_their_own(new_engine: NewEngine, count: int) -> None:
    """Two loose plates on a slope of 60 degrees: with a friction of 1 one slides, with 3 it stands.

    The slope has more than both, as Gazebo Classic's ground plane.
    """
    off = joint("base", "other", JointType.FIXED, Pose((0.0, 2.0, 0.0)))
    plates = tree(body(PLATE), (off, body(PLATE, name="other", mu=3.0)))
    world = replace(slope(60.0), ground_friction=100.0)
    robots = [
        SpawnedRobot(
            entity=f"{number}",
            robot=replace(plates, joints=(), loose=(off,)),
            pose_in_world=Pose((0.0, 5.0 * number, 0.05)),
        )
        for number in range(1, count)
    ]
    robot = replace(plates, joints=(), loose=(off,))
    with spawned(new_engine, robot, Pose((0.0, 0.0, 0.05)), *robots, world=world) as engine:
        engine.advance(1000)
        for entity in ("e", *(one.entity for one in robots)):
            poses = engine.link_poses(entity)
            way = (math.sin(math.radians(60)) - math.cos(math.radians(60))) * G / 2
            assert poses["base"].xyz[0] == pytest.approx(way, rel=0.01)
            assert poses["other"].xyz[0] == pytest.approx(0.0, abs=0.01)

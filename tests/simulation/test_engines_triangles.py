"""Static models are collided as their triangles; shapes that no engine has, as meshes."""

from __future__ import annotations

import math
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from child_answers import answered
from simulation.robots import GROUND, VOID, ball_on_mesh, body, joint, single, spawned, tree
from wsgen.descriptions.meshes import shape_worker
from wsgen.descriptions.meshes.shape_meshes import build_shapes
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Geometry,
    Heightmap,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
)
from wsgen.model.transform import IDENTITY, Pose, rotation_of_quaternion
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.simulation.simulate import run_scene

if TYPE_CHECKING:
    from pathlib import Path

    from simulation.robots import NewEngine
    from wsgen.isolation.result import Answered
    from wsgen.simulation.engine import State


MARGIN = 0.002  # m, of contacts
RADIUS = 0.1
BALL = single(body(Sphere(radius=RADIUS)))


def square(half: float) -> tuple[tuple[float, float], ...]:
    return ((-half, -half), (half, -half), (half, half), (-half, half))


WALLS = Extrusion(outlines=(square(1), square(0.8)), height=1)
FLOOR = Extrusion(outlines=(square(1),), height=0.2)


def static(*shapes: Geometry, at: Pose = IDENTITY) -> Robot:
    collisions = tuple(Collision(geometry=shape, pose_in_link=at) for shape in shapes)
    return replace(single(Link(name="static_models", collisions=collisions)), is_static=True)


def made(robot: Robot, folder: Path) -> Robot:
    def run(_: str, *arguments: Any, **__: Any) -> Answered:
        return answered(shape_worker.build(*arguments))

    new, found = build_shapes(robot, file=None, folder=folder, run=run)  # type: ignore[arg-type]
    assert found == ()
    return new


def rest(
    new_engine: NewEngine, static_models: Robot, robot: Robot, start: tuple[float, float, float]
) -> State:
    """Where a robot is that fell onto static models."""
    other = SpawnedRobot(entity="o", robot=robot, pose_in_world=Pose(start))
    with spawned(new_engine, static_models, IDENTITY, other, world=VOID) as engine:
        engine.advance(2000)
        return engine.state("o")


@pytest.mark.parametrize("x", [0.0, 0.3])
def test_a_ball_falls_into_a_room(new_engine: NewEngine, tmp_path: Path, x: float) -> None:
    room = made(static(WALLS, FLOOR), tmp_path)
    state = rest(new_engine, room, BALL, (x, 0.05, 1.5))
    assert state.xyz == pytest.approx((x, 0.05, 0.2 + RADIUS), abs=MARGIN)
    assert state.speed < 0.001


def test_a_room_of_several_links(new_engine: NewEngine, tmp_path: Path) -> None:
    floor = static(FLOOR)
    walls = Link(name="walls", collisions=(Collision(geometry=WALLS),))
    fixed = joint("static_models", "walls", JointType.FIXED, Pose((0.0, 0.0, 0.2)))
    room = made(replace(floor, links=(*floor.links, walls), joints=(fixed,)), tmp_path)
    state = rest(new_engine, room, BALL, (0.1, 0.05, 1.5))
    assert state.xyz[2] == pytest.approx(0.2 + RADIUS, abs=MARGIN)


@pytest.mark.slow
def test_a_ball_rests_on_the_rim(new_engine: NewEngine, tmp_path: Path) -> None:
    room = made(static(WALLS), tmp_path)
    box = single(body(Box(size=(0.3, 0.3, 0.2))))
    state = rest(new_engine, room, box, (0.9, 0.03, 1.15))
    assert state.xyz[2] == pytest.approx(1.1, abs=MARGIN)


@pytest.mark.slow
def test_what_moves_rests_on_an_extrusion(new_engine: NewEngine, tmp_path: Path) -> None:
    table = made(static(FLOOR, at=Pose((0.0, 0.0, 0.5))), tmp_path)
    state = rest(new_engine, table, single(body(Box(size=(0.4, 0.3, 0.2)))), (0.2, 0.1, 0.9))
    assert state.xyz == pytest.approx((0.2, 0.1, 0.8), abs=MARGIN)


@pytest.mark.slow
def test_an_extrusion_that_moves(new_engine: NewEngine, tmp_path: Path) -> None:
    cross = ((-1, -3), (1, -3), (1, -1), (3, -1), (3, 1), (1, 1), (1, 3), (-1, 3), (-1, 1), (-3, 1))
    shape = Extrusion(outlines=(tuple((x / 10, y / 10) for x, y in cross),), height=0.2)
    falling = made(single(body(shape, moment=0.02)), tmp_path)
    state = rest(new_engine, made(static(FLOOR), tmp_path), falling, (0.0, 0.0, 0.3))
    assert state.xyz[2] == pytest.approx(0.2, abs=MARGIN)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radii", "height"), [((0.3, 0.25, 0.1), 0.1), ((0.2, 0.2, 0.2), 0.2), ((0.1, 0.3, 0.05), 0.05)]
)
def test_an_ellipsoid_rests_at_its_small_radius(
    new_engine: NewEngine, tmp_path: Path, radii: tuple[float, float, float], height: float
) -> None:
    egg = made(single(body(Ellipsoid(radii=radii))), tmp_path)
    state = rest(new_engine, made(static(FLOOR), tmp_path), egg, (0.0, 0.0, 0.22 + height))
    assert state.xyz[2] == pytest.approx(0.2 + height, abs=MARGIN)


@pytest.mark.slow
def test_an_ellipsoid_falls_onto_its_broad_side(new_engine: NewEngine, tmp_path: Path) -> None:
    egg = made(single(body(Ellipsoid(radii=(0.3, 0.25, 0.1)), at=IDENTITY)), tmp_path)
    pose = Pose((0.0, 0.0, 0.5), (0.0, math.radians(50), 0.0))
    other = SpawnedRobot(entity="o", robot=egg, pose_in_world=pose)
    with spawned(new_engine, made(static(FLOOR), tmp_path), IDENTITY, other) as engine:
        engine.advance(10_000)
        state = engine.state("o")
    assert rotation_of_quaternion(state.xyzw)[2][2] == pytest.approx(1, abs=0.01)
    assert state.xyz[2] == pytest.approx(0.3, abs=0.005)


@pytest.fixture
def hills(tmp_path: Path) -> Robot:
    """Two terraces of 5 by 2 m, 1 m and 2 m high, beside a plain; a row of pixels is a meter."""
    pixels = np.zeros((11, 11), np.uint8)
    pixels[:5, :3] = 100  # the first rows are at the highest y
    pixels[:5, 8:] = 200
    file = tmp_path / "hills.png"
    Image.fromarray(pixels).save(file)
    return made(static(Heightmap(uri="hills.png", path=str(file), size=(11, 11, 2))), tmp_path)


@pytest.mark.parametrize(
    ("x", "y", "height"),
    [(-4.2, 3.3, 1), (4.2, 3.3, 2), (0, 0, 0), (-4.2, -3.3, 0), (4.2, -2.7, 0)],
)
def test_a_ball_rests_on_a_heightmap(
    new_engine: NewEngine, hills: Robot, x: float, y: float, height: float
) -> None:
    state = rest(new_engine, hills, BALL, (x, y, height + RADIUS + 0.05))
    assert state.xyz == pytest.approx((x, y, height + RADIUS), abs=MARGIN)


def test_a_ball_rolls_down_a_slope(new_engine: NewEngine, hills: Robot) -> None:
    """Nothing but its own rolling resistance slows it."""
    state = rest(new_engine, hills, BALL, (2.9, 3.3, 2.2))
    assert state.xyz[0] < 0
    assert state.speed > 3


@pytest.mark.slow
def test_half_a_million_triangles_load_within_seconds(
    new_engine: NewEngine, tmp_path: Path
) -> None:
    count = 501
    line = np.linspace(-5, 5, count)
    points = np.stack([*np.meshgrid(line, line), np.zeros((count, count))], axis=-1)
    points[..., 2] = np.sin(points[..., 0]) / 10
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    corners = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)])
    file = tmp_path / "large.stl"
    write_stl(corners.reshape(-1, 3, 3), file)
    # In a process of its own: what the engines took for it, they would keep for the other tests.
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        height, seconds = executor.submit(ball_on_mesh, new_engine, str(file)).result()
    assert seconds < 10
    assert height > 0.15


SUNK = 0.05  # m
AXLE = joint("base", "", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0))


@pytest.mark.slow
@pytest.mark.parametrize("is_mesh", [False, True])
def test_what_is_spawned_in_a_slab_is_not_thrown(
    new_engine: NewEngine, tmp_path: Path, *, is_mesh: bool
) -> None:
    """A cart on two wheels, in a slab and in one of a thousand triangles."""
    size = (1.0, 1.0, 0.5)
    slab: Geometry = Box(size=size)
    if is_mesh:
        fine = trimesh.creation.box(extents=size).subdivide().subdivide().subdivide()
        write_stl(fine.triangles, tmp_path / "slab.stl")
        slab = Mesh(uri="slab.stl", path=str(tmp_path / "slab.stl"))
    wheel = Cylinder(radius=0.1, length=0.04)
    across = Pose((0.0, 0.0, 0.0), (math.pi / 2, 0.0, 0.0))
    cart = tree(
        body(Box(size=(0.4, 0.3, 0.1)), at=Pose((0.0, 0.0, 0.05))),
        *(
            (replace(AXLE, name=side, child=side, pose_in_parent=Pose((0.0, y, 0.0))), rim)
            for side, y in (("left", 0.2), ("right", -0.2))
            for rim in [body(wheel, name=side, at=across)]
        ),
    )
    at = Pose((0.33, 0.0, 0.05))
    floor = SpawnedRobot(entity="floor", robot=static(slab), pose_in_world=at, is_static_model=True)
    start = 0.3 + 0.1 - SUNK
    robot = SpawnedRobot(
        entity="e", robot=cart, pose_in_world=Pose((0.0, 0.0, start), (0.0, 0.0, 1.02))
    )
    scene = Scene(world=GROUND, robots=(floor, robot), seconds=2.0)
    with closing(new_engine(GROUND)) as engine:
        (_, run), _ = run_scene(engine, scene, lambda _: None)
    assert run.highest_point < start + SUNK + 0.01
    assert run.highest_speed < 0.5

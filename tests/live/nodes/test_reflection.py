"""Intensities of lidars: of the shape that a ray hits, whatever the engine knows of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from live.nodes.sensor_texts import block, world_of
from wsgen.live.nodes.simulator.sensors.lidar_rays import Reflection
from wsgen.model.robot import Box, Capsule, Collision, Cylinder, Link, Mesh, Robot, Sphere, Visual
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Geometry

    Rays = tuple[tuple[float, float, float], ...]

# Two discs on each other: a ring of another reflection than what it surrounds.
RING = Link(
    name="link",
    collisions=(
        Collision(geometry=Cylinder(radius=1.03, length=0.002), laser_retro=200.0),
        Collision(geometry=Cylinder(radius=0.97, length=0.004)),
    ),
)
DOWN = (0.0, 0.0, -1.0)


def static(*links: Link, name: str = "it") -> SpawnedRobot:
    robot = Robot(name=name, root=links[0].name, links=links, is_static=True)
    return SpawnedRobot(entity=name, robot=robot)


def solid(geometry: Geometry, retro: float = 5.0) -> Link:
    return Link(name="link", collisions=(Collision(geometry=geometry, laser_retro=retro),))


def of(
    robot: SpawnedRobot,
    starts: Rays,
    way: tuple[float, float, float],
    lengths: list[float],
    *,
    is_gpu: bool = False,
    pose: Pose = IDENTITY,
) -> list[float]:
    """The intensities of rays that get so far, all with one direction."""
    begins = np.array(starts)
    ends = begins + 10.0 * np.array(way)
    reflection = Reflection([robot], is_gpu=is_gpu, has_ground=True)
    poses = {robot.entity: {"link": pose}}
    found: list[float]
    found = reflection.intensities(begins, ends, np.array(lengths) / 10.0, poses).tolist()
    return found


def test_a_line_on_the_ground_differs_from_what_is_beside_it() -> None:
    starts = tuple((x, 0.0, 0.1) for x in (0.9, 1.0, 1.1))
    assert of(static(RING), starts, DOWN, [0.098, 0.099, 0.1]) == [0.0, 200.0, 0.0]


def test_what_hits_nothing_has_no_intensity() -> None:
    starts = ((1.0, 0.0, 0.1), (0.0, 1.0, 5.0))
    assert of(static(RING), starts, DOWN, [math.inf, 2.0]) == [0.0, 0.0]


@pytest.mark.parametrize(
    ("geometry", "length"),
    [
        (Box(size=(0.4, 1.0, 1.0)), 1.8),
        (Sphere(radius=0.2), 1.8),
        (Cylinder(radius=0.2, length=1.0), 1.8),
        (Capsule(radius=0.2, length=1.0), 1.8),
    ],
)
def test_shapes_are_hit_where_they_are(geometry: Geometry, length: float) -> None:
    """From the side, above it, and what an engine finds in front of it or behind it."""
    way, robot = (1.0, 0.0, 0.0), static(solid(geometry))
    at = Pose((2.0, 0.0, 1.0))
    starts = ((0.0, 0.0, 1.0), (0.0, 0.0, 2.5), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    lengths = [length, length, length - 0.1, length + 0.1]
    assert of(robot, starts, way, lengths, pose=at) == [5.0, 0.0, 0.0, 0.0]
    # Turned, from above, where the engine finds it.
    turned, above = Pose((0.0, 0.0, 1.0), (0.3, 1.1, -0.4)), (0.05, 0.0, 5.0)
    with world_of(replace(robot, pose_in_world=turned), ground=False) as engine:
        (fraction,) = engine.cast_rays([above], [(0.05, 0.0, -5.0)])
    assert of(robot, (above,), DOWN, [10.0 * float(fraction)], pose=turned) == [5.0]


def test_the_triangles_of_a_mesh_and_the_hull_of_what_moves(tmp_path: Path) -> None:
    """Two plates of 1 m side by side: between them nothing is, but the hull of what moves."""
    file = tmp_path / "plates.obj"
    corners = [(x, y) for left in (0, 3) for x in (left, left + 1) for y in (0, 1)]
    lines = [f"v {x} {y} 0" for x, y in corners]
    lines += [f"f {n + a} {n + b} {n + c}" for n in (1, 5) for a, b, c in ((0, 2, 3), (0, 3, 1))]
    file.write_text("\n".join(lines), encoding="utf-8")
    plates = static(solid(Mesh(uri=str(file), path=str(file)), 7.0))
    starts = ((0.5, 0.4, 1.2), (2.0, 0.4, 1.2), (3.5, 0.4, 1.2))
    at = Pose((0.0, 0.0, 0.2))
    assert of(plates, starts, DOWN, [1.0] * 3, pose=at) == [7.0, 0.0, 7.0]
    moving = replace(plates, robot=replace(plates.robot, is_static=False))
    assert of(moving, starts, DOWN, [1.0] * 3, pose=at) == [7.0, 7.0, 7.0]


def test_a_mesh_that_cannot_be_read_does_not_reflect(tmp_path: Path) -> None:
    file = str(tmp_path / "none.obj")
    robot = static(solid(Mesh(uri=file, path=file)))
    assert of(robot, ((0.0, 0.0, 1.0),), DOWN, [0.5]) == [0.0]


def test_lidars_on_a_gpu_see_visuals() -> None:
    """A line on the ground that nothing can touch, no more than 2000, and nothing below it."""
    box = Box(size=(1.0, 1.0, 0.002))
    line = Link(
        name="link",
        visuals=(
            Visual(geometry=box, laser_retro=9000.0),
            Visual(geometry=box, pose_in_link=Pose((2.0, 0.0, 0.0)), laser_retro=-3.0),
            Visual(geometry=box, pose_in_link=Pose((4.0, 0.0, -0.01)), laser_retro=30.0),
        ),
        collisions=(Collision(geometry=box, laser_retro=50.0),),
    )
    starts = tuple((x, 0.0, 1.0) for x in (0.0, 2.0, 4.0))
    assert of(static(line), starts, DOWN, [1.0] * 3, is_gpu=True) == [2000.0, 0.0, 0.0]
    assert of(static(line), starts, DOWN, [0.999, 1.0, 1.0]) == [50.0, 0.0, 0.0]


def test_a_robot_without_a_finite_pose_is_not_looked_at() -> None:
    robot, nowhere = static(RING), Pose((math.nan, 0.0, 0.0))
    assert of(robot, ((1.0, 0.0, 1.0),), DOWN, [0.999], pose=nowhere) == [0.0]


def test_nothing_is_looked_at_where_nothing_reflects() -> None:
    assert Reflection([static(RING)], is_gpu=False).is_any
    assert not Reflection([static(RING)], is_gpu=True).is_any
    assert not Reflection([block("b", (1.0, 1.0, 1.0))], is_gpu=False).is_any

"""What the MuJoCo engine does in a way of its own; what all do is in `test_engines`."""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest

from simulation import movers
from simulation.robots import (
    GROUND,
    PLATE,
    VOID,
    G,
    body,
    run_of,
    shape,
    single,
    slope,
    spawned,
    tree,
)
from simulation.robots import joint as joint_of
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.model.robot import Box, JointType, Mesh, Sphere
from wsgen.model.transform import Pose
from wsgen.simulation.engine import Loaded, Refused
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Robot
    from wsgen.model.world import World

pytest.importorskip("mujoco")

from wsgen.simulation.mujoco import MujocoEngine
from wsgen.simulation.mujoco_contacts import cut


@pytest.mark.parametrize(("mu", "degrees"), [(1.0, 48.0), (1.0, 60.0), (0.3, 25.0), (0.0, 10.0)])
def test_what_slides_keeps_to_the_ground(mu: float, degrees: float) -> None:
    """By itself MuJoCo lets it hop, with another friction after each."""
    angle = math.radians(degrees)
    plate, at = single(body(PLATE, mu=mu)), Pose((0.0, 0.0, 0.05))
    with spawned(MujocoEngine, plate, at, world=slope(degrees)) as engine:
        highest = 0.0
        for _ in range(50):
            engine.advance(10)
            highest = max(highest, engine.state("e").xyz[2])
        expected = G * (math.sin(angle) - mu * math.cos(angle)) * 0.5
        assert engine.state("e").speed == pytest.approx(expected, rel=0.01, abs=0.005)
        assert highest < 0.0502


@pytest.mark.slow
def test_a_wide_wheel_turns_about_its_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(movers, "THIN", 0.04)
    turn = movers.drive(seconds=4.0, angular=1.0)
    (turned,) = movers.simulated(MujocoEngine, movers.two_wheeled(), turn)
    assert turned.moved[2] == pytest.approx(4.0, rel=0.02)


@pytest.mark.slow
def test_four_wheels_skid_as_far_as_with_gazebos_friction() -> None:
    """By Coulomb's law, 2.56 rad; with friction along two directions, as in DART and PyBullet."""
    x, radius = 0.15, movers.RADIUS
    two, wheels = movers.two_wheeled(), []
    for name, front in (("front", x), ("rear", -x)):
        for axle, wheel in zip(two.joints, two.links[1:], strict=True):
            side, at = axle.name, Pose((front, axle.pose_in_parent.xyz[1], 0.0))
            named = replace(axle, name=side + name, child=side + name, pose_in_parent=at)
            wheels.append((named, replace(wheel, name=side + name)))
    robot = tree(body(Box(size=(0.5, 0.3, 0.1)), mass=5.0), *wheels)
    pairs = tuple(
        replace(movers.PAIR, left=f"left{name}", right=f"right{name}") for name in ("front", "rear")
    )
    turn = movers.drive(seconds=4.0, using=replace(movers.DRIVE, pairs=pairs), angular=1.0)
    (turned,) = movers.simulated(MujocoEngine, robot, turn, at=Pose((0.0, 0.0, radius)))
    assert turned.moved[2] == pytest.approx(2.9, rel=0.02)


@pytest.mark.parametrize(
    "points",
    [
        [(0.0, 0.0, 0.0)] * 3,
        [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.2, 0.0, 0.0)],
        [(0.0, 0.0, 0.0), (0.1, 0.0, 0.05), (0.0, 0.1, 0.05)],
    ],
)
def test_meshes_without_a_volume(points: list[tuple[float, float, float]], tmp_path: Path) -> None:
    write_stl(np.array([points]), tmp_path / "flat.stl")
    flat = Mesh(uri="flat.stl", path=str(tmp_path / "flat.stl"))
    robot_run = run_of(MujocoEngine, single(body(flat, moment=0.01)), 0.1, seconds=1.0)
    assert robot_run.is_finite
    assert abs(robot_run.lowest_point_at_end) < 0.001


def test_a_mesh_at_no_place_is_refused(tmp_path: Path) -> None:
    write_stl(
        np.array([[(0.0, 0.0, math.nan), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0)]]), tmp_path / "m.stl"
    )
    mesh = Mesh(uri="m.stl", path=str(tmp_path / "m.stl"))
    with closing(MujocoEngine(GROUND)) as engine:
        refused = engine.spawn(SpawnedRobot(entity="e", robot=single(body(mesh, moment=1.0))))
    assert isinstance(refused, Refused)
    assert "m.stl" in refused.reason


def test_it_takes_more_links_than_pybullet() -> None:
    links = [body(None, name=f"l{number}") for number in range(200)]
    joints = [
        joint_of(one.name, other.name, JointType.CONTINUOUS) for one, other in pairwise(links)
    ]
    robot = tree(links[0], *zip(joints, links[1:], strict=True))
    with closing(MujocoEngine(GROUND)) as engine:
        loaded = engine.spawn(SpawnedRobot(entity="e", robot=robot))
    assert loaded == Loaded(200, 199, 200.0)


def test_what_moves_goes_on_when_another_robot_comes() -> None:
    falling = single(body(PLATE))
    with spawned(MujocoEngine, falling, Pose((0.0, 0.0, 2.0)), world=GROUND) as engine:
        engine.advance(100)
        before = engine.state("e")
        engine.spawn(SpawnedRobot(entity="f", robot=falling, pose_in_world=Pose((3.0, 0.0, 1.0))))
        assert engine.state("e") == before
        engine.advance(100)
        assert engine.state("e").speed == pytest.approx(G * 0.2, rel=1e-6)


def test_warnings_go_to_the_output_and_not_into_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with spawned(MujocoEngine, single(body(PLATE)), world=GROUND) as engine:
        engine.place("e", Pose((math.nan, 0.0, 1.0)))
        engine.advance(1)
        assert not math.isfinite(engine.state("e").xyz[0])
    assert "unstable" in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_triangles_are_cut_near_boxes_alone() -> None:
    large = np.array([[(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (-9.0, 9.0, 0.0)]])
    box = np.array([[(-1.0, -1.0, -1.0), (0.0, 0.0, 1.0)]])
    small = cut(large, box, 0.5)
    edges = np.linalg.norm(small - np.roll(small, 1, axis=1), axis=2)
    assert edges.max() <= 0.5
    assert (small.min(axis=1) <= box[0, 1]).all()
    assert (small.max(axis=1) >= box[0, 0]).all()
    inside = ((small.mean(axis=1) > box[0, 0]) & (small.mean(axis=1) < box[0, 1])).all(axis=1)
    assert inside.any()
    areas = (
        np.linalg.norm(np.cross(small[:, 1] - small[:, 0], small[:, 2] - small[:, 0]), axis=1) / 2
    )
    assert areas.sum() >= 1.0  # all of the box is covered
    assert len(cut(large, box + 100.0, 0.5)) == 0


def floor_of(
    folder: Path, *more: tuple[tuple[float, float, float], ...], half: float = 30.0
) -> Robot:
    """A static square in two triangles, at z = 0, and more triangles."""
    a, b, c, d = (-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)
    write_stl(np.array([(a, b, c), (a, c, d), *more], dtype=float), folder / "floor.stl")
    mesh = Mesh(uri="floor.stl", path=str(folder / "floor.stl"))
    return replace(single(body(mesh, mu=1.0)), is_static=True)


def over(floor: Robot, robot: Robot, z: float, world: World) -> MujocoEngine:
    engine = MujocoEngine(world)
    assert isinstance(engine.spawn(SpawnedRobot(entity="floor", robot=floor)), Loaded)
    at = Pose((0.0, 0.0, z))
    assert isinstance(engine.spawn(SpawnedRobot(entity="e", robot=robot, pose_in_world=at)), Loaded)
    return engine


@pytest.mark.parametrize("size", [(0.6, 0.6, 0.2), (0.3, 0.3, 0.1), (0.4, 0.2, 0.1)])
@pytest.mark.parametrize("mu", [0.1, 0.2])
def test_what_slides_on_triangles_has_its_friction(
    tmp_path: Path, size: tuple[float, float, float], mu: float
) -> None:
    """With MuJoCo's tolerance, some contacts press down what they should hold up."""
    degrees = 20.0
    angle = math.radians(degrees)
    world = replace(slope(degrees), has_ground_plane=False)
    plate = single(body(Box(size=size), mu=mu))
    engine = over(floor_of(tmp_path), plate, size[2] / 2 + 1e-4, world)
    engine.advance(500)
    expected = G * (math.sin(angle) - mu * math.cos(angle)) * 0.5
    assert engine.state("e").speed == pytest.approx(expected, rel=0.06)


def test_a_triangle_without_an_area_is_left_out(tmp_path: Path) -> None:
    floor = floor_of(tmp_path, ((0, 0, 0), (0, 0, 0), (1, 0, 0)))
    engine = over(floor, single(body(Sphere(radius=0.1))), 0.2, VOID)
    engine.advance(1000)
    assert engine.state("e").xyz[2] == pytest.approx(0.1, abs=0.001)


@pytest.mark.parametrize(("step", "height"), [(0.001, 60.0), (0.002, 60.0), (0.01, 3.13)])
def test_what_falls_fast_does_not_fall_through_triangles(
    tmp_path: Path, step: float, height: float
) -> None:
    floor = floor_of(tmp_path)
    engine = over(floor, single(body(Sphere(radius=0.1))), height, replace(VOID, step=step))
    engine.advance(round(4.0 / step))
    assert engine.state("e").xyz[2] > 0.05


def test_only_triangles_near_shapes_are_simulated(tmp_path: Path) -> None:
    """Not all between the ends of a long robot."""
    ends = [shape(Box(size=(0.1, 0.1, 0.1)), at=Pose((x, x, 0.05))) for x in (-10.0, 10.0)]
    crane = single(replace(body(None), collisions=tuple(ends)))
    engine = over(floor_of(tmp_path), crane, 0.001, VOID)
    engine.advance(10)
    assert 8 < sum(len(flex.elem) // 3 for flex in engine._spec.flexes) < 20_000

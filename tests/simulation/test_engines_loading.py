"""What every engine must make of a robot: all of it, or a refusal with the reason."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import (
    BAR,
    GROUND,
    PLATE,
    NewEngine,
    body,
    cube_mesh,
    joint,
    loaded,
    pendulum,
    run_of,
    shape,
    single,
    spawned,
    tree,
)
from wsgen.model.robot import JointType, Mesh, Robot
from wsgen.model.transform import Pose
from wsgen.simulation.engine import Loaded, Refused
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path


LYING = (0.0, math.pi / 2, 0.0)


@pytest.mark.slow
def test_a_mesh_is_stood_on(new_engine: NewEngine, tmp_path: Path) -> None:
    folder = tmp_path / "bits & pièces"
    folder.mkdir()
    for name in ("cube.obj", 'a "100%" cube.obj'):
        mesh = replace(cube_mesh(folder, name), scale=(0.1, 0.1, 0.2))
        robot_run = run_of(new_engine, single(body(mesh)), 0.21)
        assert robot_run.rest_pose.xyz[2] == pytest.approx(0.2, abs=0.001)
        assert robot_run.tilt < math.radians(0.1)


def test_what_is_counted(new_engine: NewEngine) -> None:
    robot = tree(
        body(PLATE, mass=2.0),
        (joint("base", "kept", JointType.FIXED), body(None, name="kept", mass=0.25)),
        (joint("base", "bar", JointType.CONTINUOUS), BAR),
    )
    assert loaded(new_engine, robot) == Loaded(3, 1, 3.25)
    # The world is no link of it.
    assert loaded(new_engine, pendulum()) == Loaded(1, 1, 1.0)


def test_nothing_is_left_of_the_robot(new_engine: NewEngine) -> None:
    refused = loaded(new_engine, Robot(name="r", root="a", links=()))
    assert refused == Refused("no link of it has mass")


def test_a_mesh_that_was_not_found_does_not_stop_the_rest(new_engine: NewEngine) -> None:
    robot = single(body(Mesh(uri="package://p/m.stl")))
    assert loaded(new_engine, robot) == Loaded(1, 0, 1.0)
    both = replace(body(PLATE), collisions=(shape(Mesh(uri="m.stl")), shape(PLATE)))
    robot_run = run_of(new_engine, single(both), 0.06)
    assert robot_run.rest_pose.xyz[2] == pytest.approx(0.05, abs=0.001)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("part.glb", b"glTF"),
        ("part.xyz", b"glTF"),
        ("part.stl", b"glTF"),
        ("part.stl", b""),
        ("part.stl", bytes(80) + b"\x10\0\0\0"),
        ("part.stl", b"solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n"),
        ("part.stl", b"solid part\nendsolid part\n"),
    ],
)
def test_a_mesh_that_cannot_be_read(
    new_engine: NewEngine, tmp_path: Path, name: str, content: bytes
) -> None:
    """Beside one that can be."""
    mesh = tmp_path / name
    mesh.write_bytes(content)
    link = body(Mesh(uri=name, path=str(mesh)))
    others = (shape(PLATE), shape(cube_mesh(tmp_path)))
    refused = loaded(new_engine, single(replace(link, collisions=(*link.collisions, *others))))
    assert isinstance(refused, Refused), refused


def test_a_refused_robot_leaves_nothing(new_engine: NewEngine, tmp_path: Path) -> None:
    """Neither itself nor the trees of it that were already in the world."""
    mesh = tmp_path / "part.glb"
    mesh.write_bytes(b"glTF")
    broken = body(Mesh(uri="part.glb", path=str(mesh)), name="broken")
    falls_off = joint("base", "broken", JointType.FLOATING, Pose((3.0, 0.0, 0.0)))
    robot = replace(
        tree(body(PLATE), (falls_off, broken)),
        joints=(),
        loose=(falls_off,),
    )
    engine = new_engine(GROUND)
    assert isinstance(engine.spawn(SpawnedRobot(entity="e", robot=robot)), Refused)
    above = SpawnedRobot(entity="e", robot=single(body(PLATE)), pose_in_world=Pose((0, 0, 0.06)))
    engine.spawn(above)
    assert engine.overlaps() == []
    engine.advance(500)
    assert engine.state("e").xyz[2] == pytest.approx(0.05, abs=0.001)
    engine.close()


@pytest.mark.parametrize("name", ['a<b>&"c', "größe 100%", "base surface 1", "a'b"])
def test_names_with_markup(new_engine: NewEngine, name: str) -> None:
    """Of a link with two frictions, which PyBullet needs another link for."""
    link = replace(body(PLATE, name=name), collisions=(shape(PLATE), shape(PLATE, mu=0.2)))
    robot = tree(link, (joint(name, "j", JointType.CONTINUOUS), replace(BAR, name="j")))
    assert loaded(new_engine, robot) == Loaded(2, 1, 2.0)
    with spawned(new_engine, robot) as engine:
        assert set(engine.link_poses("e")) == {name, "j"}

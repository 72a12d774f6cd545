"""What the PyBullet engine does in a way of its own; what all do is in `test_engines`."""

from __future__ import annotations

import tempfile
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import (
    BAR,
    CYLINDER,
    GROUND,
    PLATE,
    body,
    cube_mesh,
    joint,
    pendulum,
    run_of,
    shape,
    single,
    spawned,
    tree,
)
from wsgen.model.robot import MOST_LINKS, Capsule, Cylinder, Geometry, JointType, Robot, Sphere
from wsgen.model.transform import Pose
from wsgen.simulation.engine import Loaded, Refused
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("pybullet")

import pybullet

from wsgen.simulation.bullet import SEPARATION_SPEED, BulletEngine, Client
from wsgen.simulation.bullet_body import ROLLING_RESISTANCE, ROOT

# Where PyBullet's getDynamicsInfo has what.
FRICTION, ROLLING_FRICTION = 1, 6


@pytest.mark.parametrize("z", [0.0, -0.1, 0.2])
def test_half_sunk_is_pushed_out_without_a_jump(z: float) -> None:
    robot_run = run_of(BulletEngine, single(body(CYLINDER, moment=100.0)), z)
    assert robot_run.penetration == pytest.approx(0.25 - z, abs=1e-6)
    assert robot_run.highest_speed < 1.2 * SEPARATION_SPEED
    assert robot_run.highest_point < 0.26
    assert robot_run.lowest_point_at_end == pytest.approx(0.0, abs=0.001)


def test_deep_sunk_does_not_get_out_and_is_seen() -> None:
    robot_run = run_of(BulletEngine, single(body(CYLINDER)), -1.5)
    assert robot_run.penetration == pytest.approx(1.75, abs=1e-6)
    assert robot_run.lowest_point_at_end < -0.5
    assert robot_run.settled_after is None
    assert robot_run.is_finite


def test_more_links_than_the_engine_can_do() -> None:
    links = tuple(body(None, name=f"l{index}") for index in range(MOST_LINKS + 1))
    with closing(BulletEngine(GROUND)) as engine:
        robot = Robot(name="r", root="l0", links=links)
        refused = engine.spawn(SpawnedRobot(entity="e", robot=robot))
    assert isinstance(refused, Refused)
    assert "129 links" in refused.reason
    assert "pip install 'wsgen[mujoco]'" in refused.hint


def test_as_many_links_as_the_engine_can_do() -> None:
    chain = [
        (joint(f"l{n}", f"l{n + 1}", JointType.CONTINUOUS), body(None, name=f"l{n + 1}"))
        for n in range(MOST_LINKS - 1)
    ]
    with spawned(BulletEngine, tree(body(PLATE, name="l0"), *chain)) as engine:
        engine.advance(2)
        assert len(engine.joint_positions("e")) == MOST_LINKS - 1
        assert engine.energy("e") == pytest.approx(0.0, abs=0.1)


def properties(robot: Robot) -> dict[str, tuple[float, float]]:
    """Friction and rolling friction of every part, as PyBullet has them."""
    with closing(BulletEngine(GROUND)) as engine:
        assert isinstance(engine.spawn(SpawnedRobot(entity="e", robot=robot)), Loaded)
        ((loaded, _),) = engine._bodies["e"]
        client, number = engine.client, loaded.number
        names = {ROOT: robot.root} | {
            index: client.getJointInfo(number, index)[12].decode()
            for index in range(client.getNumJoints(number))
        }
        found = {name: client.getDynamicsInfo(number, index) for index, name in names.items()}
        return {name: (info[FRICTION], info[ROLLING_FRICTION]) for name, info in found.items()}


def test_every_link_has_its_own_properties(tmp_path: Path) -> None:
    """PyBullet takes some of them for the root's, whichever link is named."""
    wheels: dict[str, tuple[Geometry, float, float]] = {
        "cylinder": (Cylinder(radius=0.3, length=0.1), 0.3, 0.3),
        "sphere": (Sphere(radius=0.2), 0.7, 0.2),
        "capsule": (Capsule(radius=0.1, length=0.3), 2.0, 0.1),
        "box": (PLATE, 0.0, 0.0),
        # A flat wheel of 0.8 m; the box that PyBullet has around it is a little larger.
        "mesh": (replace(cube_mesh(tmp_path), scale=(0.4, 0.4, 0.05)), 0.5, 0.4),
    }
    parts = [
        (
            joint("base", name, JointType.CONTINUOUS, Pose((float(x), 0.0, 0.0))),
            body(geometry, name=name, mu=mu),
        )
        for x, (name, (geometry, mu, _)) in enumerate(wheels.items())
    ]
    found = properties(tree(body(PLATE, mu=0.45), *parts))
    assert found.pop("base") == (0.45, 0.0)
    for name, (_, mu, radius) in wheels.items():
        friction, rolling = found[name]
        assert friction == pytest.approx(min(mu, 1.0))
        assert rolling == pytest.approx(ROLLING_RESISTANCE * radius, rel=0.01)


def test_every_friction_of_a_link_is_there() -> None:
    shapes = (shape(PLATE, mu=0.9), shape(Sphere(radius=0.1), mu=0.01), shape(PLATE, mu=0.9))
    chassis = replace(body(PLATE), collisions=shapes)
    arm = replace(BAR, collisions=(shape(PLATE, mu=0.3), shape(PLATE, mu=0.6)))
    found = properties(tree(chassis, (joint("base", "bar", JointType.CONTINUOUS), arm)))
    assert found == {
        "base": (0.9, 0.0),
        "base surface 1": (0.01, pytest.approx(ROLLING_RESISTANCE * 0.1)),
        "bar": (0.3, 0.0),
        "bar surface 1": (0.6, 0.0),
    }


def test_what_it_was_loaded_from_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with spawned(BulletEngine, pendulum()) as engine:
        engine.advance(1)
    assert list(tmp_path.iterdir()) == []


def test_a_world_that_nobody_closes_is_given_back() -> None:
    """One that has been drawn holds 100 MB."""
    client = Client()
    number = client.number
    client.resetSimulation()
    del client
    again = Client()
    assert again.number == number
    again.close()
    again.close()


def test_what_other_code_puts_into_the_default_world_is_not_in_the_next_one() -> None:
    client = Client()
    number = client.number
    client.close()
    pybullet.createMultiBody(baseMass=1.0, physicsClientId=number)
    pybullet.setPhysicsEngineParameter(numSolverIterations=1, physicsClientId=number)
    with closing(Client()) as again:
        assert again.number == number
        assert again.getNumBodies() == 0
        assert again.getPhysicsEngineParameters()["numSolverIterations"] > 1

"""The engine of the other tests does what an engine must."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simulation.fake_engine import FakeEngine
from simulation.robots import pendulum
from wsgen.model.transform import Pose
from wsgen.simulation.engine import Engine, Loaded, Motor, Overlap, Refused, State
from wsgen.simulation.scene import SpawnedRobot


def sinking(seconds: float) -> State:
    return State((1.0, 2.0, 3.0 - seconds), (0.0, 0.0, 0.0, 1.0), 1.0, 0.0, 0.0)


def test_it_is_an_engine() -> None:
    engine: Engine = FakeEngine(sinking)  # what the type checker says counts here
    assert engine.spawn(SpawnedRobot(entity="e", robot=pendulum())) == Loaded(1, 1, 1.0)


def test_it_refuses_whom_it_is_asked_to() -> None:
    engine = FakeEngine(sinking, refuses=frozenset({"bad"}))
    assert isinstance(engine.spawn(SpawnedRobot(entity="bad", robot=pendulum())), Refused)
    assert isinstance(engine.spawn(SpawnedRobot(entity="good", robot=pendulum())), Loaded)


def test_it_plays_the_script() -> None:
    engine = FakeEngine(
        sinking, step_seconds=0.5, reach=0.25, positions=lambda t: {"j": 2 * t}, energy=math.exp
    )
    assert engine.state("e") == sinking(0.0)
    assert (engine.joint_positions("e"), engine.energy("e")) == ({"j": 0.0}, 1.0)
    engine.advance(4)
    assert engine.state("e") == sinking(2.0)
    assert (engine.joint_positions("e"), engine.energy("e")) == ({"j": 4.0}, math.exp(2.0))
    assert engine.lowest_point("e") == 0.75
    assert engine.corners("e") == [(1.0, 2.0, 1.0)]
    assert engine.link_poses("e") == {"root": Pose((1.0, 2.0, 1.0))}


def test_it_goes_on_with_the_script_where_it_is_placed() -> None:
    engine = FakeEngine(sinking, reach=0.25)
    engine.place("e", Pose((0.0, 0.0, 10.0)))
    assert engine.state("e").xyz == (1.0, 2.0, 10.0)
    engine.advance(1000)
    assert engine.lowest_point("e") == 8.75
    engine.place("e", Pose((0.0, 0.0, 1.0)))
    assert engine.state("e").xyz[2] == 1.0


def test_what_else_it_is_asked_to_do() -> None:
    overlap = Overlap("e", "a", "e", "b", 0.1)
    engine = FakeEngine(sinking, overlapping=[overlap])
    assert engine.overlaps() == [overlap]
    assert not engine.is_closed
    engine.close()
    assert engine.is_closed


def test_efforts_and_motors_take_each_others_place() -> None:
    engine = FakeEngine(sinking, positions=lambda _: {"arm": 0.0})
    engine.set_efforts("e", {"arm": 2.0})
    assert engine.joint_efforts("e") == {"arm": 2.0}
    engine.drive("e", {"arm": Motor(1.0, 5.0)})
    assert engine.joint_efforts("e") == {"arm": 0.0}
    engine.set_efforts("e", {"arm": 1.0})
    assert engine.motors["e"] == {}
    engine.release("e")
    assert engine.joint_efforts("e") == {"arm": 0.0}


def test_rays_and_velocities_follow_the_script() -> None:
    engine = FakeEngine(
        sinking,
        rays=lambda starts, _: np.full(len(starts), 0.5),
    )
    assert engine.cast_rays([(0, 0, 0)] * 3, [(1, 0, 0)] * 3).tolist() == [0.5, 0.5, 0.5]
    linear, angular = engine.link_velocities("e")["root"]
    assert linear == pytest.approx((0.0, 0.0, -1.0))
    assert angular == (0.0, 0.0, 0.0)

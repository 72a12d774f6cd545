"""What every engine must do with forces, and what it must tell of contacts and velocities."""

from __future__ import annotations

import pytest

from simulation.robots import (
    GROUND,
    PLATE,
    SPACE,
    G,
    NewEngine,
    body,
    lift,
    pendulum,
    single,
    spawned,
)
from wsgen.model.transform import Pose
from wsgen.simulation.scene import SpawnedRobot


def test_a_force_acts_until_it_is_replaced(new_engine: NewEngine) -> None:
    with spawned(new_engine, single(body(PLATE, mass=2.0)), world=SPACE) as engine:
        engine.push("e", "base", (2.0, 0.0, 0.0))
        engine.advance(500)
        assert engine.state("e").speed == pytest.approx(0.5, rel=1e-3)
        engine.push("e", "base", (0.0, 4.0, 0.0))
        engine.advance(250)
        assert engine.state("e").speed == pytest.approx(0.5**0.5, rel=1e-3)
        engine.push("e", "base", (0.0, 0.0, 0.0))
        engine.advance(250)
        assert engine.state("e").speed == pytest.approx(0.5**0.5, rel=1e-3)


def test_it_acts_at_the_center_of_mass_in_the_world(new_engine: NewEngine) -> None:
    """What is turned, and whose frame lies elsewhere, does not start to turn."""
    link = body(PLATE, mass=2.0, at=Pose((0.3, 0.0, 0.1)))
    turned = Pose((0.0, 0.0, 1.0), (0.4, 0.0, 1.2))
    with spawned(new_engine, single(link), turned, world=SPACE) as engine:
        engine.push("e", "base", (0.0, 3.0, 0.0))
        engine.advance(200)
        state = engine.state("e")
        assert state.turning == pytest.approx(0.0, abs=1e-6)
        assert state.xyz[0] == pytest.approx(0.0, abs=1e-6)
        assert state.xyz[1] == pytest.approx(0.03, rel=0.02)


def test_what_is_fixed_stays(new_engine: NewEngine) -> None:
    with spawned(new_engine, pendulum(), world=SPACE) as engine:
        engine.push("e", "world", (100.0, 0.0, 0.0))
        engine.advance(100)
        assert engine.joint_positions("e")["bar"] == pytest.approx(0.0, abs=1e-9)
        engine.push("e", "bar", (0.0, 0.0, 1.0))
        engine.advance(100)
        assert engine.joint_positions("e")["bar"] < -1e-3


def test_velocities_of_joints(new_engine: NewEngine) -> None:
    with spawned(new_engine, lift()) as engine:
        assert engine.joint_velocities("e") == {"cabin": 0.0}
        engine.advance(100)
        assert engine.joint_velocities("e")["cabin"] == pytest.approx(-0.1 * G, rel=0.02)
    with spawned(new_engine, single(body(PLATE))) as engine:
        assert engine.joint_velocities("e") == {}


def test_contacts_with_the_ground_carry_the_weight(new_engine: NewEngine) -> None:
    resting = Pose((0.0, 0.0, 0.0501))
    with spawned(new_engine, single(body(PLATE, mass=2.0)), resting, world=GROUND) as engine:
        assert engine.contacts("e") == []
        engine.advance(500)
        contacts = engine.contacts("e")
        assert {(one.link, one.other_entity, one.other_link) for one in contacts} == {
            ("base", None, None)
        }
        assert sum(one.force for one in contacts) == pytest.approx(2.0 * G, rel=0.05)
        assert all(abs(one.point[2]) < 0.003 for one in contacts)
        assert all(one.normal == pytest.approx((0.0, 0.0, 1.0), abs=1e-2) for one in contacts)
        assert all(0.0 <= one.depth < 0.003 for one in contacts)
        assert {(one.point[0] > 0, one.point[1] > 0) for one in contacts} == {
            (x, y) for x in (True, False) for y in (True, False)
        }
        engine.place("e", Pose((0.0, 0.0, 5.0)))
        assert engine.contacts("e") == []
        engine.advance(10)
        assert engine.contacts("e") == []


def test_contacts_of_two_robots_are_seen_from_either(new_engine: NewEngine) -> None:
    upper = SpawnedRobot(
        entity="o",
        robot=single(body(PLATE, name="plate", mass=3.0)),
        pose_in_world=Pose((0.0, 0.0, 0.152)),
    )
    lower = Pose((0.0, 0.0, 0.051))
    with spawned(new_engine, single(body(PLATE)), lower, upper, world=GROUND) as engine:
        engine.advance(500)
        from_above, from_below = engine.contacts("o"), engine.contacts("e")
        assert {(one.link, one.other_entity, one.other_link) for one in from_above} == {
            ("plate", "e", "base")
        }
        assert sum(one.force for one in from_above) == pytest.approx(3.0 * G, rel=0.05)
        met = [one for one in from_below if one.other_entity == "o"]
        assert {one.other_link for one in met} == {"plate"}
        assert all(one.normal[2] == pytest.approx(1.0, abs=1e-2) for one in from_above)
        assert all(one.normal[2] == pytest.approx(-1.0, abs=1e-2) for one in met)
        assert sum(one.force for one in met) == pytest.approx(3.0 * G, rel=0.05)
        under = [one for one in from_below if one.other_entity is None]
        assert sum(one.force for one in under) == pytest.approx(4.0 * G, rel=0.05)

"""What the DART engine does in a way of its own; what both do is in `test_engines`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from simulation.robots import CYLINDER, PLATE, body, joint, run_of, single, spawned, tree
from wsgen.model.robot import JointType
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from wsgen.simulation.dart import DartEngine
else:
    pytest.importorskip("dartpy")
    from wsgen.simulation.dart import DartEngine


@pytest.mark.slow
def test_more_links_than_pybullet_can_do() -> None:
    chain = [
        (
            joint(f"l{n}", f"l{n + 1}", JointType.FIXED, Pose((0.01, 0.0, 0.0))),
            body(None, name=f"l{n + 1}", mass=0.01),
        )
        for n in range(300)
    ]
    robot_run = run_of(DartEngine, tree(body(PLATE, name="l0"), *chain), 0.06, seconds=0.1)
    assert robot_run.links == 301
    assert robot_run.mass == pytest.approx(4.0)
    with spawned(DartEngine, tree(body(PLATE, name="l0"), *chain)) as engine:
        assert engine.link_poses("e")["l300"].xyz == pytest.approx((3.0, 0.0, 0.0))


def test_half_sunk_stays_there() -> None:
    """Gazebo's engine pushes no faster than 1 mm/s."""
    robot_run = run_of(DartEngine, single(body(CYLINDER)), 0.15)
    assert robot_run.penetration == pytest.approx(0.1)
    assert robot_run.lowest_point_at_end == pytest.approx(-0.1, abs=0.005)
    assert robot_run.highest_speed < 0.01


def test_shapes_of_two_robots_have_names_of_their_own() -> None:
    """DART tells contacts by the names of shapes."""
    with spawned(DartEngine, single(body(PLATE))) as engine:
        (first,) = engine._robots["e"].shapes  # type: ignore[attr-defined]
        assert first[1].getName() == "e 0"


def test_a_robot_that_is_too_far_away_has_exploded() -> None:
    with spawned(DartEngine, single(body(PLATE))) as engine:
        engine.set_velocity("e", (1e12, 0.0, 0.0), (0.0, 0.0, 0.0))
        engine.advance(100)
        assert not engine.look("e").is_finite
        engine.remove("e")
        engine.advance(100)

"""Ranges of lidars: walls where they are, noise that is seeded, what REP 117 says of the rest."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from live.nodes.sensor_texts import block, element, world_of
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.lidar_rays import LidarSpec, Scanner, read_lidar
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from wsgen.simulation.engine import Engine

WALL = block("wall", (0.2, 10.0, 4.0), Pose((2.1, 0.0, 0.0)))


def lidar(
    samples: int = 5,
    *,
    least: float = -0.5,
    most: float = 0.5,
    near: float = 0.1,
    far: float = 10.0,
    more: str = "",
) -> LidarSpec:
    return read_lidar(
        element(
            f"<ray><scan><horizontal><samples>{samples}</samples><min_angle>{least}</min_angle>"
            f"<max_angle>{most}</max_angle></horizontal>{more}</scan>"
            f"<range><min>{near}</min><max>{far}</max></range></ray>"
        )
    )


def scan(spec: LidarSpec, engine: Engine, pose: Pose, seed: int = 0) -> np.ndarray:
    return Scanner(spec, np.random.default_rng(seed)).measure(pose, engine.cast_rays)


def test_a_wall_at_two_meters_is_at_two_meters() -> None:
    spec = lidar()
    with world_of(WALL) as engine:
        ranges = scan(spec, engine, Pose((0.0, 0.0, 1.0)))
    assert ranges.shape == (1, 5)
    assert ranges[0] == pytest.approx(2.0 / np.cos(spec.across.all), abs=1e-3)
    assert spec.across.step == pytest.approx(0.25)


def test_a_turned_lidar_sees_from_where_it_looks() -> None:
    """Rolled to its side, it scans up and down; yawed, it looks along the wall."""
    spec = lidar(3, least=-math.pi / 2, most=math.pi / 2)
    with world_of(WALL) as engine:
        rolled = scan(spec, engine, Pose((0.0, 0.0, 1.0), (math.pi / 2, 0.0, 0.0)))
        yawed = scan(spec, engine, Pose((0.0, 0.0, 1.0), (0.0, 0.0, math.pi / 2)))
    # Its left is up, its right down on the ground.
    assert rolled[0] == pytest.approx([1.0, 2.0, math.inf], abs=1e-3)
    assert yawed[0] == pytest.approx([2.0, math.inf, math.inf], abs=1e-3)


def test_what_is_too_near_or_too_far_is_infinite() -> None:
    with world_of(WALL) as engine:
        at = Pose((0.0, 0.0, 1.0))
        # From 2 m on, inside of the wall: what is nearer than the least range is not measured.
        assert scan(lidar(1, near=2.0), engine, at)[0, 0] == -math.inf
        assert scan(lidar(1, far=1.9), engine, at)[0, 0] == math.inf
        assert scan(lidar(1, far=2.1), engine, at)[0, 0] == pytest.approx(2.0, abs=1e-3)
        assert scan(lidar(1), engine, Pose((0.0, 0.0, 1.0), (0.0, 0.0, math.pi)))[0, 0] == math.inf


def test_rows_go_from_low_to_high() -> None:
    more = (
        "<vertical><samples>3</samples><min_angle>-0.4</min_angle>"
        "<max_angle>0.4</max_angle></vertical>"
    )
    spec = lidar(1, more=more, far=20.0)
    scanner = Scanner(spec, np.random.default_rng(0))
    with world_of(block("wall", (0.2, 10.0, 20.0), Pose((4.1, 0.0, 0.0)))) as engine:
        ranges = scanner.measure(Pose((0.0, 0.0, 1.0)), engine.cast_rays)
    assert spec.shape == (3, 1)
    expected = [1.0 / math.sin(0.4), 4.0, 4.0 / math.cos(0.4)]  # ground, wall, wall
    assert ranges[:, 0] == pytest.approx(expected, abs=2e-3)
    points = scanner.points(ranges)[:, 0]
    assert points[0] == pytest.approx((1.0 / math.tan(0.4), 0.0, -1.0), abs=2e-3)
    assert points[2] == pytest.approx((4.0, 0.0, 4.0 * math.tan(0.4)), abs=2e-3)


def test_noise_is_seeded_and_keeps_within_the_range() -> None:
    text = (
        "<lidar><scan><horizontal><samples>400</samples><min_angle>-0.01</min_angle>"
        "<max_angle>0.01</max_angle></horizontal></scan><range><min>0.1</min><max>10</max></range>"
        "<noise><type>gaussian</type><mean>0</mean><stddev>0.05</stddev></noise></lidar>"
    )
    spec = read_lidar(element(text))
    at = Pose((0.0, 0.0, 1.0))
    with world_of(WALL) as engine:
        one, again, other = (scan(spec, engine, at, seed) for seed in (1, 1, 2))
        assert (one == again).all()
        assert (one != other).any()
        assert one.mean() == pytest.approx(2.0, abs=0.02)
        assert one.std() == pytest.approx(0.05, rel=0.2)
        near = scan(spec, engine, Pose((1.88, 0.0, 1.0)), 1)
        assert near.min() == 0.1
        away = scan(spec, engine, Pose((0.0, 0.0, 1.0), (0.0, 0.0, math.pi)))
        assert (away == math.inf).all()


def test_resolution_makes_more_rays() -> None:
    text = (
        "<ray><scan><horizontal><samples>10</samples><resolution>2</resolution>"
        "<min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>"
        "<range><min>0.1</min><max>10</max></range></ray>"
    )
    spec = read_lidar(element(text))
    assert spec.across.count == 20
    assert spec.across.step == pytest.approx(2.0 / 19)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"samples": 0}, "has 0 rays"),
        ({"near": 5.0, "far": 1.0}, "goes from 5 m to 1 m"),
        ({"samples": 10**9}, "rays"),
    ],
)
def test_what_makes_no_scan_is_reported(arguments: dict[str, float], expected: str) -> None:
    with pytest.raises(CannotWorkError, match=expected):
        lidar(**arguments)  # type: ignore[arg-type]


def test_what_is_no_number_is_reported() -> None:
    text = "<ray><scan><horizontal><samples>many</samples></horizontal></scan></ray>"
    with pytest.raises(CannotWorkError, match="many"):
        read_lidar(element(text))

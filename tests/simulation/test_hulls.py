"""Meshes that rest on their convex hull where they have no triangle."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import numpy as np
import pytest

from simulation.robots import GROUND, body, single
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.model.robot import Box, Mesh
from wsgen.model.transform import Pose
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from simulation.robots import NewEngine
    from wsgen.model.robot import Geometry
    from wsgen.simulation.engine import HullGap


@pytest.fixture
def hull_engine(new_engine: NewEngine) -> NewEngine:
    """An engine that collides hulls; DART collides triangles."""
    if new_engine.__name__ == "DartEngine":
        pytest.skip("it has no hulls")
    return new_engine


POST_HEIGHT = 0.5  # m


def write_bench(folder: Path, leg: float) -> Mesh:
    """A plate of 0.6 x 0.6 x 0.1 m with legs of that length (m) at two of its edges."""
    boxes = [
        ((-0.3, -0.3, -0.05), (0.3, 0.3, 0.05)),
        ((-0.3, -0.3, -0.05 - leg), (-0.25, 0.3, -0.05)),
        ((0.25, -0.3, -0.05 - leg), (0.3, 0.3, -0.05)),
    ]
    corners = np.concatenate([triangles_of_box(*box) for box in boxes])
    write_stl(corners, folder / "bench.stl")
    return Mesh(uri="bench.stl", path=str(folder / "bench.stl"))


def triangles_of_box(
    low: tuple[float, float, float], high: tuple[float, float, float]
) -> NDArray[np.float64]:
    points: NDArray[np.float64] = np.array(
        [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float
    )
    points = np.array(low) + points * (np.array(high) - np.array(low))
    faces = [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
    triangles: NDArray[np.float64] = points[np.array(faces)]
    return triangles


def gaps_on_a_post(engine_class: NewEngine, geometry: Geometry, height: float) -> Sequence[HullGap]:
    """What is found when something rests on a post, its root link at that height (m) at first."""
    post = single(body(Box(size=(0.2, 0.2, POST_HEIGHT)), name="post", mass=1000.0))
    thing = single(body(geometry, name="bench", moment=0.06))
    with closing(engine_class(GROUND)) as engine:
        engine.spawn(
            SpawnedRobot(entity="post", robot=post, pose_in_world=Pose((0, 0, POST_HEIGHT / 2)))
        )
        engine.spawn(SpawnedRobot(entity="bench", robot=thing, pose_in_world=Pose((0, 0, height))))
        engine.advance(1000)
        assert engine.hull_gaps("post") == []
        return engine.hull_gaps("bench")


def test_bench_over_a_post_rests_on_its_hull(hull_engine: NewEngine, tmp_path: Path) -> None:
    bench = write_bench(tmp_path, leg=0.1)
    (gap,) = gaps_on_a_post(hull_engine, bench, POST_HEIGHT + 0.16)
    assert (gap.link, gap.other_entity) == ("bench", "post")
    assert gap.gap == pytest.approx(0.1, abs=0.005)  # from between the legs up to the plate


def test_a_gap_of_less_than_five_millimetres_is_none(
    hull_engine: NewEngine, tmp_path: Path
) -> None:
    assert gaps_on_a_post(hull_engine, write_bench(tmp_path, leg=0.003), POST_HEIGHT + 0.06) == []


def test_a_convex_shape_has_no_gap(hull_engine: NewEngine) -> None:
    assert gaps_on_a_post(hull_engine, Box(size=(0.6, 0.6, 0.1)), POST_HEIGHT + 0.06) == []


def test_level_ground_makes_no_gap(hull_engine: NewEngine, tmp_path: Path) -> None:
    bench = single(body(write_bench(tmp_path, leg=0.1), name="bench", moment=0.06))
    with closing(hull_engine(GROUND)) as engine:
        engine.spawn(SpawnedRobot(entity="bench", robot=bench, pose_in_world=Pose((0, 0, 0.16))))
        engine.advance(500)
        assert engine.state("bench").xyz[2] == pytest.approx(0.15, abs=0.003)
        assert engine.hull_gaps("bench") == []

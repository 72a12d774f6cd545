"""The surfaces of heightmaps and extrusions against Gazebo's own physics.

A number of small balls that can move up and down alone feel for the surface.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from simulation.gazebo_physics import DEBIAN, GazeboPhysics, is_installed
from surface_heights import height_at
from wsgen.descriptions.meshes.shape_worker import extrusion_triangles, heightmap_surface
from wsgen.model.robot import Extrusion, Heightmap

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Probe = Callable[[str, Sequence[tuple[float, float]]], list[float]]

RADIUS = 0.01  # m
TOP = 3.0  # m, where the balls start
STEPS = 3000

WORLD = """\
<sdf version="1.9"><world name="w">
<gravity>0 0 -9.8</gravity>
<physics name="fast" type="dart"><max_step_size>0.001</max_step_size></physics>
<model name="scenery"><static>true</static><link name="l"><collision name="c">
<geometry>{geometry}</geometry></collision></link></model>
{balls}
</world></sdf>
"""
BALL = """\
<model name="ball{number}"><pose>{x!r} {y!r} {z!r} 0 0 0</pose>
<link name="l"><inertial><mass>0.1</mass></inertial><collision name="c{number}">
<geometry><sphere><radius>{radius}</radius></sphere></geometry></collision></link>
<joint name="j" type="prismatic"><parent>world</parent><child>l</child><axis><xyz>0 0 1</xyz>
<limit><lower>-100</lower><upper>100</upper></limit>
<dynamics><damping>0.3</damping></dynamics></axis></joint></model>
"""

pytestmark = [pytest.mark.slow, pytest.mark.oracle]


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Probe:
    """Gives how high a geometry is at some places; NaN where the ball has fallen past it."""
    if not is_installed():
        pytest.skip(f"Gazebo's physics (Debian: {DEBIAN}) are missing")
    gazebo = GazeboPhysics(tmp_path_factory)

    def feel(geometry: str, places: Sequence[tuple[float, float]]) -> list[float]:
        balls = "".join(
            BALL.format(number=number, x=x, y=y, z=TOP, radius=RADIUS)
            for number, (x, y) in enumerate(places)
        )
        poses = gazebo.run(WORLD.format(geometry=geometry, balls=balls), steps=STEPS)
        rests = [pose.xyz[2] for link, pose in poses.items() if link.startswith("ball")]
        assert len(rests) == len(places)
        return [z - RADIUS if z > -1 else math.nan for z in rests]

    return feel


def smooth(size: int) -> NDArray[Any]:
    """Hills, 0 to 200."""
    x, y = np.meshgrid(np.linspace(0, 4, size), np.linspace(0, 3, size))
    hills = 100 + 60 * np.sin(x) + 40 * np.cos(2 * y + x)
    return np.array(hills.round(), np.uint8)


@pytest.mark.parametrize(
    ("rows", "size", "sampling"),
    [(17, (8.0, 8.0, 1.0), 1), (17, (8.0, 6.0, 2.0), 2), (12, (10.0, 10.0, 0.5), 1)],
)
def test_heightmaps(
    probe: Probe, tmp_path: Path, rows: int, size: tuple[float, float, float], sampling: int
) -> None:
    file = tmp_path / "hills.png"
    Image.fromarray(smooth(rows)).save(file)
    random = np.random.default_rng(1)
    places = [
        (float(x) * size[0], float(y) * size[1]) for x, y in random.uniform(-0.5, 0.5, (40, 2))
    ]
    theirs = probe(
        f"<heightmap><uri>file://{file}</uri><size>{' '.join(map(str, size))}</size>"
        f"<sampling>{sampling}</sampling></heightmap>",
        places,
    )
    shape = Heightmap(uri="h", path=str(file), size=size, sampling=sampling)
    corners = heightmap_surface(shape).corners
    ours = [height_at(corners, x, y) for x, y in places]
    assert ours == pytest.approx(theirs, abs=0.01, nan_ok=True)
    assert 20 < sum(map(math.isfinite, theirs)) <= 40


def polylines(shape: Extrusion) -> str:
    return "".join(
        f"<polyline>{''.join(f'<point>{x} {y}</point>' for x, y in outline)}"
        f"<height>{shape.height}</height></polyline>"
        for outline in shape.outlines
    )


def around(half: float, x: float = 0.0) -> tuple[tuple[float, float], ...]:
    return ((x - half, -half), (x + half, -half), (x + half, half), (x - half, half))


@pytest.mark.parametrize(
    "outlines",
    [
        (around(2),),
        (around(2)[::-1],),
        (around(2), around(1)),
        (around(1), around(2)),
        (around(2), around(1), around(0.5)),
        (around(1), around(0.5, x=2)),
        (((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)),),
    ],
)
def test_extrusions(probe: Probe, outlines: tuple[tuple[tuple[float, float], ...], ...]) -> None:
    shape = Extrusion(outlines=outlines, height=1.5)
    places = [(x + 0.23, y + 0.11) for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 0, 1, 2)]
    corners = extrusion_triangles(shape)
    upper = corners[(corners[..., 2] > 1).all(axis=1)]
    ours = [height_at(upper, x, y) for x, y in places]
    assert ours == pytest.approx(probe(polylines(shape), places), abs=0.002, nan_ok=True)
    assert 0 < sum(map(math.isfinite, ours)) < len(places)

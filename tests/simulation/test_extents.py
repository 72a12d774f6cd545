"""How far shapes reach: down, against points on their surface, and out of the others' hull."""

from __future__ import annotations

import math
import random
import time
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import pytest

from simulation.robots import body, single
from wsgen.model.robot import Box, Capsule, Collision, Cylinder, Geometry, Mesh, Sphere
from wsgen.model.transform import Pose, compose
from wsgen.simulation.contact_shapes import inside_hull
from wsgen.simulation.surfaces import lowest_point

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.model.transform import Vector


BOX = Box(size=(0.2, 0.4, 0.6))
SPHERE = Sphere(radius=0.3)
CYLINDER = Cylinder(radius=0.2, length=0.5)
CAPSULE = Capsule(radius=0.1, length=0.5)

STEPS = 120


def surface(geometry: Geometry) -> list[Vector]:
    """Points on it, close enough to each other."""
    if isinstance(geometry, Box):
        x, y, z = geometry.size
        return [(a * x / 2, b * y / 2, c * z / 2) for a, b, c in product((-1, 1), repeat=3)]
    turns = [math.tau * step / STEPS for step in range(STEPS)]
    assert isinstance(geometry, Sphere | Cylinder | Capsule)
    if isinstance(geometry, Cylinder):
        r, half = geometry.radius, geometry.length / 2
        return [(r * math.cos(t), r * math.sin(t), end) for t in turns for end in (-half, half)]
    r, half = geometry.radius, geometry.length / 2 if isinstance(geometry, Capsule) else 0.0
    heights = [math.pi * (step / STEPS - 0.5) for step in range(STEPS + 1)]
    return [
        (
            r * math.cos(up) * math.cos(t),
            r * math.cos(up) * math.sin(t),
            r * math.sin(up) + math.copysign(half, up),
        )
        for t in turns
        for up in heights
    ]


@pytest.mark.parametrize("geometry", [BOX, SPHERE, CYLINDER, CAPSULE])
@pytest.mark.parametrize(
    "rpy", [(0.0, 0.0, 0.0), (0.4, 0.7, 0.2), (math.pi / 2, 0.0, 1.0), (2.5, -1.1, -3.0)]
)
def test_no_point_is_lower(geometry: Geometry, rpy: Vector) -> None:
    pose = Pose((1.0, 2.0, 3.0), rpy)
    lowest = min(compose(pose, Pose(point)).xyz[2] for point in surface(geometry))
    found = lowest_point(single(body(geometry, moment=1.0)), {"base": pose})
    assert lowest - 1e-3 * 0.5 < found <= lowest + 1e-9


CUBE = Box(size=(0.1, 0.1, 0.1))


def in_cells(geometry: Geometry, cells: Iterable[Sequence[int]]) -> list[Collision]:
    """The shape in cells of 0.1 m."""
    return [
        Collision(geometry=geometry, pose_in_link=Pose((0.1 * x, 0.1 * y, 0.1 * z)))
        for x, y, z in cells
    ]


def turned(seed: int) -> list[Collision]:
    """Shapes of all kinds, anywhere and any way round."""
    anyhow = random.Random(seed)  # noqa: S311  the same shapes on every run

    def vector(most: float) -> Vector:
        return (
            anyhow.uniform(-most, most),
            anyhow.uniform(-most, most),
            anyhow.uniform(-most, most),
        )

    return [
        Collision(geometry=anyhow.choice(kinds), pose_in_link=Pose(vector(1.0), vector(3.0)))
        for kinds in [(CUBE, BOX, SPHERE, CYLINDER, CAPSULE)] * 60
    ]


@pytest.mark.parametrize(
    ("sides", "spanning"), [((5, 5, 1), 4), ((5, 5, 5), 8), ((40, 1, 1), 2), ((1, 1, 40), 2)]
)
def test_the_corners_of_a_lattice_span_it(sides: tuple[int, int, int], spanning: int) -> None:
    cells = list(product(*map(range, sides)))
    assert len(cells) - len(inside_hull(in_cells(CUBE, cells))) == spanning


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_what_spans_the_hull_reaches_as_low_however_it_lies(seed: int) -> None:
    shapes = turned(seed)
    inside = inside_hull(shapes)
    assert 20 < len(inside) < len(shapes)
    anyhow = random.Random(seed)  # noqa: S311
    for _ in range(200):
        turn = Pose(rpy=(anyhow.uniform(-3, 3), anyhow.uniform(-3, 3), anyhow.uniform(-3, 3)))
        links = [replace(body(None), collisions=(one,)) for one in shapes]
        lows = [lowest_point(single(link), {"base": turn}) for link in links]
        outer = [low for number, low in enumerate(lows) if number not in inside]
        assert min(outer) == pytest.approx(min(lows), abs=2e-5)


def test_round_things_stand_out_though_their_boxes_do_not() -> None:
    # The cubes are under a ball, within the corners of its box.
    shapes = [
        Collision(geometry=Sphere(radius=1.0)),
        *(
            Collision(geometry=CUBE, pose_in_link=Pose((x, y, -0.9)))
            for x in (-0.9, 0.9)
            for y in (-0.9, 0.9)
        ),
    ]
    assert inside_hull(shapes) == set()


def test_meshes_are_never_inside() -> None:
    cells = list(product(range(3), repeat=3))
    shapes = in_cells(CUBE, cells)
    middle = cells.index((1, 1, 1))
    assert middle in inside_hull(shapes)
    shapes[middle] = Collision(geometry=Mesh(uri="m.stl"), pose_in_link=shapes[middle].pose_in_link)
    assert middle not in inside_hull(shapes)


@pytest.mark.parametrize(
    "shapes", [[], in_cells(CUBE, [(0, 0, 0)]), in_cells(Mesh(uri="m.stl"), [(0, 0, 0)] * 2)]
)
def test_a_few_shapes_span_their_hull(shapes: list[Collision]) -> None:
    assert inside_hull(shapes) == set()


def test_points_of_no_size_have_no_hull() -> None:
    flat = Box(size=(0.0, 0.0, 0.0))
    assert inside_hull(in_cells(flat, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])) == set()


def test_a_ball_of_cubes_does_not_take_long() -> None:
    cells = [cell for cell in product(range(-7, 8), repeat=3) if math.hypot(*cell) < 7]
    started = time.process_time()
    inside = inside_hull(in_cells(CUBE, cells))
    assert time.process_time() - started < 10
    assert len(cells) > 1000
    assert len(inside) > len(cells) / 2

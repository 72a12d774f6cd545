"""How far shapes reach down, against points on their surface."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

import pytest

from wsgen.model.pose import Pose
from wsgen.model.robot import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from wsgen.model.transform import compose
from wsgen.simulation.extents import lowest_point

if TYPE_CHECKING:
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
    found = lowest_point(geometry, pose)
    assert found is not None
    assert lowest - 1e-3 * 0.5 < found <= lowest + 1e-9


def test_a_mesh_is_in_a_file() -> None:
    assert lowest_point(Mesh(uri="m.stl"), Pose()) is None

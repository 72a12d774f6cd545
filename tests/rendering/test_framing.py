"""The camera: everything is in the picture, and as large as can be."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import pytest

from rendering.showpieces import BLUE, is_blue, margins, photograph, piece
from wsgen.model.robot import Box, Cylinder, Geometry, Mesh, Sphere
from wsgen.model.transform import Pose
from wsgen.rendering.camera import MARGIN, Size, eye_camera

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.rendering.camera import Camera, Floats


pytestmark = pytest.mark.slow

SIZE = Size(960, 720)
BOXES = {
    "a cube": (1.0, 1.0, 1.0),
    "long": (10.0, 0.1, 0.1),
    "across": (0.1, 10.0, 0.1),
    "tall": (0.05, 0.05, 4.0),
    "flat": (3.0, 3.0, 0.01),
    "1 cm": (0.01, 0.01, 0.01),
    "50 m": (50.0, 20.0, 30.0),
}


def corners(size: tuple[float, float, float], at: tuple[float, float, float]) -> Floats:
    signs: Floats = np.array(list(product((-0.5, 0.5), repeat=3)))
    points: Floats = signs * np.array(size) + np.array(at)
    return points


def seen_at(camera: Camera, points: Floats) -> Floats:
    """Where points are seen: 0 to 1 from left to right and from top to bottom."""
    across, up, forward = camera.axes @ (points - np.array(camera.eye)).T
    slope = math.tan(math.radians(camera.field_of_view / 2))
    seen: Floats = np.stack(
        [(across / forward / slope / camera.aspect + 1) / 2, (1 - up / forward / slope) / 2]
    )
    assert (forward > camera.near).all()
    assert (forward < camera.far).all()
    return seen


@pytest.mark.parametrize("size", BOXES.values(), ids=BOXES)
@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (3.0, -70.0, 12.0)])
def test_all_corners_are_within_the_margin_and_two_sides_are_reached(
    size: tuple[float, float, float], at: tuple[float, float, float]
) -> None:
    points = corners(size, at)
    seen = seen_at(eye_camera(points, SIZE), points)
    left, top = seen.min(axis=1).tolist()
    right, bottom = (1 - seen.max(axis=1)).tolist()
    assert min(left, top, right, bottom) > MARGIN - 1e-6
    width_is_used = max(left, right) < MARGIN + 1e-6
    height_is_used = max(top, bottom) < MARGIN + 1e-6
    assert width_is_used or height_is_used


def test_a_point_is_looked_at_from_some_distance() -> None:
    camera = eye_camera(np.zeros((1, 3)), SIZE)
    assert 1.0 < math.dist(camera.eye, camera.target) < 10.0


@pytest.mark.parametrize(
    "geometry",
    [
        *(Box(size=size) for size in BOXES.values()),
        Sphere(radius=0.3),
        Cylinder(radius=2, length=9),
    ],
    ids=repr,
)
def test_what_is_drawn_fills_the_picture_to_the_margin(tmp_path: Path, geometry: Geometry) -> None:
    pixels, _ = photograph(tmp_path, piece(geometry, rgba=BLUE, at=Pose((1.0, 2.0, 60.0))))
    found = margins(is_blue(pixels))
    assert min(found) > MARGIN - 0.01
    assert sum(side < MARGIN + 0.02 for side in found) >= 2


def write_tetrahedron(file: Path) -> None:
    """It fills a quarter of its box: from (0, 0, 0) one up each axis."""
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")


@pytest.mark.parametrize("bounds", [((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), None])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (0.02, 0.05, 0.1), (-3.0, 3.0, 30.0)])
def test_a_mesh_is_framed_by_what_is_seen_of_it(
    tmp_path: Path,
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    scale: tuple[float, float, float],
) -> None:
    file = tmp_path / "part.obj"
    write_tetrahedron(file)
    mesh = Mesh(uri="part.obj", path=str(file), scale=scale, bounds=bounds)
    pixels, _ = photograph(
        tmp_path, piece(mesh, rgba=BLUE), corners=[(0.0, 0.0, 0.0), (0.2, 0.0, 0.1)]
    )
    found = margins(is_blue(pixels))
    assert min(found) > MARGIN - 0.015
    assert sum(side < MARGIN + 0.03 for side in found) >= 2

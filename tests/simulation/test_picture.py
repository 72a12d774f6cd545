"""The ground in the picture: its squares are what the picture says they are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pybullet
import pytest
from PIL import Image

from wsgen.simulation import picture
from wsgen.simulation.shot import Camera, Shot

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


def nothing_seen(camera: Camera) -> Shot:
    shape = (camera.height, camera.width)
    return Shot(
        camera=camera,
        view=pybullet.computeViewMatrix(camera.eye, camera.target, (0.0, 0.0, 1.0)),
        projection=pybullet.computeProjectionMatrixFOV(
            camera.field_of_view, camera.aspect, camera.near, camera.far
        ),
        rgba=np.zeros((*shape, 4), dtype=np.uint8),
        depth=np.ones(shape),
        body=np.full(shape, -1),
    )


def pixel_of(shot: Shot, x: float, y: float) -> tuple[int, int]:
    """Where a point of the ground (m) is seen: column and row."""
    transform = [np.array(matrix).reshape(4, 4).T for matrix in (shot.projection, shot.view)]
    clip: NDArray[np.float64] = transform[0] @ transform[1] @ np.array([x, y, 0.0, 1.0])
    column = (clip[0] / clip[3] + 1) / 2 * picture.WIDTH
    row = (1 - clip[1] / clip[3]) / 2 * picture.HEIGHT
    return int(column), int(row)


@pytest.mark.parametrize("size", [0.03, 0.3, 0.8, 2.0, 30.0])
def test_a_square_is_as_large_as_it_is_said_to_be(tmp_path: Path, size: float) -> None:
    file = tmp_path / "ground.png"
    half = size / 2
    # The middle of the world is the middle of a square.
    eye, light = picture.cameras([(-half, -half, 0.0), (half, half, size)])
    shot = nothing_seen(eye)
    tile = picture.save(shot, nothing_seen(light), file)
    assert f"{tile / 10 ** math.floor(math.log10(tile) + 1e-9):.6g}" in {"1", "2", "5"}
    assert 0.3 < tile / size < 3
    with Image.open(file) as image:
        centres = [
            image.getpixel(pixel_of(shot, x * tile, y * tile))
            for x, y in ((0, 0), (1, 0), (0, 1), (-1, 0), (0, -1))
        ]
    brightness = [sum(colour) for colour in centres if isinstance(colour, tuple)]
    assert len(brightness) == 5
    assert all(abs(brightness[0] - other) > 30 for other in brightness[1:])
    assert max(brightness[1:]) - min(brightness[1:]) < 15


def test_the_size_is_written_into_the_picture(tmp_path: Path) -> None:
    file = tmp_path / "ground.png"
    eye, light = picture.cameras([(-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)])
    picture.save(nothing_seen(eye), nothing_seen(light), file)
    with Image.open(file) as image:
        corner = image.crop((0, picture.HEIGHT - 40, 200, picture.HEIGHT)).convert("L")
    assert corner.getextrema()[0] < 120  # darker than the ground ever is

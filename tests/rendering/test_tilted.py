"""Pictures of slopes: gravity points down in them, and all is in them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from simulation.robots import lattice
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.rendering.camera import MARGIN, Size, TurnedCamera, eye_camera, slope_of
from wsgen.rendering.picture import ARROW_COLOR, draw_arrow
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.simulation.scene import Push, Scene, SpawnedRobot

if TYPE_CHECKING:
    from wsgen.model.transform import Vector
    from wsgen.rendering.render_items import Poses

SIZE = Size(320, 240)
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-0.5, 0.5) for z in (0, 0.4)], float)


def gravity(slope: float, towards: float = 0.0) -> Vector:
    sin = 9.8 * math.sin(slope)
    return sin * math.cos(towards), sin * math.sin(towards), -9.8 * math.cos(slope)


@pytest.mark.parametrize("slope", [0.1, 0.5, 1.2])
@pytest.mark.parametrize("towards", [0.0, 2.0, -1.5])
def test_gravity_points_down(slope: float, towards: float) -> None:
    down = gravity(slope, towards)
    assert slope_of(down) == pytest.approx(slope)
    camera = TurnedCamera(CORNERS, SIZE, down)
    x, y = camera.places(np.array([(0, 0, 0), np.array(down) * 1e-2]))
    assert x[1] == pytest.approx(x[0], abs=1.0)
    assert y[1] > y[0] + 1
    columns, rows = camera.places(CORNERS)
    assert columns.min() > SIZE.width * MARGIN / 2
    assert columns.max() < SIZE.width * (1 - MARGIN / 2)
    assert rows.min() > SIZE.height * MARGIN / 2
    assert rows.max() < SIZE.height * (1 - MARGIN / 2)
    drawn = Image.new("RGB", (camera.camera.width, camera.camera.height), "white")
    turned = camera.turned(drawn)
    assert turned.size == (SIZE.width, SIZE.height)
    assert turned.getcolors() == [(SIZE.width * SIZE.height, (255, 255, 255))]  # no corner is empty


@pytest.mark.parametrize("down", [(0.0, 0.0, -9.8), (0.0, 0.0, 0.0), (0.0, 0.0, 9.8)])
def test_level_ground_is_seen_as_ever(down: Vector) -> None:
    assert slope_of(down) == 0.0
    camera = TurnedCamera(CORNERS, SIZE, down)
    assert camera.camera == eye_camera(CORNERS, SIZE)
    image = Image.new("RGB", (SIZE.width, SIZE.height))
    assert camera.turned(image) is image


def red(image: Image.Image) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    found: np.ndarray[tuple[int, int], np.dtype[np.bool_]] = np.all(
        np.asarray(image) == ARROW_COLOR, axis=2
    )
    return found


def test_an_arrow_has_its_head_where_it_points() -> None:
    image = Image.new("RGB", (300, 200), "gray")
    draw_arrow(image, (50, 100), (250, 100))
    rows, columns = np.nonzero(red(image))
    assert (columns.min(), columns.max()) == pytest.approx((50, 250), abs=2)
    assert np.ptp(rows[columns > 240]) < 10 > np.ptp(rows[columns < 200])
    before = image.copy()
    draw_arrow(image, (50, 50), (50, 50))
    assert image == before


@pytest.mark.slow
def test_a_push_is_in_the_picture() -> None:
    robot = SpawnedRobot(entity="e", robot=lattice((0, 0, 0)))
    pose: Poses = {"e": {robot.robot.root: Pose(xyz=(0.0, 0.0, 0.5))}}

    def picture(*pushes: Push) -> Image.Image:
        world = World(name="hill", gravity=gravity(0.3))
        scene = Scene(world=world, robots=(robot,), pushes=pushes)
        return SceneRenderer(scene, pose, {"e": [(0, 0, 0.5)]}).picture[0]

    push = Push(entity="e", link=robot.robot.root, force=(30.0, 0.0, 0.0), begin=1.0, seconds=0.5)
    assert not red(picture()).any()
    assert np.count_nonzero(red(picture(push))) > 100

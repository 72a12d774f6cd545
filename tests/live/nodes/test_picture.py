"""Cameras: intrinsics, depths, clouds, and what is drawn for them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image as PillowImage

from live.nodes.sensor_texts import element
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.picture import (
    CameraSpec,
    classic_cloud,
    classic_intrinsics,
    encoded,
    gray_of,
    gz_cloud,
    gz_intrinsics,
    in_range,
    optical_points,
    read_camera,
)
from wsgen.model.robot import Box, Link, Robot, Sphere, Visual
from wsgen.model.transform import IDENTITY, Pose
from wsgen.model.world import World
from wsgen.rendering.renderer import Light
from wsgen.rendering.sensor_camera import Exposure, Lens, SensorScene, focal_length
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Primitive

RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
LENS = Lens(width=64, height=48, focal=focal_length(64, 1.0), near=0.01, far=50.0)
WORLD = World(name="w", has_ground_plane=True)


def thing(
    name: str,
    geometry: Primitive,
    pose: Pose,
    rgba: tuple[float, float, float, float] = RED,
) -> SpawnedRobot:
    link = Link(name="link", visuals=(Visual(geometry=geometry, rgba=rgba),))
    robot = replace(Robot(name=name, root="link", links=(link,)), is_static=True)
    return SpawnedRobot(entity=name, robot=robot, pose_in_world=pose, is_static_model=True)


def look(
    *robots: SpawnedRobot, at: Pose = IDENTITY, world: World = WORLD, lens: Lens = LENS
) -> Exposure:
    poses = {robot.entity: {"link": robot.pose_in_world} for robot in robots}
    return SensorScene(world, robots).expose(lens, at, poses, in_color=True)


WALL = thing("wall", Box(size=(0.2, 10.0, 8.0)), Pose((2.1, 0.0, 0.0)))


def test_a_wall_at_two_meters_is_two_meters_deep() -> None:
    seen = look(WALL, at=Pose((0.0, 0.0, 1.5)))
    assert seen.depth.shape == (48, 64)
    assert seen.depth[:24] == pytest.approx(2.0, abs=1e-3)
    assert seen.rgb is not None
    red, green, blue = seen.rgb[10, 32]
    assert red > 100
    assert green == blue == 0


def test_the_ground_is_as_deep_as_it_is() -> None:
    """A row below the middle sees the ground where its ray meets it; above is the background."""
    seen = look(at=Pose((0.0, 0.0, 1.0)))
    row = 40
    below = (row + 0.5 - 24) / LENS.focal
    assert seen.depth[row] == pytest.approx(1.0 / below, rel=1e-4)
    assert np.isinf(seen.depth[:24]).all()
    assert seen.rgb is not None
    assert (seen.rgb[0] == 179).all()
    assert (seen.rgb[row] != 179).all()
    in_space = look(at=Pose((0.0, 0.0, 1.0)), world=replace(WORLD, has_ground_plane=False))
    assert np.isinf(in_space.depth).all()


def test_left_is_left_and_up_is_up() -> None:
    left = thing("left", Box(size=(0.1, 0.2, 0.2)), Pose((2.0, 0.5, 1.0)), RED)
    up = thing("up", Box(size=(0.1, 0.2, 0.2)), Pose((2.0, 0.0, 1.4)), BLUE)
    seen = look(left, up, at=Pose((0.0, 0.0, 1.0)))
    assert seen.rgb is not None
    rows, columns = np.nonzero(np.isclose(seen.depth, 1.95, atol=1e-3))
    is_red = seen.rgb[rows, columns, 0] > 100
    assert is_red.any()
    assert (~is_red).any()
    assert columns[is_red].max() < 32
    assert rows[is_red].mean() == pytest.approx(23.5)
    assert rows[~is_red].max() < 24
    assert columns[~is_red].mean() == pytest.approx(31.5)
    # The left of a camera that is rolled so is up.
    rolled = look(up, at=Pose((0.0, 0.0, 1.0), (math.pi / 2, 0.0, 0.0)))
    assert np.nonzero(np.isclose(rolled.depth, 1.95, atol=1e-3))[1].max() < 32


def test_a_turned_camera_sees_what_is_there() -> None:
    seen = look(WALL, at=Pose((0.0, 0.0, 1.5), (0.0, 0.0, math.pi)))
    assert np.isinf(seen.depth[:24]).all()
    pitched = look(WALL, at=Pose((0.0, 0.0, 1.5), (0.0, math.pi / 2, 0.0)))
    assert pitched.depth[24, 32] == pytest.approx(1.5, abs=1e-3)


def test_what_is_too_far_is_not_seen() -> None:
    seen = look(WALL, at=Pose((0.0, 0.0, 1.5)), lens=replace(LENS, far=1.5))
    assert np.isinf(seen.depth[:24]).all()
    assert seen.rgb is not None
    assert (seen.rgb[0] == 179).all()


def test_textures_are_those_that_pictures_have(tmp_path: Path) -> None:
    """Of a box that is looked at from near its edge, so that its triangles are cut by the view."""
    texture = tmp_path / "texture.png"
    numbers = np.random.default_rng(3).integers(0, 255, (6, 5, 3), dtype=np.uint8)
    PillowImage.fromarray(numbers).save(texture)
    visual = Visual(geometry=Box(size=(2.0, 3.0, 0.1)), texture=str(texture))
    link = Link(name="link", visuals=(visual,))
    robot = replace(Robot(name="floor", root="link", links=(link,)), is_static=True)
    floor = SpawnedRobot(entity="floor", robot=robot)
    at = Pose((-0.7, 0.2, 0.4), (0.1, 0.5, 0.3))
    scene = SensorScene(replace(WORLD, has_ground_plane=False), [floor])
    exposure = scene.expose(LENS, at, {"floor": {"link": IDENTITY}}, in_color=True)
    seen = scene._renderer.see(LENS.view(at))
    painted = np.full((3, LENS.width * LENS.height), 0.7, dtype=np.float32)
    scene._renderer.paint(painted, seen, Light(None, None))
    assert exposure.rgb is not None
    found = exposure.rgb.reshape(-1, 3).astype(float)
    # That has light that is reflected, too.
    assert np.abs(found - 255 * painted.T).max() < 30
    assert np.median(np.abs(found - 255 * painted.T)) < 2
    assert np.isfinite(exposure.depth).mean() > 0.5


def test_what_is_transparent_shows_what_is_behind() -> None:
    glass = thing("glass", Box(size=(0.1, 4.0, 4.0)), Pose((1.0, 0.0, 1.0)), (0.0, 0.0, 1.0, 0.5))
    seen = look(glass, WALL, at=Pose((0.0, 0.0, 1.5)))
    assert seen.rgb is not None
    red, _, blue = seen.rgb[10, 32]
    assert red > 30
    assert blue > 30


def test_collisions_are_not_seen() -> None:
    link = replace(WALL.robot.links[0], visuals=())
    unseen = replace(WALL, robot=replace(WALL.robot, links=(link,)))
    assert np.isinf(look(unseen, at=Pose((0.0, 0.0, 1.5))).depth[:24]).all()


def test_a_ball_is_round_in_depth() -> None:
    ball = thing("ball", Sphere(radius=0.5), Pose((2.0, 0.0, 1.0)))
    seen = look(ball, at=Pose((0.0, 0.0, 1.0)), lens=replace(LENS, width=65, height=49))
    assert seen.depth[24, 32] == pytest.approx(1.5, abs=0.01)
    assert seen.depth[24, 40] == pytest.approx(1.546, abs=0.01)


CAMERA = (
    "<camera><horizontal_fov>1.5</horizontal_fov><image><width>100</width><height>50</height>"
    "</image><clip><near>0.2</near><far>9</far></clip>{}</camera>"
)


def spec_of(more: str = "", *, sees_near: bool = False) -> CameraSpec:
    return read_camera(element(CAMERA.format(more)), sees_near=sees_near)


def test_the_field_of_view_makes_the_focal_length() -> None:
    spec = spec_of()
    focal = 50 / math.tan(0.75)
    assert spec.lens.focal == pytest.approx(focal)
    assert (spec.lens.near, spec.lens.far) == (0.2, 9.0)
    assert spec_of(sees_near=True).lens.near == 0.01
    found = gz_intrinsics(element(CAMERA.format("")), spec)
    assert found.k == pytest.approx([focal, 0, 50, 0, focal, 25, 0, 0, 1])
    assert found.p == pytest.approx([focal, 0, 50, 0, 0, focal, 25, 0, 0, 0, 1, 0])


def test_classic_has_its_center_half_a_pixel_beside_the_middle() -> None:
    spec = spec_of()
    found = classic_intrinsics(element('<plugin filename="libgazebo_ros_camera.so"/>'), spec)
    assert found.center == (50.5, 25.5)
    shifted = classic_intrinsics(
        element(
            '<plugin filename="libgazebo_ros_camera.so"><hack_baseline>0.07</hack_baseline>'
            "<rectification_matrix>1 0 0 0 1 0 0.5 0 1</rectification_matrix></plugin>"
        ),
        spec,
    )
    assert shifted.p[3] == pytest.approx(-0.07 * spec.lens.focal)
    assert shifted.rectification[6] == 0.5


def test_intrinsics_may_be_written() -> None:
    lens = "<lens><intrinsics><fx>80</fx><cx>40</cx></intrinsics></lens>"
    spec = spec_of(lens)
    found = gz_intrinsics(element(CAMERA.format(lens)), spec)
    assert spec.lens.focal == 80
    assert found.k[0] == 80
    assert found.k[2] == 40
    assert found.p[2] == 40


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<camera><image><width>0</width></image></camera>", "0 by 240 pixels"),
        ("<camera><horizontal_fov>5</horizontal_fov></camera>", "5 rad"),
        ("<camera><clip><near>3</near><far>1</far></clip></camera>", "3 m to 1 m"),
        ("<camera><horizontal_fov>wide</horizontal_fov></camera>", "wide"),
    ],
)
def test_what_makes_no_picture_is_reported(text: str, expected: str) -> None:
    with pytest.raises(CannotWorkError, match=expected):
        read_camera(element(text), sees_near=False)


def test_encodings() -> None:
    rgb = np.array([[[255, 0, 10]]], dtype=np.uint8)
    assert encoded(rgb, "rgb8").tolist() == [[[255, 0, 10]]]
    assert encoded(rgb, "bgr8").tolist() == [[[10, 0, 255]]]
    assert encoded(rgb, "mono8").tolist() == [[77]]


def test_depths_out_of_range_are_infinite() -> None:
    depth = np.array([[0.1, 0.5, 5.0, np.inf]], dtype=np.float32)
    assert in_range(depth, 0.4, 4.0).tolist() == [[-math.inf, 0.5, math.inf, math.inf]]


def test_points_lie_on_the_rays_of_their_pixels() -> None:
    """Of a wall at 2 m all points are 2 m ahead, and as far aside as the picture has them."""
    depth = np.full((3, 5), 2.0, dtype=np.float32)
    x, y, z = optical_points(depth, 10.0)
    assert x[0] == pytest.approx([-0.4, -0.2, 0.0, 0.2, 0.4])
    assert y[:, 0] == pytest.approx([-0.2, 0.0, 0.2])
    assert (z == 2.0).all()


def test_clouds_have_the_layouts_of_gazebo() -> None:
    depth = np.array([[2.0, np.inf]], dtype=np.float32)
    rgb = np.array([[[1, 2, 3], [4, 5, 6]]], dtype=np.uint8)
    classic = classic_cloud(depth, rgb, 10.0)
    assert classic.dtype.itemsize == 32
    assert classic[0, 0].tobytes()[16:20] == bytes([1, 2, 3, 0])
    assert classic["z"][0].tolist() == [2.0, math.inf]
    gz = gz_cloud(depth, rgb, 10.0)
    assert gz.dtype.itemsize == 16
    assert gz[0, 0].tobytes()[12:] == bytes([3, 2, 1, 0])
    # The left pixel is half a pixel to the left: y is positive.
    assert [float(gz[axis][0, 0]) for axis in "xyz"] == pytest.approx([2.0, 0.1, 0.0])
    assert gz["y"][0, 1] == math.inf
    gray = classic_cloud(depth, encoded(rgb, "mono8"), 10.0)
    assert gray[0, 0].tobytes()[17:20] == bytes(3)


def test_far_points_of_a_depth_camera_are_dark() -> None:
    gray = gray_of(np.array([[1.0, 2.0]], dtype=np.float32))
    assert gray[0].tolist() == [[127, 127, 127], [0, 0, 0]]

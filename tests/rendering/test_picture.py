"""Pictures: the ground, what is under it, colors, what is see-through, what nobody would see."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from rendering.showpieces import (
    BLUE,
    GROUND,
    VOID,
    is_blue,
    photograph,
    piece,
    pixels_of,
    scene_renderer_of,
    spawned,
    touched_alone,
)
from wsgen.descriptions.meshes.appearance import AppearanceWriter
from wsgen.descriptions.meshes.content import Material
from wsgen.descriptions.meshes.worker import read_mesh
from wsgen.model.robot import GAZEBO_COLORS, Box, Collision, Cylinder, Link, Mesh, Sphere, Visual
from wsgen.model.transform import Pose
from wsgen.rendering.camera import Size, extent, eye_camera
from wsgen.rendering.picture import Backdrop, tile_for, write_caption
from wsgen.rendering.scene_renderer import SUN, sun_of

if TYPE_CHECKING:
    from pathlib import Path

    from rendering.showpieces import Pixels
    from wsgen.model.transform import Vector


pytestmark = pytest.mark.slow

CUBE = Box(size=(1.0, 1.0, 1.0))
STANDING = Pose((0.0, 0.0, 0.5))
SIZE = Size(960, 720)


def middle(pixels: Pixels, edge: int = 20) -> list[float]:
    rows, columns = pixels.shape[0] // 2, pixels.shape[1] // 2
    spot = pixels[rows - edge : rows + edge, columns - edge : columns + edge]
    return [float(value) for value in spot.reshape(-1, 3).mean(axis=0)]


# The ground


@pytest.mark.parametrize("size", [0.004, 0.03, 0.3, 0.8, 0.99, 1.0, 2.0, 30.0, 450.0])
def test_squares_have_a_round_length_that_fits_the_robot(size: float) -> None:
    tile = tile_for(size)
    assert f"{tile / 10 ** math.floor(math.log10(tile) + 1e-9):.6g}" in {"1", "2", "5"}
    assert size / 5 - 1e-9 <= tile <= size / 2 + 1e-9


@pytest.mark.parametrize("size", [0.03, 0.8, 30.0])
def test_a_square_is_as_large_as_it_is_said_to_be(size: float) -> None:
    points = (
        np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)])
    ) * size
    camera = eye_camera(points, SIZE)
    tile = tile_for(extent(points))
    ground = Backdrop(camera, tile=tile, has_ground=True)
    assert ground.tile == tile
    view = camera.view

    def brightness(x: float, y: float) -> float:
        """Of the middle of the square that is so many squares from the world's middle."""
        point = view.matrix @ (np.array([x * tile, y * tile, 0.0]) - camera.eye)
        column, row, _ = view.project(point.astype(np.float32))
        return float(ground.color[:, int(row), int(column)].sum() * 255)

    center = brightness(0, 0)  # the middle of the world is the middle of a square
    others = [brightness(x, y) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    assert all(abs(center - other) > 30 for other in others)
    assert max(others) - min(others) < 15


def test_the_size_is_written_into_the_picture(tmp_path: Path) -> None:
    pixels, tile = photograph(tmp_path, piece(CUBE, at=STANDING))
    assert tile == 0.5
    assert pixels[-40:, :200].min() < 120  # darker than the ground ever is


def test_without_a_ground_there_is_a_plain_background(tmp_path: Path) -> None:
    pixels, tile = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=STANDING), world=VOID)
    assert tile is None
    around = pixels[~is_blue(pixels)]
    assert is_blue(pixels).mean() > 0.1
    assert np.median(around, axis=0).min() > 225
    assert (np.abs(around.astype(int) - np.median(around, axis=0)).max(axis=1) < 3).mean() > 0.98


def test_what_fell_through_the_ground_is_seen_and_the_depth_is_written(tmp_path: Path) -> None:
    fallen, tile = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=Pose((0.0, 0.0, -44.0))))
    standing, _ = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=STANDING))
    assert tile is None
    assert is_blue(fallen).mean() == pytest.approx(is_blue(standing).mean(), rel=0.02)
    assert fallen[-40:, :200].min() < 120  # "43 m under the ground"


def test_what_is_just_under_the_ground_shines_through_it(tmp_path: Path) -> None:
    sunk, tile = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=Pose((0.0, 0.0, -0.6))))
    standing, _ = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=STANDING))
    assert tile == 0.5
    faint, clear = middle(sunk), middle(standing)
    assert clear[0] < 20
    assert 80 < faint[0] < 170
    assert faint[2] > faint[0] + 10


def test_what_is_high_above_the_ground_has_no_squares_to_compare_with(tmp_path: Path) -> None:
    pixels, tile = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=Pose((0.0, 0.0, 900.0))))
    assert tile is None
    assert is_blue(pixels).mean() > 0.1


def test_what_is_nowhere_has_no_picture(tmp_path: Path) -> None:
    nowhere = Pose((math.nan, 0.0, 0.0))
    with pytest.raises(ValueError, match="not finite"):
        photograph(tmp_path, piece(CUBE, at=nowhere))


def test_a_part_that_is_nowhere_is_left_out(tmp_path: Path) -> None:
    lost = piece(CUBE, at=Pose((math.inf, 0.0, 0.0)), name="lost")
    pixels, tile = photograph(tmp_path, piece(CUBE, rgba=BLUE, at=STANDING), lost)
    assert tile == 0.5
    assert is_blue(pixels).mean() > 0.1


# Colors


@pytest.mark.parametrize("name", ["Green", "Red", "Blue", "Orange", "SkyBlue", "Purple", "Grey"])
def test_materials_keep_their_hue_and_a_lit_face_their_brightness(
    tmp_path: Path, name: str
) -> None:
    rgba = GAZEBO_COLORS[f"Gazebo/{name}"]
    pixels, _ = photograph(tmp_path, piece(Box(size=(1.0, 1.0, 0.05)), rgba=rgba))
    wanted = np.array(rgba[:3]) * 255
    top = np.array(middle(pixels))
    assert np.abs(top - wanted).max() < 25
    brightest = wanted.argmax()
    assert np.allclose(top / top[brightest], wanted / wanted[brightest], atol=0.03)


def test_black_shows_its_edges(tmp_path: Path) -> None:
    pixels, _ = photograph(tmp_path, piece(CUBE, rgba=(0.0, 0.0, 0.0, 1.0), at=STANDING))
    dark = pixels[(pixels.max(axis=2) < 40)]
    assert len(dark) > 0.1 * pixels.shape[0] * pixels.shape[1]
    assert dark.min() > 3
    assert len(np.unique(dark // 5)) >= 3  # three faces, each with its own light


def test_an_stl_without_normals_is_not_black(tmp_path: Path) -> None:
    file = tmp_path / "part.stl"
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles = np.zeros(4, dtype=record)
    a, b, c, d = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    triangles["corners"] = [(a, c, b), (a, b, d), (a, d, c), (b, c, d)]
    file.write_bytes(b"\0" * 80 + (4).to_bytes(4, "little") + triangles.tobytes())
    mesh = Mesh(uri="part.stl", path=str(file), bounds=((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    pixels, _ = photograph(tmp_path, piece(mesh, rgba=BLUE))
    assert is_blue(pixels).mean() > 0.1


@pytest.mark.parametrize("alpha", [0.3, 0.7])
def test_what_is_see_through_shows_what_is_behind(tmp_path: Path, alpha: float) -> None:
    core = Visual(geometry=Sphere(radius=0.3), rgba=(1.0, 0.0, 0.0, 1.0))
    shell = Visual(geometry=CUBE, rgba=(0.0, 0.0, 1.0, alpha))
    link = Link(name="base", visuals=(core, shell))
    pixels, _ = photograph(tmp_path, spawned(link, at=STANDING))
    red, green, blue = middle(pixels)
    assert green < 10
    assert red == pytest.approx((1 - alpha) * 255 * 0.8, abs=45)
    assert blue == pytest.approx(alpha * 255 * 0.8, abs=45)


def test_what_is_invisible_is_left_out(tmp_path: Path) -> None:
    core = Visual(geometry=Sphere(radius=0.3), rgba=(1.0, 0.0, 0.0, 1.0))
    shell = Visual(geometry=CUBE, rgba=(0.0, 0.0, 0.0, 0.05))
    pixels, _ = photograph(tmp_path, spawned(Link(name="base", visuals=(core, shell)), at=STANDING))
    red, green, blue = middle(pixels)
    assert red > 150
    assert max(green, blue) < 30


def test_what_is_see_through_throws_less_shadow(tmp_path: Path) -> None:
    def darkest(alpha: float) -> int:
        box = piece(CUBE, rgba=(1.0, 1.0, 1.0, alpha), at=STANDING)
        pixels, _ = photograph(tmp_path, box)
        return int(pixels[:-60].max(axis=2).min())

    assert darkest(1.0) + 20 < darkest(0.3)


def test_a_texture_is_shown_the_right_way_up(tmp_path: Path) -> None:
    file, image = tmp_path / "quad.obj", tmp_path / "quad.png"
    file.write_text(
        "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 -1 0\n"
        "f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n"
    )
    colors = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)]  # of the image's quarters
    quarters = Image.new("RGB", (2, 2))
    quarters.putdata(colors)
    quarters.resize((64, 64), Image.Resampling.NEAREST).save(image)
    content = read_mesh(file, with_materials=True)
    patch = content.patches[0]._replace(material=Material(image="quad.png"))
    colored, problems = AppearanceWriter(tmp_path).write(
        file, content._replace(patches=(patch,)), [False]
    )
    assert problems == []
    ((part,),) = colored
    mesh = Mesh(uri="quad.obj", path=part.path)
    wall = piece(mesh, rgba=None, texture=part.texture, at=Pose((0.0, 0.0, 1.0)))
    pixels, _ = photograph(tmp_path, wall)
    rows, columns = np.nonzero(pixels.max(axis=2).astype(int) - pixels.min(axis=2) > 100)
    width, height = np.ptp(columns), np.ptp(rows)
    spots = [
        pixels[int(rows.mean() + down * height / 5), int(columns.mean() + across * width / 5)]
        for down in (-1, 1)
        for across in (-1, 1)
    ]
    for spot, color in zip(spots, colors, strict=True):
        assert ((spot > 100) == (np.array(color) > 100)).all()


def test_a_broken_texture_is_not_shown(tmp_path: Path) -> None:
    """Pillow raises a SyntaxError where the length of a part of the file is wrong."""
    file = tmp_path / "noise.png"
    noise = np.random.default_rng(0).integers(0, 255, (40, 40, 3), dtype=np.uint8)
    Image.fromarray(noise).save(file)
    before, name, after = file.read_bytes().partition(b"IDAT")
    length = int.from_bytes(before[-4:], "big") - 100
    file.write_bytes(before[:-4] + length.to_bytes(4, "big") + name + after)
    white = (1.0, 1.0, 1.0, 1.0)
    plain, _ = photograph(tmp_path, piece(CUBE, rgba=white, at=STANDING))
    broken, _ = photograph(tmp_path, piece(CUBE, rgba=white, texture=str(file), at=STANDING))
    assert (plain == broken).all()


# What has nothing to show


def is_orange(pixels: Pixels) -> float:
    red, green, blue = np.moveaxis(pixels.astype(int), -1, 0)
    return float(((red > green + 25) & (green > blue + 25)).mean())


def test_a_link_without_a_visual_shows_its_collisions(tmp_path: Path) -> None:
    pixels, tile = photograph(tmp_path, touched_alone(CUBE, at=STANDING))
    assert tile == 0.5
    assert is_orange(pixels) > 0.1
    assert is_orange(photograph(tmp_path, piece(CUBE, at=STANDING))[0]) < 0.001


def test_a_mesh_that_was_not_found_is_replaced_by_the_collisions(tmp_path: Path) -> None:
    link = Link(
        name="base",
        visuals=(Visual(geometry=Mesh(uri="package://gone/part.dae")),),
        collisions=(Collision(geometry=Cylinder(radius=0.4, length=1.0)),),
    )
    pixels, _ = photograph(tmp_path, spawned(link, at=STANDING))
    assert is_orange(pixels) > 0.1


def test_an_invisible_visual_hides_the_collisions_of_a_robot_that_is_seen(tmp_path: Path) -> None:
    seen = Link(name="seen", visuals=(Visual(geometry=CUBE, rgba=BLUE),))
    hidden = Link(
        name="hidden",
        visuals=(Visual(geometry=CUBE, rgba=(1.0, 1.0, 1.0, 0.0)),),
        collisions=(Collision(geometry=Box(size=(2.0, 2.0, 2.0))),),
    )
    both = spawned(seen, at=STANDING)
    both = replace(both, robot=replace(both.robot, links=(seen, hidden)))
    assert is_orange(photograph(tmp_path, both)[0]) < 0.001
    alone = spawned(hidden, at=STANDING)
    assert is_orange(photograph(tmp_path, alone)[0]) > 0.1


def test_a_robot_of_nothing_still_has_a_picture(tmp_path: Path) -> None:
    pixels, tile = photograph(tmp_path, spawned(Link(name="base")), corners=[(0.0, 0.0, 0.0)])
    assert tile == 0.5
    assert pixels.mean() > 150


# The world


def test_the_first_picture_is_about_the_robots_and_shows_what_is_near(tmp_path: Path) -> None:
    robot = piece(CUBE, rgba=BLUE, at=STANDING)
    beside = piece(CUBE, rgba=(1.0, 0.0, 0.0, 1.0), at=Pose((0.0, 1.2, 0.5)), name="crate")
    static_models = replace(beside, is_static_model=True)
    alone, _ = photograph(tmp_path, robot)
    with_static_models, _ = photograph(tmp_path, robot, static_models)
    as_robots, _ = photograph(tmp_path, robot, beside)
    is_red = (with_static_models[..., 0] > 120) & (with_static_models[..., 1:].max(axis=2) < 60)
    assert is_red.mean() > 0.02
    assert is_blue(with_static_models).sum() == pytest.approx(is_blue(alone).sum(), rel=0.05)
    assert is_blue(as_robots).sum() < 0.8 * is_blue(alone).sum()
    # A car of the world that can drive is seen beside the robot, and makes it no smaller.
    car = piece(Box(size=(8.0, 2.0, 2.0)), at=Pose((0.0, 4.0, 1.0)), name="car")
    with_car, _ = photograph(tmp_path, robot, replace(car, is_of_world=True))
    assert is_blue(with_car).sum() == pytest.approx(is_blue(alone).sum(), rel=0.05)
    # A world by itself is seen whole.
    whole, _ = photograph(tmp_path, *(replace(one, is_of_world=True) for one in (robot, car)))
    assert is_blue(whole).sum() < 0.5 * is_blue(alone).sum()


def test_a_static_model_before_a_robot_does_not_hide_it(tmp_path: Path) -> None:
    robot = piece(CUBE, rgba=BLUE, at=STANDING)
    wall = piece(
        Box(size=(0.1, 6.0, 3.0)), at=Pose((2.0, 0.0, 1.5)), name="wall", is_static_model=True
    )
    pixels, _ = photograph(tmp_path, robot, wall)
    assert is_blue(pixels).sum() == pytest.approx(
        is_blue(photograph(tmp_path, robot)[0]).sum(), rel=0.02
    )


def world_picture(folder: Path, *static_models: tuple[Box, Vector]) -> Pixels:
    robot = piece(CUBE, rgba=BLUE, at=STANDING)
    around = [
        piece(box, rgba=(0.6, 0.6, 0.6, 1.0), at=Pose(at), name=str(number), is_static_model=True)
        for number, (box, at) in enumerate(static_models)
    ]
    file = folder / "world.png"
    scene_renderer_of(robot, *around).draw_world(file)
    return pixels_of(file)


def test_the_picture_of_the_world_shows_static_models(tmp_path: Path) -> None:
    pixels = world_picture(tmp_path, (CUBE, (8.0, 0.0, 0.5)), (CUBE, (-3.0, 4.0, 0.5)))
    assert pixels.shape == (360, 480, 3)
    assert 0.001 < is_blue(pixels).mean() < 0.05


@pytest.mark.parametrize("side", [(2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0)])
def test_the_picture_of_the_world_is_taken_from_where_walls_hide_nothing(
    tmp_path: Path, side: tuple[float, float]
) -> None:
    size = (0.1, 5.0, 4.0) if side[0] else (5.0, 0.1, 4.0)
    open_ground = world_picture(tmp_path, (Box(size=(5.0, 5.0, 0.001)), (*side, 0.0)))
    behind_a_wall = world_picture(tmp_path, (Box(size=size), (*side, 2.0)))
    assert is_blue(behind_a_wall).sum() > 0.25 * is_blue(open_ground).sum()


def test_static_models_throw_no_shadow_into_the_picture_of_the_robots(tmp_path: Path) -> None:
    robot = piece(CUBE, rgba=BLUE, at=STANDING)
    roof = piece(
        Box(size=(4.0, 4.0, 0.1)), at=Pose((0.0, 0.0, 6.0)), name="roof", is_static_model=True
    )
    assert np.array_equal(photograph(tmp_path, robot)[0], photograph(tmp_path, robot, roof)[0])


def test_what_is_endless_does_not_make_all_tiny(tmp_path: Path) -> None:
    near = (CUBE, (2.0, 0.0, 0.5))
    plain = world_picture(tmp_path, near)
    endless = world_picture(
        tmp_path, near, (Box(size=(1000.0, 1000.0, 0.001)), (0.0, 0.0, -0.0005))
    )
    far = world_picture(tmp_path, near, (CUBE, (5000.0, 0.0, 0.5)))
    assert is_blue(plain).mean() > 0.02
    for picture in (endless, far):
        assert is_blue(picture).sum() == pytest.approx(is_blue(plain).sum(), rel=0.02)


def test_a_wide_slab_at_the_height_of_the_ground_does_not_hide_its_squares(tmp_path: Path) -> None:
    robot = piece(CUBE, rgba=BLUE, at=STANDING)
    slab = piece(
        Box(size=(100.0, 100.0, 0.1)), at=Pose((0.0, 0.0, -0.05)), name="slab", is_static_model=True
    )
    alone, _ = photograph(tmp_path, robot)
    on_slab, _ = photograph(tmp_path, robot, slab)
    assert np.array_equal(alone, on_slab)


# Light


def test_gazebo_s_own_sun_is_drawn_as_ours_and_another_one_as_it_shines() -> None:
    assert sun_of(GROUND) == (SUN, True)
    assert sun_of(replace(GROUND, sun_direction=(0.6, 0.0, -0.8))) == ((-0.6, 0.0, 0.8), True)
    assert not sun_of(replace(GROUND, sun_direction=(1.0, 0.0, 0.0)))[1]


def test_the_shadow_falls_away_from_the_world_s_light(tmp_path: Path) -> None:
    pole = piece(Box(size=(0.1, 0.1, 1.0)), rgba=BLUE, at=STANDING)
    to_the_right = photograph(tmp_path, pole, world=replace(GROUND, sun_direction=(0.5, 0.5, -0.7)))
    to_the_left = photograph(
        tmp_path, pole, world=replace(GROUND, sun_direction=(-0.5, -0.5, -0.7))
    )
    half = to_the_left[0].shape[1] // 2

    def shadow(pixels: Pixels, columns: slice) -> int:
        part = pixels[:650, columns]
        return int(((part.max(axis=2) < 150) & ~is_blue(part)).sum())

    assert shadow(to_the_right[0], slice(half, None)) > 5 * shadow(to_the_right[0], slice(0, half))
    assert shadow(to_the_left[0], slice(0, half)) > 5 * shadow(to_the_left[0], slice(half, None))


def test_a_light_from_straight_above(tmp_path: Path) -> None:
    pixels, _ = photograph(
        tmp_path,
        piece(CUBE, rgba=BLUE, at=STANDING),
        world=replace(GROUND, sun_direction=(0, 0, -1)),
    )
    assert is_blue(pixels).mean() > 0.1


# Captions


def word_gap(height: int) -> float:
    """What part of the length of a caption its one space takes, in a picture of this height."""
    image = Image.new("RGB", (height * 4 // 3, height), "white")
    write_caption(image, ["drive forward"])
    ink = np.flatnonzero((np.asarray(image.convert("L")) < 225).any(axis=0))
    return float(np.diff(ink).max() / (ink[-1] - ink[0]))


@pytest.mark.parametrize("height", [240, 360, 720])
def test_the_words_of_a_small_caption_stand_apart_as_those_of_a_large_one(height: int) -> None:
    assert word_gap(height) >= 0.95 * word_gap(2400)


def test_a_caption_may_be_wider_than_the_picture(tmp_path: Path) -> None:
    image = Image.new("RGB", (80, 60), "white")
    write_caption(image, ["a line that is longer than the picture", "and another"])
    assert image.size == (80, 60)

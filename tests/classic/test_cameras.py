"""What cameras of Gazebo Classic see, and what wsgen's see in live runs in their place.

`recorded/cameras.json` was recorded with Debian 11's Gazebo 11.1, which draws by Mesa into Xvfb:
where things are in the pictures, pixels, the colors of what is painted, and depths, m.
`--regenerate` records it anew where that is unpacked, and writes the picture of the docs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from classic.gazebo_classic import HOST, NEEDS_CLASSIC, GazeboClassic, inside, recorded_in
from classic.views import (
    NAMED,
    PAINTED,
    VIEWS,
    place,
    placed,
    robot_of,
    station,
    write_world,
)
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.test_sensors import mounted, run
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.model.robot import Link, Robot
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

RECORDED = Path(__file__).with_name("recorded") / "cameras.json"
PICTURE = Path(__file__).parents[2] / "docs" / "pictures" / "camera-beside-gazebo.png"
SAME_SIZE = 0.02  # of the width and the height of a thing; or a pixel
SAME_DEPTH, EDGES = 0.01, 0.003  # of a depth; of all pixels, how many may be on another thing
SAME_COLOR = 16  # of 255: highlights are not drawn here
ODD = 0.03  # of all pixels, how many may have another color: a sphere has flat triangles here
EVERY, APART = 12, 32  # pixels, from a depth (a color) that is recorded to the next

# What has another color than there, and why.
GLOW = "drawn white there, by this Mesa"
DIFFERENT = {
    **{f"Gazebo/{name}Glow": GLOW for name in ("Turquoise", "Green", "Blue", "Yellow", "Purple")},
}


class Seen(NamedTuple):
    """Pictures of a camera."""

    rgb: NDArray[np.uint8]  # height by width by 3
    depth: NDArray[np.float32] | None  # height by width, m


def summary(name: str, seen: Seen) -> dict[str, Any]:
    """What is compared of the pictures of a view."""
    answer: dict[str, Any] = {"boxes": boxes(name, seen.rgb)}
    if seen.depth is not None:
        grid = seen.depth[EVERY // 2 :: EVERY, EVERY // 2 :: EVERY]
        answer["depths"] = [round(float(one), 3) for one in grid.ravel()]
    if name not in TILES:
        colors = seen.rgb[APART // 2 :: APART, APART // 2 :: APART]
        answer["pixels"] = colors.reshape(-1, 3).tolist()
    else:
        answer["colors"] = {
            paint: tile(name, number, seen.rgb) for number, paint in enumerate(TILES[name])
        }
    return answer


TILES = {"names": tuple(NAMED), "paints": tuple(PAINTED)}


def boxes(name: str, rgb: NDArray[np.uint8]) -> dict[str, list[int]]:
    """The first and the last column and row of each thing, by its color."""
    if name in TILES:
        return {}
    pixels = rgb.astype(int)
    if name == "robot":
        ground = pixels[0, 0]
        return {"robot": box(np.abs(pixels - ground).max(axis=2) > DISTINCT)}
    found = {}
    for channel, color in enumerate(("red", "green", "blue")):
        mask = pixels[..., channel] - np.delete(pixels, channel, axis=2).max(axis=2) > DISTINCT
        if mask.any():
            found[color] = box(mask)
    return found


DISTINCT = 40  # of 255


def box(mask: NDArray[np.bool_]) -> list[int]:
    rows, columns = np.nonzero(mask)
    return [int(one) for one in (columns.min(), columns.max(), rows.min(), rows.max())]


def tile(name: str, number: int, rgb: NDArray[np.uint8]) -> list[int]:
    """The mean color in the middle of a tile, from 0 to 255."""
    view = VIEWS[name]
    (width, height), (up, left) = view.size, place(number)
    focal = width / 2 / math.tan(view.field_of_view / 2)  # pixels
    far = view.camera.xyz[2] - 0.1  # m, to the upper side
    row, column = round(height / 2 - up * focal / far), round(width / 2 - left * focal / far)
    patch = rgb[row - 4 : row + 4, column - 4 : column + 4]
    return [round(float(one)) for one in patch.mean(axis=(0, 1))]


def ask(names: Iterable[str], folder: Path) -> dict[str, Seen]:
    """What Gazebo Classic's cameras see."""
    world, urdf, raw = write_world(folder, HOST), folder / "robot.urdf", folder / "raw"
    one = robot_of(folder)
    urdf.write_text(one.urdf, encoding="utf-8")
    found = {}
    with GazeboClassic(world, has_display=True) as gazebo:
        gazebo.ask("spawn", inside(urdf), "robot", 0, station("robot"), 0, 0, 0, 0)
        gazebo.run(1.0)
        for name in names:
            view, number = VIEWS[name], list(VIEWS).index(name)
            shape = view.size[::-1]
            gazebo.ask("picture", f"camera{number}", inside(raw))
            rgb, depth = np.fromfile(raw, np.uint8).reshape(*shape, 3), None
            if view.is_deep:
                gazebo.ask("picture", f"depth{number}", inside(raw))
                depth = np.fromfile(raw, "<f4").reshape(shape)
                # Its plugins get the end of the clip, for which the sensor itself has infinity.
                depth[np.isposinf(depth)] = view.clip[1]
            found[name] = Seen(rgb, depth)
    return found


@pytest.fixture(scope="module")
def recorded(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, own: dict[str, Seen]
) -> Any:
    real: dict[str, Seen] = {}

    def answer(name: str) -> dict[str, Any]:
        if not real:
            real.update(ask(VIEWS, tmp_path_factory.mktemp("views")))
            beside = np.hstack([real["robot"].rgb, own["robot"].rgb])
            Image.fromarray(beside).save(PICTURE, optimize=True)
        return summary(name, real[name])

    return recorded_in(RECORDED, request, VIEWS, answer)


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Seen]:
    """What wsgen's cameras see of the same world, as its plugins publish it."""
    with pytest.MonkeyPatch.context() as patch:
        install_sensor_messages(patch)
        return published(tmp_path_factory.mktemp("own"))


def published(folder: Path) -> dict[str, Seen]:
    world = read_sdf(write_world(folder), find_model=lambda _: None)
    things = [
        SpawnedRobot(
            entity=model.name,
            robot=model.robot,
            pose_in_world=model.pose_in_world,
            is_static_model=True,
        )
        for model in world.models
        if model.robot is not None and any(link.visuals for link in model.robot.links)
    ]
    # It stands there as it is spawned.
    template = SpawnedRobot(
        entity="robot",
        robot=replace(robot_of(folder).robot, is_static=True),
        pose_in_world=Pose((0.0, station("robot"), 0.0)),
        is_static_model=True,
    )
    plugin = "<plugin name='p' filename='libgazebo_ros_camera.so'><min_depth>0</min_depth></plugin>"
    sensors = [
        mounted(
            f"<sensor name='{kind}{number}' type='{kind}'>{view.lens()}{plugin}</sensor>",
            placed(name),
        )
        for number, (name, view) in enumerate(VIEWS.items())
        for kind in view.kinds
    ]
    holder = replace(Robot(name="h", root="base", links=(Link(name="base"),)), is_static=True)
    ros = run(*sensors, robot=holder, pose=IDENTITY, others=(*things, template), seconds=0.001)
    found = {}
    for number, (name, view) in enumerate(VIEWS.items()):
        shape = view.size[::-1]
        image = ros.published(f"/camera{number}/image_raw")[-1]
        rgb, depth = np.frombuffer(bytes(image.data), np.uint8).reshape(*shape, 3), None
        if view.is_deep:
            image = ros.published(f"/depth{number}/depth/image_raw")[-1]
            depth = np.frombuffer(bytes(image.data), "<f4").reshape(shape)
        found[name] = Seen(rgb, depth)
    return found


@pytest.mark.oracle
@pytest.mark.slow
@NEEDS_CLASSIC
def test_the_record_is_what_gazebo_classic_sees(recorded: Any, tmp_path: Path) -> None:
    name = "near and far"
    assert summary(name, ask([name], tmp_path)[name]) == recorded[name]


@pytest.mark.parametrize("name", [name for name in VIEWS if name not in TILES])
def test_things_are_as_large_and_where_they_are_there(
    name: str, own: dict[str, Seen], recorded: Any
) -> None:
    found, expected = boxes(name, own[name].rgb), recorded[name]["boxes"]
    assert found.keys() == expected.keys()
    for color, real in expected.items():
        size = real[1] - real[0], real[3] - real[2]
        for end, (one, other) in enumerate(zip(found[color], real, strict=True)):
            assert abs(one - other) <= max(1, SAME_SIZE * size[end // 2]), (color, end)


@pytest.mark.parametrize("name", [name for name, view in VIEWS.items() if view.is_deep])
def test_depths_are_those_there(name: str, own: dict[str, Seen], recorded: Any) -> None:
    """Where nothing is, too: that is the end of the clip."""
    found = np.array(summary(name, own[name])["depths"])
    real = np.array(recorded[name]["depths"])
    assert np.mean(np.abs(found - real) > SAME_DEPTH * real) <= EDGES


@pytest.mark.parametrize(
    ("name", "paint"), [(name, paint) for name, paints in TILES.items() for paint in paints]
)
def test_colors_are_those_there(name: str, paint: str, own: dict[str, Seen], recorded: Any) -> None:
    """In the sun, from above."""
    found = tile(name, TILES[name].index(paint), own[name].rgb)
    real = recorded[name]["colors"][paint]
    is_same = found == pytest.approx(real, abs=SAME_COLOR)
    assert is_same == (paint not in DIFFERENT)


@pytest.mark.parametrize("name", [name for name in VIEWS if name not in TILES])
def test_light_and_shade_are_those_there(name: str, own: dict[str, Seen], recorded: Any) -> None:
    """On all sides, on the ground and above; a mesh without normals is in the shade there."""
    found = np.array(summary(name, own[name])["pixels"])
    real = np.array(recorded[name]["pixels"])
    assert np.mean(np.abs(found - real).max(axis=1) > SAME_COLOR) <= ODD

"""Things to photograph, and the photographs, without an engine and a child process."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from wsgen.model.robot import Collision, Geometry, Link, Robot, Visual
from wsgen.model.transform import IDENTITY, Pose
from wsgen.model.world import World
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.rendering.render_items import Rgba

    Pixels = NDArray[np.uint8]  # height by width by 3

GROUND = World(name="ground", has_ground_plane=True)
VOID = World(name="void")
BLUE: Rgba = (0.0, 0.0, 1.0, 1.0)
GREEN: Rgba = (0.0, 1.0, 0.0, 1.0)


def piece(
    geometry: Geometry,
    *,
    rgba: Rgba | None = GREEN,
    texture: str | None = None,
    at: Pose = IDENTITY,
    name: str = "e",
    is_static_model: bool = False,
) -> SpawnedRobot:
    """A robot of one visual."""
    link = Link(name="base", visuals=(Visual(geometry=geometry, rgba=rgba, texture=texture),))
    return spawned(link, at=at, name=name, is_static_model=is_static_model)


def touched_alone(geometry: Geometry, *, at: Pose = IDENTITY) -> SpawnedRobot:
    """A robot of one collision."""
    return spawned(Link(name="base", collisions=(Collision(geometry=geometry),)), at=at)


def spawned(
    link: Link, *, at: Pose = IDENTITY, name: str = "e", is_static_model: bool = False
) -> SpawnedRobot:
    robot = Robot(name="r", root=link.name, links=(link,))
    return SpawnedRobot(entity=name, robot=robot, pose_in_world=at, is_static_model=is_static_model)


def scene_renderer_of(
    *robots: SpawnedRobot,
    world: World = GROUND,
    corners: list[tuple[float, float, float]] | None = None,
) -> SceneRenderer:
    """With each robot's one link where it is spawned."""
    return SceneRenderer(
        Scene(world=world, robots=robots),
        {one.entity: {link.name: one.pose_in_world for link in one.robot.links} for one in robots},
        {one.entity: corners or [one.pose_in_world.xyz] for one in robots},
    )


def photograph(
    folder: Path,
    *robots: SpawnedRobot,
    world: World = GROUND,
    corners: list[tuple[float, float, float]] | None = None,
) -> tuple[Pixels, float | None]:
    """The picture of robots, and what its squares are."""
    file = folder / "picture.png"
    tile = scene_renderer_of(*robots, world=world, corners=corners).draw(file)
    return pixels_of(file), tile


def pixels_of(file: Path) -> Pixels:
    with Image.open(file) as image:
        return np.asarray(image.convert("RGB"))


def is_blue(pixels: Pixels) -> NDArray[np.bool_]:
    red, green, blue = np.moveaxis(pixels.astype(int), -1, 0)
    found: NDArray[np.bool_] = (blue > red + 60) & (blue > green + 60)
    return found


def margins(mask: NDArray[np.bool_]) -> tuple[float, float, float, float]:
    """How far what is marked keeps from left, right, top, bottom: shares of width and height."""
    rows, columns = np.nonzero(mask)
    height, width = mask.shape
    return (
        columns.min() / width,
        1 - (columns.max() + 1) / width,
        rows.min() / height,
        1 - (rows.max() + 1) / height,
    )

"""Makes a picture of what a renderer gives: robots on a checkered ground, with their shadows.

A square of the ground has an edge of a round length (1, 2 or 5 times a power of ten), which is
written into the picture: with it sizes can be read off.

The only module that imports NumPy and Pillow; load it when a picture is wanted. The renderer draws
the robots alone, at twice the size; ground, shadow and sky are computed here, once for every pixel
of the picture, because a ground of triangles would cost most of the time and still have no edges.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from wsgen.simulation.shot import Camera, Shot

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.model.transform import Vector

    Floats = NDArray[np.float64]

WIDTH, HEIGHT = 960, 720  # pixels of the picture
OVERSAMPLED = 2  # edges of the robots are smoothed by so much
SHADOW_PIXELS = 512

FIELD_OF_VIEW = 32.0  # degrees, vertical
FROM = (0.72, -0.62, 0.36)  # direction from the robot to the camera: three-quarter view
SUN = (0.15, -0.55, 1.0)  # direction from the robot to the light
SUN_DISTANCE = 40.0  # radii of what is seen; so far that its rays are nearly parallel
ROOM = 1.5  # how much larger than the robots the view is

SKY_LOW, SKY_HIGH = (0.93, 0.95, 0.97), (0.72, 0.82, 0.92)
TILE_LIGHT, TILE_DARK = (0.86, 0.87, 0.88), (0.77, 0.79, 0.81)
SHADE = 0.42  # of the ground's light that a shadow takes
SUNK = 1e-3  # of the farthest distance: what the depth buffer cannot tell from the ground
CELLS = 3.0  # checker tiles across the robots, about

# Of 256 levels, either way: without it the levels of a surface that slowly turns from the light
# are seen as bands.
DITHER = 1.0
LABEL_SIZE, LABEL_MARGIN, LABEL_COLOUR = 18, 14, (70, 78, 88)  # pixels, pixels, red green blue


def cameras(points: Iterable[Vector]) -> tuple[Camera, Camera]:
    """A camera and a light that take in the points and the ground below them."""
    corners = np.array(list(points), dtype=float)
    low, high = corners.min(axis=0), corners.max(axis=0)
    low[2] = min(low[2], 0.0) if low[2] < high[2] - low[2] else low[2]
    centre = (low + high) / 2
    radius = max(float(np.linalg.norm(high - low)) / 2, 1e-3)
    distance = ROOM * radius / math.sin(math.radians(FIELD_OF_VIEW / 2)) / 1.25
    eye = _camera(centre, FROM, distance, radius, FIELD_OF_VIEW, WIDTH, HEIGHT, OVERSAMPLED)
    spread = math.degrees(2 * math.atan(1.1 / SUN_DISTANCE))
    away = SUN_DISTANCE * radius
    return eye, _camera(centre, SUN, away, radius, spread, SHADOW_PIXELS, SHADOW_PIXELS, 1)


def _camera(  # noqa: PLR0913, PLR0917  an optical set-up has this many parts
    centre: Floats,
    direction: Vector,
    distance: float,
    radius: float,
    field_of_view: float,
    width: int,
    height: int,
    oversampled: int,
) -> Camera:
    eye = centre + distance * np.array(direction) / np.linalg.norm(direction)
    return Camera(
        eye=_vector(eye),
        target=_vector(centre),
        field_of_view=field_of_view,
        aspect=width / height,
        near=max(distance - 2 * radius, distance / 100),
        far=distance + 4 * radius,
        width=width * oversampled,
        height=height * oversampled,
    )


def save(shot: Shot, light: Shot, file: Path) -> float:
    """Put robots, ground, shadow and sky together and write a PNG.

    Gives the edge of the ground's squares in the picture, m.
    """
    tile = _tile(shot.camera)
    ground = _ground(shot, light, tile)
    colour = np.asarray(shot.rgba, dtype=np.uint8).reshape(shot.camera.height, -1, 4).copy()
    colour[..., 3] = np.where(_seen(shot), 255, 0)
    robots = np.asarray(
        Image.fromarray(colour).resize((WIDTH, HEIGHT), Image.Resampling.BOX), dtype=float
    )
    cover = robots[..., 3:] / 255
    noise = np.random.default_rng(0).uniform(-DITHER, DITHER, cover.shape)  # the same every time
    picture = cover * (robots[..., :3] + noise) + (1 - cover) * ground * 255
    image = Image.fromarray((picture + 0.5).clip(0, 255).astype(np.uint8))
    ImageDraw.Draw(image).text(
        (LABEL_MARGIN, HEIGHT - LABEL_MARGIN),
        f"1 square = {tile:g} m",
        fill=LABEL_COLOUR,
        font=ImageFont.load_default(LABEL_SIZE),
        anchor="ls",
    )
    image.save(file, format="PNG")
    return tile


def _seen(shot: Shot) -> NDArray[np.bool_]:
    """Where a robot is seen, and not the ground above it."""
    shape = (shot.camera.height, shot.camera.width)
    seen = np.asarray(shot.body).reshape(shape) >= 0
    rows, columns = np.nonzero(seen)
    depth = np.asarray(shot.depth, dtype=float).reshape(shape)[rows, columns]
    clip = np.stack(
        [
            (columns + 0.5) / shape[1] * 2 - 1,
            1 - (rows + 0.5) / shape[0] * 2,
            depth * 2 - 1,
            np.ones_like(depth),
        ]
    )
    world = np.linalg.solve(_matrix(shot.projection) @ _matrix(shot.view), clip)
    seen[rows, columns] = world[2] / world[3] > -SUNK * shot.camera.far
    return seen


def _ground(shot: Shot, light: Shot, tile: float) -> Floats:
    """Checkered ground, shadow and sky behind the robots, red, green and blue from 0 to 1."""
    camera = shot.camera
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    x = ((columns + 0.5) / WIDTH * 2 - 1) * math.tan(math.radians(camera.field_of_view / 2))
    y = (1 - (rows + 0.5) / HEIGHT * 2) * math.tan(math.radians(camera.field_of_view / 2))
    rays = np.stack([x * camera.aspect, y, -np.ones_like(x)], axis=-1) @ _matrix(shot.view)[:3, :3]
    hits = rays[..., 2] < -1e-6  # noqa: PLR2004  looks down, and not along the ground
    reach = np.where(hits, -camera.eye[2] / np.where(hits, rays[..., 2], -1.0), 0.0)
    hits &= reach > 0
    on_ground = camera.eye[:2] + reach[..., None] * rays[..., :2]
    size = math.dist(camera.eye, camera.target)
    tiles = _tiles(on_ground, tile, reach)
    tiles *= 1 - SHADE * _shadow(on_ground, hits, light)[..., None]
    haze = np.clip((reach / size - 1.2) / 4.5, 0, 1)[..., None]
    height = np.clip(rays[..., 2:] / 0.5, 0, 1) ** 0.8
    sky = np.array(SKY_LOW) * (1 - height) + np.array(SKY_HIGH) * height
    haze = haze * haze * (3 - 2 * haze)
    return np.where(hits[..., None], tiles * (1 - haze) + np.array(SKY_LOW) * haze, sky)


def _tile(camera: Camera) -> float:
    """A round length for the edge of a square, m."""
    distance = math.dist(camera.eye, camera.target)
    half_height = distance * math.tan(math.radians(camera.field_of_view / 2))
    wanted = half_height / CELLS * 1.5
    power = 10.0 ** math.floor(math.log10(wanted))
    edge = next((step * power for step in (1, 2, 5) if step * power >= wanted), 10 * power)
    return float(f"{edge:.1g}")  # 0.2 and not 0.20000000000000001


def _tiles(on_ground: Floats, cell: float, reach: Floats) -> Floats:
    """A checker whose edges are smoothed over the width of a pixel."""
    pixel = np.maximum(reach * math.radians(FIELD_OF_VIEW) / HEIGHT / cell, 1e-9)[..., None]
    # A triangle wave of period 2, of height 1, steep where tiles meet.
    wave = np.abs((on_ground / cell) % 2 - 1) - 0.5
    square = np.clip(wave / pixel, -1, 1).prod(axis=-1) / 2 + 0.5
    fade = np.clip(1 - pixel[..., 0] * 3, 0, 1)  # tiles smaller than a pixel are one grey
    square = (square - 0.5) * fade + 0.5
    light, dark = np.array(TILE_LIGHT), np.array(TILE_DARK)
    tiles: Floats = dark + (light - dark) * square[..., None]
    return tiles


def _shadow(on_ground: Floats, hits: NDArray[np.bool_], light: Shot) -> Floats:
    """How much of the light is kept off each point of the ground, 0 to 1, with soft edges."""
    size = light.camera.width
    mask = np.asarray(light.body).reshape(size, size) >= 0
    soft = Image.fromarray(np.where(mask, 255, 0).astype(np.uint8))
    values = np.asarray(soft.filter(ImageFilter.GaussianBlur(size / 170)), dtype=float) / 255
    transform = _matrix(light.projection) @ _matrix(light.view)
    points = on_ground[hits]
    clip = transform[:, :2] @ points.T + transform[:, 3:]
    column = (clip[0] / clip[3] + 1) / 2 * size - 0.5
    row = (1 - clip[1] / clip[3]) / 2 * size - 0.5
    inside = (column >= 0) & (row >= 0) & (column < size - 1) & (row < size - 1)
    column, row = column[inside], row[inside]
    left, top = column.astype(int), row.astype(int)
    across, down = column - left, row - top
    values_inside = (values[top, left] * (1 - across) + values[top, left + 1] * across) * (
        1 - down
    ) + (values[top + 1, left] * (1 - across) + values[top + 1, left + 1] * across) * down
    shadow = np.zeros(hits.shape)
    spots = np.zeros(len(points))
    spots[inside] = values_inside
    shadow[hits] = spots
    return shadow


def _matrix(column_major: tuple[float, ...]) -> Floats:
    matrix: Floats = np.array(column_major, dtype=float).reshape(4, 4).T
    return matrix


def _vector(numbers: Floats) -> Vector:
    return (float(numbers[0]), float(numbers[1]), float(numbers[2]))

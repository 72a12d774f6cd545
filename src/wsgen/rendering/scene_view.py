"""What a page shows of a scene: its pictures, small, and surfaces to look at from any side.

Surfaces have fewer triangles than they are made of, and look almost the same: corners that lie
close together become one.
"""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.model.outcome import ViewPart
from wsgen.model.robot import Box, Mesh
from wsgen.rendering.surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray
    from PIL.Image import Image

    from wsgen.rendering.render_items import RenderItem, Rgba
    from wsgen.rendering.renderer import Placed

    Doubles = NDArray[np.float64]
    Indices = NDArray[np.int64]


FINEST = 1024  # cells along the longest edge of the box around all: what is smaller is not seen
ROUNDS = 12  # in which the size of a cell is found
ENOUGH = 0.85  # of the triangles that there may be


class Triangles(NamedTuple):
    """Corners, and triangles between them."""

    corners: Doubles  # n by 3, m
    triangles: Indices  # n by 3, numbers of corners


def merge(corners: Doubles, keys: Doubles | None = None) -> Triangles:
    """Triangles (n by 3 corners by 3 coordinates) with each corner once; none without area.

    Corners are the same where all of `keys` (n by 3 by any) are, which are the coordinates if they
    are not given.
    """
    flat = corners.reshape(-1, 3)
    rows = flat if keys is None else keys.reshape(len(flat), -1)
    same = np.ascontiguousarray(rows + 0.0).view([("", rows.dtype)] * rows.shape[1]).ravel()
    _, first, numbers = np.unique(same, return_index=True, return_inverse=True)
    return _without_flat(Triangles(flat[first], numbers.reshape(-1, 3)))


def simplify(meshes: Sequence[Triangles], most: int) -> list[Triangles]:
    """The meshes with at most so many triangles in all, or about that; each keeps some.

    Space is divided into cubic cells, and the corners of a mesh that are in one cell become one, in
    their middle (Rossignac and Borrel 1993). The cells are as small as there may be triangles.
    """
    if _total(meshes) <= most:
        return list(meshes)
    low = np.min([mesh.corners.min(axis=0) for mesh in meshes if len(mesh.corners)], axis=0)
    high = np.max([mesh.corners.max(axis=0) for mesh in meshes if len(mesh.corners)], axis=0)
    size = float(np.max(high - low)) or 1.0
    # What is seen of no cell is left out first, so that the rounds have less to do.
    fine = [_clustered(mesh, low, size / FINEST) for mesh in meshes]
    best, cells = fine, (size / FINEST, size)
    if _total(fine) > most:
        best = [_clustered(mesh, low, size) for mesh in fine]
        for _ in range(ROUNDS):
            middle = (cells[0] * cells[1]) ** 0.5
            found = [_clustered(mesh, low, middle) for mesh in fine]
            if _total(found) > most:
                cells = (middle, cells[1])
                continue
            best, cells = found, (cells[0], middle)
            if _total(found) >= ENOUGH * most:
                break
    return [
        one if len(one.triangles) else _box_around(mesh)
        for one, mesh in zip(best, meshes, strict=True)
    ]


def _total(meshes: Sequence[Triangles]) -> int:
    return sum(len(mesh.triangles) for mesh in meshes)


CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)  # counter-clockwise, seen from outside


def _box_around(mesh: Triangles) -> Triangles:
    """What a mesh becomes that is smaller than a cell."""
    if not len(mesh.corners):
        return mesh
    low, high = mesh.corners.min(axis=0), mesh.corners.max(axis=0)
    triangles = np.concatenate([FACES[:, [0, 1, 2]], FACES[:, [0, 2, 3]]])
    return Triangles(low + CORNERS * (high - low), triangles)


def _clustered(mesh: Triangles, low: Doubles, cell: float) -> Triangles:
    if not len(mesh.corners):
        return mesh
    places = np.floor((mesh.corners - low) / cell).astype(np.int64)
    keys = (places[:, 0] << 42) | (places[:, 1] << 21) | places[:, 2]
    _, numbers = np.unique(keys, return_inverse=True)
    count = np.bincount(numbers)
    corners = np.stack(
        [np.bincount(numbers, weights=mesh.corners[:, axis]) / count for axis in range(3)], axis=1
    )
    return _without_flat(Triangles(corners, numbers[mesh.triangles]))


def _without_flat(mesh: Triangles) -> Triangles:
    """Without triangles that have a corner twice, and without second ones of the same corners."""
    a, b, c = mesh.triangles.T
    triangles = mesh.triangles[(a != b) & (b != c) & (a != c)]
    if len(triangles):
        _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
        triangles = triangles[np.sort(first)]
    used, numbers = np.unique(triangles, return_inverse=True)
    return Triangles(mesh.corners[used], numbers.reshape(-1, 3))


QUALITY = 80  # of WebP, of 100
AROUND, RINGS = 32, 12  # of round shapes; pictures have three times as many
LEVELS = 65535  # of a coordinate
COLORS = 6  # levels of red, green and blue that are distinguished in a texture
FOR_ROBOTS = 0.75  # of the triangles, where the world has more than the rest
NORMAL_STEPS = 50.0  # of a unit vector; corners whose normals differ by less are one


class View(NamedTuple):
    """The surfaces of a scene."""

    parts: tuple[ViewPart, ...]
    triangles: int  # of all parts
    triangles_before: int  # before they were simplified


class _Key(NamedTuple):
    """What the triangles of a part have in common."""

    entity: str
    link: str
    rgba: Rgba
    is_round: bool
    is_robot: bool


def as_webp(image: Image) -> str:
    """An image as WebP, in base64."""
    stream = io.BytesIO()
    image.save(stream, format="WEBP", quality=QUALITY, method=4)
    return base64.b64encode(stream.getvalue()).decode()


def view_of(placed: Iterable[Placed], most: int) -> View:
    """The surfaces, with at most so many triangles in all, or about that.

    Robots keep more of theirs than the models of the world.
    """
    found: dict[_Key, list[Triangles]] = {}
    for one in placed:
        for key, mesh in _colored(one):
            if len(mesh.triangles) and np.isfinite(mesh.corners).all():
                found.setdefault(key, []).append(mesh)
    joined = {key: _joined(meshes) for key, meshes in found.items()}
    before = _count(joined)
    robots = {key: mesh for key, mesh in joined.items() if key.is_robot}
    others = {key: mesh for key, mesh in joined.items() if not key.is_robot}
    least = min(_count(others), round(most * (1 - FOR_ROBOTS)))
    robots = _simplified(robots, most - least)
    others = _simplified(others, most - _count(robots))
    simple = {**robots, **others}
    return View(
        tuple(_part(key, mesh) for key, mesh in simple.items() if len(mesh.triangles)),
        _count(simple),
        before,
    )


def _count(meshes: Mapping[_Key, Triangles]) -> int:
    return sum(len(mesh.triangles) for mesh in meshes.values())


def _simplified(meshes: Mapping[_Key, Triangles], most: int) -> dict[_Key, Triangles]:
    return dict(zip(meshes, simplify(list(meshes.values()), most), strict=True))


def _colored(placed: Placed) -> Iterator[tuple[_Key, Triangles]]:
    """The triangles of an item in the world, by their color."""
    item = placed.item
    is_round = not isinstance(item.geometry, Box | Mesh)
    surface = placed.surface
    if not isinstance(item.geometry, Mesh):
        surface = surface_of(item.geometry, AROUND, RINGS)
    corners = surface.corners.astype(np.float64)  # 3 coordinates by 3 corners by n
    world = np.einsum("ij,jkn->nki", placed.linear, corners) + placed.shift
    keys = None
    if is_round and surface.normals is not None:
        normals = np.round(surface.normals.astype(np.float64) * NORMAL_STEPS)
        keys = np.concatenate([corners, normals]).transpose(2, 1, 0)
    if placed.texels is None:
        yield _key(item, item.rgba, is_round=is_round), merge(world, keys)
        return
    levels = np.round(placed.texels * np.array(item.rgba[:3])[:, None] * (COLORS - 1)).astype(int)
    number = (levels[0] * COLORS + levels[1]) * COLORS + levels[2]
    for one in np.unique(number):
        of_it = number == one
        red, green, blue = (float(level[of_it][0]) / (COLORS - 1) for level in levels)
        key = _key(item, (red, green, blue, item.rgba[3]), is_round=is_round)
        yield key, merge(world[of_it], None if keys is None else keys[of_it])


def _key(item: RenderItem, rgba: Rgba, *, is_round: bool) -> _Key:
    return _Key(item.entity, item.link, rgba, is_round, item.is_subject)


def _joined(meshes: list[Triangles]) -> Triangles:
    starts = np.cumsum([0, *(len(mesh.corners) for mesh in meshes[:-1])])
    return Triangles(
        np.concatenate([mesh.corners for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)]
        ),
    )


def _part(key: _Key, mesh: Triangles) -> ViewPart:
    low, high = mesh.corners.min(axis=0), mesh.corners.max(axis=0)
    step = np.where(high > low, (high - low) / LEVELS, 1.0)
    levels = np.round((mesh.corners - low) / step).astype("<u2")
    is_wide = len(mesh.corners) > LEVELS
    x, y, z = map(float, low)
    by_x, by_y, by_z = map(float, step)
    red, green, blue, alpha = (round(float(value), 3) for value in key.rgba)
    return ViewPart(
        entity=key.entity,
        link=key.link,
        rgba=(red, green, blue, alpha),
        is_round=key.is_round,
        is_robot=key.is_robot,
        low=(x, y, z),
        step=(by_x, by_y, by_z),
        corners=base64.b64encode(levels.tobytes()).decode(),
        triangles=base64.b64encode(
            mesh.triangles.astype("<u4" if is_wide else "<u2").tobytes()
        ).decode(),
        has_wide_numbers=is_wide,
    )

"""What a page shows of a scene: its pictures, small, and surfaces to look at from any side."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.model.outcome import ViewPart
from wsgen.model.robot import Box, Mesh
from wsgen.rendering.simplify import Triangles, merge, simplify
from wsgen.rendering.surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from numpy.typing import NDArray
    from PIL.Image import Image

    from wsgen.rendering.render_items import RenderItem, Rgba
    from wsgen.rendering.renderer import Placed

    Doubles = NDArray[np.float64]

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

"""The renderer: sees a world of render items through a camera, and shades what it sees.

It needs no display and no engine. `Renderer.sense` gives depth and segmentation images, which are
what a depth camera would measure, and `Renderer.paint` colors.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PIL import Image, ImageFilter

from wsgen.model.robot import Box, Mesh, Paint
from wsgen.model.transform import IDENTITY, rotation_of_rpy
from wsgen.rendering.camera import Size, View, eye_camera
from wsgen.rendering.rasterizer import Grid
from wsgen.rendering.render_items import RenderItem
from wsgen.rendering.surfaces import Surface, is_closed, outline, surface_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from numpy.typing import NDArray

    from wsgen.model.robot import Primitive
    from wsgen.model.transform import Vector
    from wsgen.rendering.camera import Camera
    from wsgen.rendering.rasterizer import Floats, Indices, Keys
    from wsgen.rendering.render_items import Poses

    Doubles = NDArray[np.float64]


# A face that looks into the light is as bright as its color, as in Gazebo; one that looks away
# keeps the ambient share …
AMBIENT, SUN = 0.5, 0.42
SKY, FILL = 0.07, 0.08  # … and little more towards the sky and the camera: shape is seen in shadow
STEP = 2  # pixels from one to the next at which it is computed how much of the sky is open
DIRECTIONS, NEAR_SHARE = 16, 0.4  # in which that is looked for; how far in every second, of radius
OCCLUSION = 2.2  # of the ambient light that a corner loses
SMOOTH = ImageFilter.GaussianBlur(1.5)
SHINE, SHININESS = 0.1, 5  # of the light that is mirrored; how often its cosine is squared
FAINT = 0.35  # opacity of what is under the ground
BIAS, STEEPEST = 0.75, 8.0  # pixels of the sun's view: what is as near is lit; the steepest plane
GRAZING = 0.25  # sine of the angle between light and surface, below which shadows fade
BLOCK = 2**16  # samples that are shaded at a time
SOLID = 0.95  # of alpha: what has less is transparent
NOWHERE = -1e9  # in a view: neither before a camera nor in the sun's square


class _Part(NamedTuple):
    """A render item, and which of all triangles are its own."""

    item: RenderItem
    surface: Surface
    own: slice
    outline: Floats  # corners that it lies between, 3 by n


class Placed(NamedTuple):
    """A render item where it is in the world."""

    item: RenderItem
    surface: Surface
    linear: Doubles  # 3 by 3, to the world
    shift: Doubles  # m
    texels: Floats | None  # of its texture in the middle of each triangle, 3 by n, 0 to 1


class Seen(NamedTuple):
    """What a view sees at some samples."""

    view: View
    corners: Floats  # of all triangles in the view, 3 by 3 by n
    grid: Grid
    solid: Keys  # for each sample what is seen of solid items, as `rasterizer` has it; 0: nothing
    transparent: Keys | None  # likewise of transparent ones, as if they were solid

    @property
    def nearest(self) -> Keys:
        """What is seen of all, as if nothing were transparent."""
        return self.solid if self.transparent is None else np.maximum(self.solid, self.transparent)

    def surface(self, samples: Indices, keys: Keys) -> tuple[Floats, ...]:
        """The column, the row, and in the view: the point that is seen, its triangle.

        Of the triangle it is the first corner, and the two sides from there (each 3 by n).
        """
        x, y = self.grid.places(samples)
        depth = 1 / nearness_of(keys)
        point = np.stack([x - self.view.width / 2, y - self.view.height / 2, depth])
        point[:2] *= depth
        triangle = triangles_of(keys)
        first, second, third = (
            self.corners[:, corner].take(triangle, axis=1) for corner in range(3)
        )
        return x, y, point, first, second - first, third - first


class Light(NamedTuple):
    """What keeps light from things, or from the eye."""

    shadow: Shadow | None
    sunk: float | None  # m; what is deeper under the ground is faint; None: nothing
    sky: Floats | None = None  # of `Renderer.open_sky`; None: all of it everywhere


class Sensed(NamedTuple):
    """A depth image and a segmentation image, height by width."""

    depth: Floats  # m, along the camera's axis; infinite where nothing is seen
    item: NDArray[np.int32]  # number in `Renderer.items`, or NOTHING


NOTHING = -1


class Renderer:
    """A world of render items; nothing is seen of them before they are arranged."""

    def __init__(self, items: Iterable[RenderItem], *, towards_light: Vector) -> None:
        """`towards_light` is a direction in the world."""
        # What is solid is first.
        self.items = sorted(items, key=lambda item: item.rgba[3] < SOLID)
        self._light = _unit(np.array(towards_light, dtype=np.float32))
        self._parts: list[_Part] = []
        start = 0
        for item in self.items:
            surface = surface_of(_key(item))
            stop = start + surface.corners.shape[2]
            self._parts.append(_Part(item, surface, slice(start, stop), outline(surface)))
            start = stop
        self._item = np.repeat(
            np.arange(len(self._parts), dtype=np.int32),
            [part.own.stop - part.own.start for part in self._parts],
        )
        self._rgba = np.array([item.rgba for item in self.items], dtype=np.float32).reshape(-1, 4)
        paints = [item.paint or Paint(item.rgba, item.rgba) for item in self.items]
        # Ambient, diffuse and emissive colors, for `flat_colors`: n by 3 by 3.
        self._paints = np.array(paints, dtype=np.float32).reshape(-1, 3, 4)[..., :3]
        self.opacity = np.where(self._rgba[:, 3] < SOLID, self._rgba[:, 3], np.float32(1))
        # Where items are: a linear map and a shift, m; None where that is not known.
        self._places: list[tuple[Doubles, Doubles] | None] = [None] * len(self._parts)
        self._removed: set[int] = set()
        self._upright = np.zeros((len(self._parts), 3, 3), dtype=np.float32)  # normals to the world
        self._textures = {
            number: texture
            for number, item in enumerate(self.items)
            if item.texture is not None
            and self._parts[number].surface.texture_points is not None
            and (texture := _load_texture(item.texture)) is not None
        }
        self._normals: Floats | None = None
        if any(part.surface.normals is not None for part in self._parts):
            self._normals = np.full((3, 3, start), np.nan, dtype=np.float32)
            for part in self._parts:
                if part.surface.normals is not None:
                    self._normals[..., part.own] = part.surface.normals

    @functools.cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Which items have a surface without a border: its back is never seen."""
        return np.array([is_closed(_key(item)) for item in self.items], dtype=np.bool_)

    @property
    def triangles(self) -> int:
        """How many are drawn of all items."""
        return len(self._item)

    def arrange(self, poses: Poses, *, least: float = 0.0) -> bool:
        """Put everything where its link is; without a finite pose it keeps its place.

        What is of no robot that is there is not shown.

        So does what would move by `least` (m) or less. Gives whether anything has moved.
        """
        has_moved = False
        for number, item in enumerate(self.items):
            pose, place = item.pose(poses), self._places[number]
            if place is not None and item.entity not in poses:  # it was deleted
                self._places[number] = None
                has_moved = True
            if pose is not None and number not in self._removed:
                scale = item.geometry.scale if isinstance(item.geometry, Mesh) else (1.0, 1.0, 1.0)
                rotation = np.array(rotation_of_rpy(pose.rpy))
                linear, shift = rotation * np.array(scale), np.array(pose.xyz)
                if place is not None:
                    apart = (linear - place[0]) @ self._parts[number].outline
                    apart += (shift - place[1])[:, None]
                    if np.square(apart).sum(axis=0).max(initial=0) <= least**2:
                        continue
                has_moved = True
                self._places[number] = linear, shift
                finite = [1 / part if part and math.isfinite(part) else 1.0 for part in scale]
                self._upright[number] = rotation * np.array(finite)
        return has_moved

    def points(self, which: Callable[[RenderItem], bool] = lambda _: True) -> dict[int, Doubles]:
        """Points (n by 3, m, in the world) that what is anywhere lies between, by its number."""
        return {
            number: part.outline.T @ place[0].T + place[1]
            for number, part in enumerate(self._parts)
            if which(part.item) and (place := self._places[number]) and part.surface.corners.size
        }

    def placed(self) -> Iterator[tuple[int, Placed]]:
        """What is anywhere, with its number."""
        for number, (part, place) in enumerate(zip(self._parts, self._places, strict=True)):
            if place is not None:
                texture, points = self._textures.get(number), part.surface.texture_points
                texels = None
                if texture is not None and points is not None:
                    texels = _texels(texture, points.mean(axis=1))
                yield number, Placed(part.item, part.surface, *place, texels)

    def remove(self, which: Callable[[RenderItem, Doubles], bool]) -> None:
        """Have no place from now on for what is such a render item and lies between such points."""
        for number, points in self.points().items():
            if which(self.items[number], points):
                self._places[number] = None
                self._removed.add(number)

    def _corners(self, view: View, without: Callable[[RenderItem], bool]) -> Floats:
        """The corners of all triangles in a view."""
        corners = np.empty((3, 3, self.triangles), dtype=np.float32)
        for part, place in zip(self._parts, self._places, strict=True):
            own = corners[..., part.own]
            if place is None or without(part.item):
                own[...] = NOWHERE
                continue
            linear = (view.matrix @ place[0]).astype(np.float32)
            shift = (view.matrix @ (place[1] - view.origin)).astype(np.float32)
            given = part.surface.corners
            np.add(
                (linear @ given.reshape(3, -1)).reshape(given.shape), shift[:, None, None], out=own
            )
        return corners

    def see(  # noqa: PLR0913  most have defaults
        self,
        view: View,
        chosen: NDArray[np.bool_] | None = None,
        samples: int = 4,
        *,
        without: Callable[[RenderItem], bool] = lambda _: False,
        before: Seen | None = None,
        fronts: NDArray[np.bool_] | None = None,
    ) -> Seen:
        """What is seen in a view: in each pixel, or at several samples of the chosen ones.

        What is known saves work: what was seen `before` in each pixel of the same view, and which
        items show nothing but `fronts` (triangles counter-clockwise).
        """
        turned = None if fronts is None else fronts[self._item]
        grid = Grid(view.width, view.height, chosen, samples)
        corners = self._corners(view, without) if before is None else before.corners
        drawn = int(np.searchsorted(self._item, np.count_nonzero(self.opacity == 1)))
        solid = _drawn(view, grid, corners, range(drawn), turned)
        if drawn == self.triangles:
            return Seen(view, corners, grid, solid, None)
        transparent = _drawn(view, grid, corners, range(drawn, self.triangles), turned)
        return Seen(view, corners, grid, solid, transparent)

    def items_of(self, keys: Keys) -> NDArray[np.int32]:
        """The numbers of the items that are seen."""
        return self._item[triangles_of(keys)]

    def sense(self, camera: Camera) -> Sensed:
        """How far away what a camera sees is, and which item: what is transparent is solid."""
        view = camera.view
        seen = self.see(view)
        keys = seen.nearest
        depth = np.full(keys.shape, np.inf)
        item = np.full(keys.shape, NOTHING, dtype=np.int32)
        places = np.flatnonzero(keys)
        depth[places] = 1 / nearness_of(keys[places]).astype(np.float64)
        item[places] = self.items_of(keys[places])
        shape = (view.height, view.width)
        return Sensed(depth.astype(np.float32).reshape(shape), item.reshape(shape))

    def paint(self, colors: Floats, seen: Seen, light: Light) -> NDArray[np.bool_]:
        """Put what is seen over the colors (3 by samples, 0 to 1) that are behind it.

        The colors are changed. Gives for each item whether all that is seen of it are fronts.
        """
        fronts = np.ones(len(self.items), dtype=np.bool_)
        for keys in (seen.solid, seen.transparent):
            if keys is None:
                continue
            is_seen = keys > (0 if keys is seen.solid else seen.solid)
            places = np.flatnonzero(is_seen)
            for start in range(0, len(places), BLOCK):
                block = places[start : start + BLOCK]
                rgb, alpha = self._shade(seen, block, keys[block], light, fronts)
                behind = colors[:, block]
                colors[:, block] = behind + (rgb - behind) * alpha
        return fronts

    def flat_colors(
        self, seen: Seen, *, ambient: float, sun: Vector
    ) -> tuple[NDArray[np.intp], Floats]:
        """The colors of what is solid, a tenth of the work of `paint`: one for each triangle.

        The light is that of Gazebo: `ambient` (0 to 1) everywhere, and the color of the `sun`.
        For each sample the place of its color among the colors (n by 3, 0 to 1); the first is for
        where nothing is seen. Textures are left out.
        """
        triangle = (seen.solid & np.uint64(0xFFFFFFFF)).astype(np.intp)  # and 1
        is_drawn = np.zeros(self.triangles + 1, dtype=np.bool_)
        is_drawn[triangle] = True
        is_drawn[0] = False
        drawn = np.flatnonzero(is_drawn)
        place = np.zeros(self.triangles + 1, dtype=np.intp)
        place[drawn] = np.arange(1, len(drawn) + 1)
        drawn -= 1
        first, second, third = (seen.corners[:, corner].take(drawn, axis=1) for corner in range(3))
        normal = _normal(seen.view, _cross(second - first, third - first), first)[0]
        lit = np.outer(np.maximum(self._light @ normal, 0), np.array(sun, np.float32))
        dull, bright, own = self._paints[self._item[drawn]].transpose(1, 0, 2)
        colors = np.zeros((len(drawn) + 1, 3), dtype=np.float32)
        colors[1:] = np.minimum(ambient * dull + lit * bright + own, 1)
        return place.take(triangle), colors

    def texels(self, seen: Seen) -> Iterator[tuple[Indices, Floats]]:
        """Samples (one in each pixel) of what is solid and has a texture, with its colors there.

        The colors (3 by n, 0 to 1) are to be multiplied with those of `flat_colors`. That is a
        fifth of the work of `paint`: over a triangle, texture points are a projective function of
        the pixel.
        """
        if not self._textures:
            return
        width, height = seen.view.width, seen.view.height
        triangle = seen.solid.astype(np.uint32)  # and 1
        for number, image in self._textures.items():
            part = self._parts[number]
            points, start = part.surface.texture_points, part.own.start + 1
            samples = np.flatnonzero((triangle >= start) & (triangle < part.own.stop + 1))
            if points is None or not len(samples):
                continue
            a, b, c = seen.corners[..., part.own].astype(np.float64).transpose(1, 0, 2)
            sides = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)])
            sides /= np.abs(sides).max(axis=(0, 1)) + np.finfo(np.float64).tiny
            across = np.concatenate([points, np.ones((1, *points.shape[1:]))])
            # Coordinate of the texture (the last one divides), then that of the pixel.
            planes = np.einsum("pct,cdt->pdt", across, sides).astype(np.float32)
            for first in range(0, len(samples), BLOCK):
                block = samples[first : first + BLOCK]
                row, column = np.divmod(block.astype(np.int32), np.int32(width))
                x = column + np.float32(0.5 - width / 2)
                y = row + np.float32(0.5 - height / 2)
                own = planes.take(triangle[block] - start, axis=2)
                u, v, scale = own[:, 0] * x + own[:, 1] * y + own[:, 2]
                with np.errstate(divide="ignore", invalid="ignore"):
                    yield block, _texels(image, np.stack([u, v]) / scale)

    def transparent(self, seen: Seen) -> Seen | None:
        """What is seen through something transparent, of which that is known alone."""
        if seen.transparent is None:
            return None
        transparent = np.where(seen.transparent > seen.solid, seen.transparent, np.uint64(0))
        if not transparent.any():
            return None
        return seen._replace(solid=np.zeros_like(seen.solid), transparent=transparent)

    def open_sky(self, seen: Seen, radius: float) -> Floats:
        """How open the half-space before what is seen is, 0 to 1, of every second column and row.

        What is seen in some directions, up to a radius (m) away, is compared with the tangent
        plane: in corners and beside other things it rises over that.
        """
        view = seen.view
        height, width = -(-view.height // STEP), -(-view.width // STEP)
        keys = seen.nearest.reshape(view.height, view.width)[::STEP, ::STEP].ravel()
        places = np.flatnonzero(keys)
        row, column = np.divmod(places, width)
        samples = (row * view.width + column) * STEP
        _, _, point, _, second, third = seen.surface(samples, keys[places])
        points = np.full((3, height, width), 1e6, dtype=np.float32)  # in the world, from the eye
        points.reshape(3, -1)[:, places] = np.linalg.inv(view.matrix).astype(np.float32) @ point
        normals = np.zeros((3, height, width), dtype=np.float32)
        normals.reshape(3, -1)[:, places] = _normal(view, _cross(second, third), point)[0]
        blocked = np.zeros((height, width), dtype=np.float32)
        depth = float(np.median(point[2])) if len(places) else np.inf
        reach = radius * float(np.linalg.norm(view.matrix[0])) / STEP / depth
        for turn in range(DIRECTIONS):
            share = NEAR_SHARE if turn % 2 else 1.0
            angle = 2 * math.pi * turn / DIRECTIONS
            down, right = (
                round(share * reach * part) for part in (math.sin(angle), math.cos(angle))
            )
            here = _window(height, down), _window(width, right)
            there = _window(height, -down), _window(width, -right)
            apart = points[:, there[0], there[1]] - points[:, here[0], here[1]]
            square = _dot(apart, apart) + np.float32(1e-12)
            rise = np.maximum(_dot(apart, normals[:, here[0], here[1]]), 0) / np.sqrt(square)
            blocked[here] += rise * np.maximum(1 - square / np.float32(radius**2), 0)
        open_share = 1 - np.minimum(blocked * (OCCLUSION / DIRECTIONS), 1)
        image = Image.fromarray((open_share * 255).astype(np.uint8)).filter(SMOOTH)
        sky: Floats = np.asarray(image, dtype=np.float32) / np.float32(255)
        return sky

    def _shade(
        self, seen: Seen, samples: Indices, keys: Keys, light: Light, fronts: NDArray[np.bool_]
    ) -> tuple[Floats, Floats]:
        """The color of samples (3 by n, 0 to 1) and their opacity (n)."""
        view, axis = seen.view, seen.view.axis.astype(np.float32)
        triangle, item = triangles_of(keys), self.items_of(keys)
        x, y, point, first, second, third = seen.surface(samples, keys)
        across = _cross(second, third)
        normal, is_back = _normal(view, across, point)
        flat = normal
        fronts[item[is_back]] = False
        rgb = self._rgba.T[:3].take(item, axis=1)
        if self._normals is not None or self._textures:
            weights = _weights(point - first, second, third, across)
            if self._normals is not None:
                local = _between(self._normals.take(triangle, axis=2), weights)
                normal = self._smooth(normal, local, item)
            for number, image in self._textures.items():
                part = self._parts[number]
                of_it = np.flatnonzero(item == number)
                points = part.surface.texture_points
                if len(of_it) and points is not None:
                    around = points.take(triangle[of_it] - part.own.start, axis=2)
                    rgb[:, of_it] *= _texels(image, _between(around, weights[:, of_it]))
        lit = np.maximum(self._light @ normal, 0)
        half = np.nan_to_num(_unit(self._light - axis))
        shine = np.maximum(half @ normal, 0)
        for _ in range(SHININESS):
            shine *= shine
        if light.shadow is not None:
            towards = np.flatnonzero(lit)
            share = light.shadow.light_at(view, point[:, towards], flat[:, towards])
            # Where light only just reaches a smooth surface, its triangles shade each other.
            share += (1 - share) * np.maximum(1 - lit[towards] / GRAZING, 0)
            lit[towards] *= share
            shine[towards] *= share
        fill = np.abs(axis @ normal)
        ambient = AMBIENT + SKY * normal[2] + FILL * fill
        if light.sky is not None:
            columns = x.astype(np.intp) // STEP
            ambient *= light.sky.take(y.astype(np.intp) // STEP * light.sky.shape[1] + columns)
        rgb *= ambient + SUN * lit
        rgb += SHINE * shine * (lit > 0)
        alpha = self.opacity.take(item)
        if light.sunk is not None:
            height = np.linalg.inv(view.matrix)[2].astype(np.float32) @ point
            height += np.float32(view.origin[2])
            alpha[height < -light.sunk] *= FAINT
        return np.minimum(rgb, 1, out=rgb), alpha

    def _smooth(self, flat: Floats, local: Floats, item: NDArray[np.int32]) -> Floats:
        """Normals of a mesh in the world, on the side of the flat ones; those where it has none."""
        upright = self._upright.reshape(-1, 9).T.take(item, axis=1).reshape(3, 3, -1)
        smooth = _unit(_between(upright, local))
        side = _dot(smooth, flat)
        smooth *= np.where(side < 0, np.float32(-1), np.float32(1))
        return np.where(np.isfinite(side), smooth, flat)


def _key(item: RenderItem) -> Primitive | str:
    """What its surface is known by."""
    return str(item.geometry.path) if isinstance(item.geometry, Mesh) else item.geometry


def _drawn(
    view: View, grid: Grid, corners: Floats, which: range, turned: NDArray[np.bool_] | None
) -> Keys:
    """What is seen of some of the triangles."""
    keys = np.zeros(grid.samples, dtype=np.uint64)
    start = which.start
    corners = corners[..., start : which.stop]
    is_before = corners[2] < np.float32(view.nearest or -np.inf)
    if not is_before.any():
        numbers = np.arange(start, which.stop)
        grid.draw(keys, *view.project(corners), numbers, turned)
        return keys
    before = is_before.sum(axis=0)
    whole = np.flatnonzero(before == 0)
    grid.draw(keys, *view.project(corners.take(whole, axis=2)), whole + start, turned)
    for count in (1, 2):
        cut = np.flatnonzero(before == count)
        if len(cut):
            # The corner that is alone on its side of the plane comes first.
            lone = (is_before[:, cut] == (count == 1)).argmax(axis=0)
            order = (lone + np.arange(3)[:, None]) % 3
            a, b, c = np.take_along_axis(corners[..., cut], order[None], axis=1).transpose(1, 0, 2)
            ab, ac = (_at_depth(a, end, view.nearest or 0.0) for end in (b, c))
            pieces = [(a, ab, ac)] if count == 2 else [(ab, b, c), (ab, c, ac)]  # noqa: PLR2004
            for piece in pieces:
                grid.draw(keys, *view.project(np.stack(piece, axis=1)), cut + start, turned)
    return keys


def _at_depth(inside: Floats, outside: Floats, depth: float) -> Floats:
    """Where lines between points (3 by n) are at a depth."""
    share = (np.float32(depth) - inside[2]) / (outside[2] - inside[2])
    points: Floats = inside + (outside - inside) * share
    points[2] = depth
    return points


def triangles_of(keys: Keys) -> Indices:
    """The numbers of the triangles that are seen."""
    numbers: Indices = (keys & np.uint64(0xFFFFFFFF)).astype(np.intp) - 1
    return numbers


def nearness_of(keys: Keys) -> Floats:
    """How near is what is seen."""
    near: Floats = (keys >> np.uint64(32)).astype(np.uint32).view(np.float32)
    return near


def _normal(view: View, across: Floats, point: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Unit vectors in the world, towards the eye; and whether that is a triangle's back."""
    normal = _unit(view.matrix.T.astype(np.float32) @ across)
    is_back = _dot(across, point) > 0
    normal[:, is_back] *= -1
    return normal, is_back


def _window(length: int, shift: int) -> slice:
    """The part of a row that is still in it when it is shifted."""
    return slice(max(0, -shift), min(length, length - shift))


def _cross(a: Floats, b: Floats) -> Floats:
    (ax, ay, az), (bx, by, bz) = a, b
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _dot(a: Floats, b: Floats) -> Floats:
    product: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def _unit(vectors: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        units: Floats = vectors / _dot(vectors, vectors) ** 0.5
    return units


def _weights(point: Floats, one: Floats, other: Floats, across: Floats) -> Floats:
    """The weights of a triangle's corners at a point (3 by n).

    The first corner is the origin; `one` and `other` are the sides from it, `across` their product.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        across = across / _dot(across, across)
    second = np.clip(np.nan_to_num(_dot(_cross(point, other), across)), 0, 1)
    third = np.clip(np.nan_to_num(_dot(_cross(one, point), across)), 0, 1 - second)
    return np.stack([1 - second - third, second, third])


def _between(corners: Floats, weights: Floats) -> Floats:
    """What is between three corners (any by 3 by n)."""
    found: Floats = corners[:, 0] * weights[0]
    found += corners[:, 1] * weights[1]
    found += corners[:, 2] * weights[2]
    return found


MOST_TEXELS = 4096  # along each side


def _load_texture(file: str) -> Floats | None:
    """An image, as 3 by height by width, 0 to 1; None if it cannot be read."""
    try:
        with Image.open(file) as image:
            image.thumbnail((MOST_TEXELS, MOST_TEXELS))
            pixels = np.asarray(image.convert("RGB"), dtype=np.float32)
    except Exception:  # noqa: BLE001  Pillow raises anything on broken images
        return None
    colors: Floats = np.ascontiguousarray(pixels.transpose(2, 0, 1)) / np.float32(255)
    return colors


def _texels(image: Floats, place: Floats) -> Floats:
    """The colors (3 by n) at places (2 by n) of an image that is repeated, between its pixels."""
    _, height, width = image.shape
    place = np.nan_to_num(place - np.floor(place))
    x, y = place[0] * width - 0.5, (1 - place[1]) * height - 0.5
    left, top = np.floor(x), np.floor(y)
    across, down = x - left, y - top
    left, top = left.astype(np.intp), top.astype(np.intp)
    # They are at most one beside the image; a remainder takes longer than all the rest.
    columns = np.where(left < 0, width - 1, left), np.where(left + 1 == width, 0, left + 1)
    rows = np.where(top < 0, height - 1, top) * width, np.where(top + 1 == height, 0, top + 1)
    flat = image.reshape(3, -1)
    found: Floats = np.zeros((3, place.shape[1]), dtype=np.float32)
    for row, by_row in ((rows[0], 1 - down), (rows[1] * width, down)):
        for column, by_column in ((columns[0], 1 - across), (columns[1], across)):
            found += flat.take(row + column, axis=1) * (by_row * by_column)
    return found


class Shadow:
    """What a sun sees, and so what has no light."""

    def __init__(self, seen: Seen, renderer: Renderer) -> None:
        self.view = seen.view
        keys = seen.nearest
        size = self.view.width
        frame = np.zeros((size, size), dtype=bool)
        frame[1:-1, 1:-1] = True  # what reaches over the border casts no streaks from there
        keys = np.where(frame.ravel(), keys, 0)
        self.near = nearness_of(keys)
        self.shade = np.zeros(len(keys), dtype=np.float32)
        covered = np.flatnonzero(keys)
        self.shade[covered] = renderer.opacity[renderer.items_of(keys[covered])]
        self.is_solid = bool((renderer.opacity == 1).all())

    def on_ground(self) -> Floats:
        """How much light each pixel of the sun's view keeps from the ground, height by width."""
        size, sun = self.view.width, self.view
        # How near the ground is there: the nearness is linear in columns and rows.
        to_world = np.linalg.inv(sun.matrix)
        column, row, near = to_world[2]
        places = np.arange(size) + 0.5 - size / 2
        ground = -(sun.origin[2] + column * places + row * places[:, None]) / near
        shade = np.where(self.near.reshape(size, size) > ground, self.shade.reshape(size, size), 0)
        return shade.astype(np.float32)

    def light_at(self, view: View, points: Floats, normals: Floats) -> Floats:
        """The share of light (0 to 1) at points of a view (3 by n) with normals in the world.

        It is the mean of that of some pixels of the sun's view. Each is compared with the plane
        that the point lies in: so a plane throws no shadow on itself, however steep the light is.
        """
        sun, size = self.view, self.view.width
        to_sun = sun.matrix @ np.linalg.inv(view.matrix)
        shift = sun.matrix @ (view.origin - sun.origin)
        x, y, near = to_sun.astype(np.float32) @ points + shift.astype(np.float32)[:, None]
        plane = np.linalg.inv(sun.matrix).T.astype(np.float32) @ normals
        texel = np.float32(np.linalg.norm(sun.matrix[2]) / np.linalg.norm(sun.matrix[0]))
        steepest = STEEPEST * texel
        with np.errstate(divide="ignore", invalid="ignore"):
            grow_x = np.clip(-plane[0] / plane[2], -steepest, steepest)
            grow_y = np.clip(-plane[1] / plane[2], -steepest, steepest)
        x += np.float32(size / 2 - 0.5)
        y += np.float32(size / 2 - 0.5)
        left, top = np.floor(x), np.floor(y)
        right_part, lower_part = x - left, y - top
        near = near + BIAS * texel - grow_x * (1 + right_part) - grow_y * (1 + lower_part)
        place = np.clip(top - 1, 0, size - 4).astype(np.intp) * size
        place += np.clip(left - 1, 0, size - 4).astype(np.intp)
        shade = np.zeros_like(x)
        for row, by_row in enumerate((1 - lower_part, None, None, lower_part)):
            line = np.zeros_like(x)
            limit = near + grow_y * row
            for column, by_column in enumerate((1 - right_part, None, None, right_part)):
                at = place + (row * size + column)
                part = (self.near.take(at) > limit).astype(np.float32)
                if not self.is_solid:
                    part *= self.shade.take(at)
                if by_column is not None:
                    part *= by_column
                line += part
                limit += grow_x
            shade += line if by_row is None else line * by_row
        light: Floats = 1 - shade / np.float32(9)
        return light


def draw_a_box() -> bool:
    """Whether this machine can draw: a box, of which something must be seen."""
    box = Box(size=(1.0, 1.0, 1.0))
    renderer = Renderer(
        [RenderItem(entity="", link="", geometry=box, rgba=(1.0, 0.0, 0.0, 1.0))],
        towards_light=(0.0, 0.0, 1.0),
    )
    renderer.arrange({"": {"": IDENTITY}})
    (points,) = renderer.points().values()
    camera = eye_camera(points, Size(8, 6))
    colors = np.zeros((3, 8 * 6), dtype=np.float32)
    renderer.paint(colors, renderer.see(camera.view), Light(None, None))
    return bool((renderer.sense(camera).item == 0).any() and colors.any())

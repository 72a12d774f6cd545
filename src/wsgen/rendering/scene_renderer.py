"""Draws the pictures of a scene, for a file and for a page, and the surfaces that a page shows.

Import it only where a picture is wanted: loading NumPy and Pillow takes as long as a simulation.

Surfaces have fewer triangles than they are made of, and look almost the same: corners that lie
close together become one.
"""

from __future__ import annotations

import base64
import functools
import io
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.model.outcome import SceneView, ViewPart
from wsgen.model.robot import Box, Mesh
from wsgen.model.world import SUN_DIRECTION
from wsgen.rendering.camera import FROM, Size, TurnedCamera, extent, eye_camera, slope_of, sun_view
from wsgen.rendering.picture import (
    Backdrop,
    draw_arrow,
    image_of,
    tile_for,
    write_caption,
    write_png,
)
from wsgen.rendering.render_items import list_render_items, subjects
from wsgen.rendering.renderer import Light, Renderer, Shadow
from wsgen.rendering.surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from PIL.Image import Image

    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.rendering.camera import Floats, Floats32
    from wsgen.rendering.render_items import Poses, RenderItem, Rgba
    from wsgen.rendering.renderer import Placed
    from wsgen.simulation.scene import Push, Scene

    Doubles = NDArray[np.float64]
    Indices = NDArray[np.int64]


SAME_SUN = 0.999  # cosine of an angle
SUN: Vector = (0.15, -0.55, 1.0)  # towards ours: the three-quarter view is clearest so
SHADOW = 0.7  # of a picture's height, how many pixels wide its shadow is drawn
EDGE = 0.03  # of the light: pixels that differ by more are drawn more finely
NOOK = 0.08  # of the robots' size: things nearer than that take light of the sky from each other
UNSEEN = 0.05  # of a pixel: how far things move that look as before
ARROW = 0.35  # of the robots' size, how long an arrow is
SUNK = 1e-4  # of the farthest distance: what is not deeper under the ground lies on it
STEEP = 0.15  # sine of how high the light must stand to draw a shadow that is not endless


def sun_of(world: World) -> tuple[Vector, bool]:
    """The direction towards the sun, and whether it stands high enough to draw shadows.

    It is the world's own if that has another light than Gazebo's.
    """
    shines = world.sun_direction
    if _cosine(shines, SUN_DIRECTION) > SAME_SUN:
        return SUN, True
    towards = (-shines[0], -shines[1], -shines[2])
    return towards, towards[2] / math.hypot(*towards) > STEEP


def _cosine(one: Vector, other: Vector) -> float:
    product = sum(a * b for a, b in zip(one, other, strict=True))
    return product / max(math.hypot(*one) * math.hypot(*other), 1e-12)


class CameraSetup:
    """A camera, a sun and a background: takes pictures of one size from one place."""

    def __init__(  # noqa: PLR0913  a set-up has this many parts
        self,
        renderer: Renderer,
        world: World,
        points: Floats,
        size: Size,
        *,
        towards: Vector = FROM,
        samples: int = 4,
        without_shadow: Callable[[RenderItem], bool] = lambda _: False,
    ) -> None:
        """Set up for what lies between these points (n by 3, m, in the world).

        The camera is in the direction `towards`. At edges a pixel has so many more `samples`. The
        items `without_shadow` throw none.
        """
        self.renderer = renderer
        everything = renderer.points().values()
        self._turned = TurnedCamera(points, size, world.gravity, behind=everything, towards=towards)
        self.camera = self._turned.camera
        self._length = ARROW * extent(points)  # m, of an arrow
        tile = tile_for(extent(points))
        self.backdrop = Backdrop(self.camera, tile=tile, has_ground=world.has_ground_plane)
        sun, is_high = sun_of(world)
        self._sun = sun_view(points, sun, round(size.height * SHADOW)) if is_high else None
        self._without_shadow = without_shadow
        self._radius = NOOK * extent(points)
        self._samples = samples
        self._last: Image | None = None
        self._fronts: NDArray[np.bool_] | None = None  # items of which no back has been seen
        is_before = world.has_ground_plane and self.camera.eye[2] > 0  # the ground, before a thing
        self._sunk = SUNK * self.camera.far if is_before else None

    def take_at(self, poses: Poses) -> Image:
        """A picture of the things at these poses; the one before, if nothing is seen to move."""
        distance = math.dist(self.camera.eye, self.camera.target)
        least = UNSEEN * distance / float(np.linalg.norm(self.camera.view.matrix[0]))
        if self.renderer.arrange(poses, least=least) or self._last is None:
            self._last = self.take(dither=False)
        return self._last.copy()

    def take(self, *, dither: bool) -> Image:
        """A picture of how things are now; `dither` makes it smoother and its file larger."""
        view = self.camera.view
        shape = (3, view.height, view.width)
        known = None if self._fronts is None else self._fronts & self.renderer.closed
        sun = None
        if self._sun is not None:
            cast = self.renderer.see(self._sun, without=self._without_shadow, fronts=known)
            sun = Shadow(cast, self.renderer)
        behind = self.backdrop.shadowed(sun).reshape(3, -1)
        seen = self.renderer.see(view, fronts=known)
        is_seen = (seen.nearest > 0).reshape(shape[1:])
        self.backdrop.look_past(~is_seen)
        colors = behind.copy()
        light = Light(sun, self._sunk, self.renderer.open_sky(seen, self._radius))
        fronts = self.renderer.paint(colors, seen, light)
        self._fronts = fronts if self._fronts is None else self._fronts & fronts
        edges = _edges(colors.reshape(shape), is_seen)
        if edges.any():
            closer = self.renderer.see(view, edges, self._samples, before=seen, fronts=fronts)
            pixels = np.flatnonzero(edges)
            samples = np.tile(behind[:, pixels], self._samples)
            self.renderer.paint(samples, closer, light)
            total = colors[:, pixels] + samples.reshape(3, self._samples, -1).sum(axis=1)
            colors[:, pixels] = total / np.float32(self._samples + 1)
        return self._turned.turned(image_of(colors.reshape(shape), is_seen if dither else None))

    def draw_push(self, image: Image, push: Push, poses: Poses) -> None:
        """Draw the arrow of a push into a picture: its head is where the link is."""
        pose = poses.get(push.entity, {}).get(push.link)
        strength = math.hypot(*push.force)
        if pose is None or not strength or not np.isfinite(pose.xyz).all():
            return
        head = np.array(pose.xyz)
        tail = head - self._length / strength * np.array(push.force)
        (left, right), (top, bottom) = self._turned.places(np.stack([tail, head]))
        draw_arrow(image, (float(left), float(top)), (float(right), float(bottom)))


def _edges(colors: Floats32, is_seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The pixels whose neighbors look different, where anything is seen; they are to be smooth."""
    edges = np.zeros_like(is_seen)
    every, low, high = slice(None), slice(0, -1), slice(1, None)
    for axis, one, other in ((1, (low,), (high,)), (2, (every, low), (every, high))):
        differ = np.abs(np.diff(colors, axis=axis)).max(axis=0) > EDGE
        differ &= is_seen[one] | is_seen[other]
        edges[one] |= differ
        edges[other] |= differ
    return edges


PICTURE, WORLD_PICTURE = Size(960, 720), Size(480, 360)

# Towards the camera of the picture of the world: from above, over walls.
VIEWS: tuple[Vector, ...] = (
    (0.72, -0.62, 0.7),
    (-0.62, -0.72, 0.7),
    (0.62, 0.72, 0.7),
    (-0.72, 0.62, 0.7),
)
ENOUGH = 0.7  # of what is seen of the robots from the best of them

# How far around the robots the picture of the world goes: what reaches farther, as planes and
# landscapes do, is seen in it as far as it is seen.
AROUND_LEAST, AROUND_SIZES = 30.0, 10.0  # m, and sizes of all robots together
GROUND_EDGE = 20.0  # m; a static model as wide as that and as high as the ground is the ground
GROUND_THICKNESS = 0.01  # m

ALOFT = 0.25  # of the robots' size: what is as high above the ground does not stand on it


class SceneRenderer:
    """Takes the pictures of a scene, with the links where they are at some moment.

    `corners` are points of each robot (m, in the world), for meshes of unknown size and for robots
    of which nothing can be seen.
    """

    def __init__(
        self,
        scene: Scene,
        poses: Poses,
        corners: Mapping[str, Sequence[Vector]],
        refused: Container[str] = (),
    ) -> None:
        self.world = scene.world
        self.pushes = scene.pushes
        self._poses = poses
        items = list_render_items(scene, refused)
        self.renderer = Renderer(items, towards_light=sun_of(scene.world)[0])
        self.renderer.arrange(poses)
        self._corners = corners
        self._subjects = [robot.entity for robot in subjects(scene) if robot.entity not in refused]
        if scene.world.has_ground_plane:
            self.renderer.remove(_lies_in_the_ground)
        items = self.renderer.items
        self._robots = [number for number, item in enumerate(items) if item.is_subject]

    def draw(self, file: Path) -> float | None:
        """Write a PNG of the robots; gives the edge of the ground's squares, m, if any are seen."""
        image, tile = self.picture
        write_png(image, file)
        return tile

    @functools.cached_property
    def picture(self) -> tuple[Image, float | None]:
        """A picture of the robots, and the edge of the ground's squares, m, if any are seen."""
        points = self.subject_points()
        setup = CameraSetup(
            self.renderer, self.world, points, PICTURE, without_shadow=is_no_subject
        )
        image = setup.take(dither=True)
        for push in self.pushes:
            setup.draw_push(image, push, self._poses)
        write_caption(image, [*self._captions(points), *_legend(setup.backdrop.tile)])
        return image, setup.backdrop.tile

    def draw_world(self, file: Path) -> float | None:
        """Likewise a smaller one of the robots with what is around them."""
        image, tile = self.world_picture
        write_png(image, file)
        return tile

    @functools.cached_property
    def world_picture(self) -> tuple[Image, float | None]:
        """As `picture`, of the robots with what is around them."""
        framed = np.vstack([self.subject_points(), *self._near().values()])
        towards = self._best_view(framed)
        setup = CameraSetup(self.renderer, self.world, framed, WORLD_PICTURE, towards=towards)
        image = setup.take(dither=True)
        write_caption(image, [*_legend(setup.backdrop.tile)])
        return image, setup.backdrop.tile

    def view(self, most: int) -> SceneView:
        """What a page shows of it; the surfaces have at most so many triangles, or about that."""
        image, tile = self.picture
        near = self._near()
        placed = [
            one for number, one in self.renderer.placed() if one.item.is_subject or number in near
        ]
        view = view_of(placed, most)
        has_others = any(not part.is_robot for part in view.parts)
        return SceneView(
            picture=as_webp(image),
            picture_tile=tile,
            world_picture=as_webp(self.world_picture[0]) if has_others else None,
            parts=view.parts,
            has_ground=self.world.has_ground_plane,
            tile=tile_for(extent(self.subject_points())),
            triangles=view.triangles,
            triangles_before=view.triangles_before,
        )

    def _near(self) -> dict[int, Floats]:
        """Points of the static models that are near the robots, by their number."""
        points = self.subject_points()
        return self.around(points, max(AROUND_LEAST, AROUND_SIZES * extent(points)))

    def around(self, points: Floats, room: float) -> dict[int, Floats]:
        """Points of the static models that are within a room (m) around points, by their number."""
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        return {
            number: of_it
            for number, of_it in self.renderer.points(is_no_subject).items()
            if abs(of_it - middle).max() < room
        }

    def _best_view(self, points: Floats) -> Vector:
        """From which corner the robots are seen best; from the usual one, if well enough."""
        seen = []
        for towards in VIEWS:
            camera = eye_camera(points, WORLD_PICTURE, towards=towards)
            items = self.renderer.sense(camera).item
            seen.append(sum(np.count_nonzero(items == number) for number in self._robots))
        return next(
            view for view, count in zip(VIEWS, seen, strict=True) if count >= ENOUGH * max(seen)
        )

    def subject_points(self) -> Floats:
        """Points that the robots lie between, as they are now (n by 3, m, in the world)."""
        around = self.renderer.points(lambda render_item: render_item.is_subject).values()
        points = np.vstack([self._corners_of_unseen(), *around])
        if not len(points):
            raise ValueError("nothing of it can be seen, or the poses of its links are not finite")
        return points

    def _corners_of_unseen(self) -> Floats:
        """Corners of the robots of which nothing is drawn."""
        drawn = {render_item.entity for render_item in self.renderer.items}
        corners = [
            one for name in self._subjects if name not in drawn for one in self._corners[name]
        ]
        points: Floats = np.array(corners, dtype=np.float64).reshape(-1, 3)
        return points[np.isfinite(points).all(axis=1)]

    def _captions(self, points: Floats) -> Iterator[str]:
        """What a person would not see in the picture."""
        slope = slope_of(self.world.gravity)
        if slope:
            yield f"slope of {math.degrees(slope):.3g} degrees"
        for push in self.pushes:
            force, end = math.hypot(*push.force), push.begin + push.seconds
            yield f"arrow: push of {force:.3g} N, {push.begin:.3g} s to {end:.3g} s"
        shown = [render_item for render_item in self.renderer.items if render_item.is_subject]
        if not shown:
            yield "no visual, no collision"
        elif any(render_item.is_collision for render_item in shown):
            yield "orange: collisions of links without a visual"
        if not self.world.has_ground_plane:
            return
        low, high = points[:, 2].min(), points[:, 2].max()
        if high < 0:
            yield f"{_length(-high)} under the ground"
        elif low > ALOFT * extent(points):
            yield f"{_length(low)} above the ground"


def is_no_subject(render_item: RenderItem) -> bool:
    """Whether it is of what is around; its shadow would come from nowhere in the first picture."""
    return not render_item.is_subject


def _lies_in_the_ground(render_item: RenderItem, points: Floats) -> bool:
    """Whether it is the ground, which is drawn in another way."""
    edges = np.ptp(points, axis=0)
    is_wide = min(edges[0], edges[1]) > GROUND_EDGE
    return not render_item.is_subject and is_wide and abs(points[:, 2].max()) < GROUND_THICKNESS


def _legend(tile: float | None) -> Iterator[str]:
    if tile is not None:
        yield f"1 square = {tile:g} m"


def _length(metres: float) -> str:
    return f"{metres:.0f} m" if metres >= 10 else f"{metres:.2g} m"  # noqa: PLR2004  two digits


FINEST = 1024  # cells along the longest edge of the box around all: what is smaller is not seen
ROUNDS = 12  # in which the size of a cell is found
MOSTLY_FULL = 0.85  # of the triangles that there may be


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
            if _total(found) >= MOSTLY_FULL * most:
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

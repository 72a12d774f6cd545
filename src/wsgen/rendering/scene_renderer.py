"""Draws the pictures of a scene: one of its robots, and one of all that is around them.

Import it only where a picture is wanted: loading NumPy and Pillow takes as long as a simulation.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.outcome import SceneView
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
from wsgen.rendering.scene_view import as_webp, view_of

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from PIL.Image import Image

    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.rendering.camera import Floats, Floats32
    from wsgen.rendering.render_items import Poses, RenderItem
    from wsgen.simulation.scene import Push, Scene


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

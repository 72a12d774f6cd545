"""Draws the pictures of a scene: one of its robots, and one of all that is around them.

A first, coarse shot shows how far bodies reach, more closely than the boxes around them; then the
camera is set up. Import it only where a picture is wanted: loading NumPy and Pillow takes as long
as a simulation.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.robot import Mesh
from wsgen.model.world import SUN_DIRECTION
from wsgen.rendering.camera import FROM, NEAREST, Size, extent, eye_camera, sun_camera
from wsgen.rendering.picture import (
    Backdrop,
    compose,
    is_under_ground,
    robots,
    tile_for,
    unproject,
    write_caption,
    write_png,
)
from wsgen.rendering.render_items import list_render_items, subjects
from wsgen.rendering.renderer import Renderer

if TYPE_CHECKING:
    from collections.abc import Collection, Container, Iterator, Mapping, Sequence
    from pathlib import Path

    from PIL.Image import Image

    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.rendering.camera import Floats, Shot
    from wsgen.rendering.render_items import Poses, RenderItem
    from wsgen.simulation.scene import Scene


PROBE = Size(480, 360)  # pixels
FEW = 40  # pixels; of what is thinner, the shot may have missed a part
MOST_SHOTS, GROWTH = 8, 3.0  # each from farther away, for what has an unknown size
CLOSER = 1.2  # how much more than has been found the last shot takes in


def seen_points(
    renderer: Renderer,
    numbers: Collection[int],
    around: Mapping[int, Floats],
    whole: Container[int],
    guess: Floats,
) -> Floats:
    """Points (n by 3, m, in the world) that bodies lie between.

    Args:
        renderer: What they stand in.
        numbers: Which bodies.
        around: Points that each lies between; some may be missing.
        whole: Bodies of which those points are not of a box around them but their own.
        guess: Points (n by 3, m) about where the missing ones are. If they reach out of the shot,
            it is taken again from farther away.
    """
    missing = [body for body in numbers if body not in around]
    boxed = [body for body in numbers if body not in whole]
    points = np.vstack([guess, *around.values()])
    shots = [_shoot(renderer, points, missing)]
    while not _is_complete(shots[-1], missing) and len(shots) < MOST_SHOTS:
        points = _widen(points, GROWTH)
        shots.append(_shoot(renderer, points, missing))
    clear, seen = _reach(shots[-1], boxed)
    if len(shots) > 1 and clear:  # from so far away they were small; now it is known where they are
        clear, seen = _reach(_shoot(renderer, _widen(seen, CLOSER), missing), boxed)
    unseen = [points for body, points in around.items() if body not in clear]
    return np.vstack([seen, *unseen, *([guess] if set(missing) - clear else [])])


def _shoot(renderer: Renderer, points: Floats, missing: Collection[int]) -> Shot:
    camera = eye_camera(points, PROBE, behind=points)
    if missing:  # they may be nearer or farther than what is known
        distance = math.dist(camera.eye, camera.target)
        camera = replace(camera, near=distance * NEAREST, far=distance / NEAREST)
    return renderer.shoot(camera)


def _is_complete(shot: Shot, missing: Collection[int]) -> bool:
    """Whether bodies are seen, and do not reach out of the shot."""
    bodies = shot.body
    rim = np.concatenate([bodies[0], bodies[-1], bodies[:, 0], bodies[:, -1]])
    wanted = list(missing)
    return bool(np.isin(wanted, bodies).all() and not np.isin(rim, wanted).any())


def _widen(points: Floats, factor: float) -> Floats:
    middle = points.mean(axis=0)
    wider: Floats = middle + (points - middle) * factor
    return wider


def _reach(shot: Shot, numbers: Collection[int]) -> tuple[set[int], Floats]:
    """Which of the bodies are seen clearly, and all points that are seen of those."""
    clear = {body for body in numbers if np.count_nonzero(shot.body == body) >= FEW}
    rows, columns = np.nonzero(np.isin(shot.body, list(clear)))
    depth = shot.depth[rows, columns].astype(np.float64)
    return clear, unproject(shot, rows, columns, depth).T


SCALES = (2.0, 1.5, 1.0, 0.75, 0.5)  # of a picture's size, how large it is drawn
SHADOW = 0.7  # of a picture's height, how many pixels wide its shadow is drawn

# About what it takes, s of CPU time, to put a pixel of what was drawn before its background, and to
# make one of the picture.
DRAWN_PIXEL_SECONDS, PIXEL_SECONDS = 0.08e-6, 0.15e-6

SAME_SUN = 0.999  # cosine of an angle
SHADING: Vector = (0.5, -1.1, 2.0)  # towards our light, on the robots …
SUN: Vector = (0.15, -0.55, 1.0)  # … and that of the shadow: its three-quarter view is clearer so
STEEP = 0.15  # sine of how high the light must stand to draw a shadow that is not endless


def lights(world: World) -> tuple[Vector, Vector | None]:
    """The directions towards what shades the robots, and towards what throws their shadow.

    They are the world's own if it has another light than Gazebo's.
    """
    shines = world.sun_direction
    if _cosine(shines, SUN_DIRECTION) > SAME_SUN:
        return SHADING, SUN
    towards = (-shines[0], -shines[1], -shines[2])
    return towards, towards if towards[2] / math.hypot(*towards) > STEEP else None


def _cosine(one: Vector, other: Vector) -> float:
    product = sum(a * b for a, b in zip(one, other, strict=True))
    return product / max(math.hypot(*one) * math.hypot(*other), 1e-12)


def finest_scale(renderer: Renderer, size: Size, seconds: float) -> float:
    """How many times as large as a picture it can be drawn in so much CPU time, about."""
    affordable = (one for one in SCALES if picture_seconds(renderer, size, one) <= seconds)
    return next(affordable, SCALES[-1])


def picture_seconds(renderer: Renderer, size: Size, scale: float) -> float:
    """About the CPU time that a picture of this size takes on a usual computer, s."""
    pixels = size.width * size.height
    seconds = renderer.shot_seconds(pixels * scale**2)
    seconds += renderer.shot_seconds(_shadow_pixels(size, scale) ** 2)
    if min(renderer.opacity) < 1:
        seconds += renderer.shot_seconds(pixels)
    return seconds + pixels * (PIXEL_SECONDS + scale**2 * DRAWN_PIXEL_SECONDS)


def _shadow_pixels(size: Size, scale: float) -> int:
    """How wide and high the shadow is drawn."""
    return round(size.height * (SHADOW if scale > 1 else SHADOW / 2))


class CameraSetup:
    """A camera, a light and a background: takes pictures of one size from one place."""

    def __init__(  # noqa: PLR0913  a set-up has this many parts
        self,
        renderer: Renderer,
        world: World,
        points: Floats,
        size: Size,
        scale: float,
        *,
        towards: Vector = FROM,
        without_shadow: Collection[int] = (),
    ) -> None:
        """Set up for what lies between these points (n by 3, m, in the world).

        A picture of `size` is drawn `scale` times as large, so that its edges are smooth. The
        camera is in the direction `towards`; of the bodies `without_shadow` none is drawn.
        """
        self.renderer = renderer
        self.size = size
        everything = [points, *renderer.points().values()]
        self.scale = scale
        drawn = Size(round(size.width * self.scale), round(size.height * self.scale))
        self.camera = eye_camera(points, drawn, behind=np.vstack(everything), towards=towards)
        tile = tile_for(extent(points))
        self.backdrop = Backdrop(self.camera, size, tile=tile, has_ground=world.has_ground_plane)
        _, sun = lights(world)
        shadow = _shadow_pixels(size, scale)
        self._light = sun and sun_camera(points, sun, shadow)
        self._without_shadow = without_shadow
        self._opacity = np.array(renderer.opacity, dtype=np.float32)

    def take(self, *, dither: bool) -> Image:
        """A picture of how things are now; `dither` makes it smoother and its file larger."""
        shot = self.renderer.shoot(self.camera)
        self.backdrop.look_past(shot.body < 0)
        behind = self._behind_transparent() if (self._opacity < 1).any() else None
        light = None
        if self._light is not None and self.backdrop.is_ground_seen:
            light = self.renderer.shoot(self._light, without=self._without_shadow)
            light.body[is_under_ground(light)] = -1  # that throws no shadow upwards
        front = robots(shot, behind, self._opacity, has_ground=self.backdrop.is_ground_seen)
        background = self.backdrop.shadowed(light, self._opacity)
        return compose(front, background, self.size, dither=dither)

    def _behind_transparent(self) -> Shot:
        """What is behind transparent bodies; it need not be sharp."""
        camera = replace(self.camera, width=self.size.width, height=self.size.height)
        transparent = np.flatnonzero(self._opacity < 1).tolist()
        return self.renderer.shoot(camera if self.scale > 1 else self.camera, without=transparent)


PICTURE, WORLD_PICTURE = Size(960, 720), Size(480, 360)
PATIENCE = 2.0  # s of CPU time for a picture, about

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
        self.render_items = list_render_items(scene, refused)
        self.renderer = Renderer(self.render_items, towards_light=lights(scene.world)[0])
        self.renderer.arrange(poses)
        self._corners = corners
        self._subjects = [robot.entity for robot in subjects(scene) if robot.entity not in refused]
        if scene.world.has_ground_plane:
            self.renderer.remove(_lies_in_the_ground)
        # The shadow of what is not in the picture would come from nowhere.
        self.static_models = self.renderer.numbers(lambda render_item: not render_item.is_subject)

    def draw(self, file: Path) -> float | None:
        """Write a PNG of the robots; gives the edge of the ground's squares, m, if any are seen."""
        points = self.subject_points()
        setup = CameraSetup(
            self.renderer,
            self.world,
            points,
            PICTURE,
            finest_scale(self.renderer, PICTURE, PATIENCE),
            without_shadow=self.static_models,
        )
        image = setup.take(dither=True)
        write_caption(image, [*self._captions(points), *_legend(setup.backdrop.tile)])
        write_png(image, file)
        return setup.backdrop.tile

    def draw_world(self, file: Path) -> float | None:
        """Likewise a smaller one of the robots with what is around them."""
        points = self.subject_points()
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        room = max(AROUND_LEAST, AROUND_SIZES * extent(points))
        static_models = self.renderer.points(lambda render_item: not render_item.is_subject)
        near = [of_it for of_it in static_models.values() if abs(of_it - middle).max() < room]
        framed = np.vstack([points, *near])
        towards = self._best_view(framed)
        scale = finest_scale(self.renderer, WORLD_PICTURE, PATIENCE)
        setup = CameraSetup(
            self.renderer, self.world, framed, WORLD_PICTURE, scale, towards=towards
        )
        image = setup.take(dither=True)
        write_caption(image, [*_legend(setup.backdrop.tile)])
        write_png(image, file)
        return setup.backdrop.tile

    def _best_view(self, points: Floats) -> Vector:
        """From which corner the robots are seen best; from the usual one, if well enough."""
        robots = list(self.renderer.numbers(lambda render_item: render_item.is_subject))
        seen = []
        for towards in VIEWS:
            shot = self.renderer.shoot(eye_camera(points, WORLD_PICTURE, towards=towards))
            seen.append(np.count_nonzero(np.isin(shot.body, robots)))
        return next(
            view for view, count in zip(VIEWS, seen, strict=True) if count >= ENOUGH * max(seen)
        )

    def subject_points(self) -> Floats:
        """Points that the robots lie between, as they are now (n by 3, m, in the world)."""
        around = self.renderer.points(lambda render_item: render_item.is_subject)
        guess = self._corners_of_unknown()
        if not around and not len(guess):
            raise ValueError("the poses of its links are not finite")
        numbers = self.renderer.numbers(lambda render_item: render_item.is_subject)
        if not numbers:
            return guess
        whole = self.renderer.numbers(
            lambda render_item: not isinstance(render_item.geometry, Mesh)
        )
        if whole >= numbers:
            return np.vstack([guess, *around.values()])
        return seen_points(self.renderer, numbers, around, whole, guess)

    def _corners_of_unknown(self) -> Floats:
        """Corners of the robots that may reach beyond the bounds of the render items."""
        corners: list[Vector] = []
        for entity in self._subjects:
            own = [render_item for render_item in self.render_items if render_item.entity == entity]
            if not own or not all(render_item.has_known_size for render_item in own):
                corners += self._corners[entity]
        points: Floats = np.array(corners, dtype=np.float64).reshape(-1, 3)
        return points[np.isfinite(points).all(axis=1)]

    def _captions(self, points: Floats) -> Iterator[str]:
        """What a person would not see in the picture."""
        shown = [render_item for render_item in self.render_items if render_item.is_subject]
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

"""A camera and a light before what stands in a studio, and the ground behind it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.world import SUN_DIRECTION
from wsgen.simulation.framing import FROM, Size, extent, eye_camera, sun_camera
from wsgen.simulation.ground import Backdrop, tile_for
from wsgen.simulation.picture import compose, is_under_ground, robots

if TYPE_CHECKING:
    from collections.abc import Collection

    from PIL.Image import Image

    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.bullet_studio import Studio
    from wsgen.simulation.framing import Floats
    from wsgen.simulation.shot import Shot

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


def finest_scale(studio: Studio, size: Size, seconds: float) -> float:
    """How many times as large as a picture it can be drawn in so much CPU time, about."""
    affordable = (one for one in SCALES if picture_seconds(studio, size, one) <= seconds)
    return next(affordable, SCALES[-1])


def picture_seconds(studio: Studio, size: Size, scale: float) -> float:
    """About the CPU time that a picture of this size takes on a usual computer, s."""
    pixels = size.width * size.height
    seconds = studio.shot_seconds(pixels * scale**2)
    seconds += studio.shot_seconds(_shadow_pixels(size, scale) ** 2)
    if min(studio.opacity) < 1:
        seconds += studio.shot_seconds(pixels)
    return seconds + pixels * (PIXEL_SECONDS + scale**2 * DRAWN_PIXEL_SECONDS)


def _shadow_pixels(size: Size, scale: float) -> int:
    """How wide and high the shadow is drawn."""
    return round(size.height * (SHADOW if scale > 1 else SHADOW / 2))


class Stage:
    """Takes pictures of a studio, of one size, from one place."""

    def __init__(  # noqa: PLR0913  a set-up has this many parts
        self,
        studio: Studio,
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
        self.studio = studio
        self.size = size
        everything = [points, *studio.points().values()]
        self.scale = scale
        drawn = Size(round(size.width * self.scale), round(size.height * self.scale))
        self.camera = eye_camera(points, drawn, behind=np.vstack(everything), towards=towards)
        tile = tile_for(extent(points))
        self.backdrop = Backdrop(self.camera, size, tile=tile, has_ground=world.has_ground_plane)
        _, sun = lights(world)
        shadow = _shadow_pixels(size, scale)
        self._light = sun and sun_camera(points, sun, shadow)
        self._without_shadow = without_shadow
        self._opacity = np.array(studio.opacity, dtype=np.float32)

    def take(self, *, dither: bool) -> Image:
        """A picture of how things are now; `dither` makes it smoother and its file larger."""
        shot = self.studio.shoot(self.camera)
        self.backdrop.look_past(shot.body < 0)
        behind = self._behind_veils() if (self._opacity < 1).any() else None
        light = None
        if self._light is not None and self.backdrop.is_ground_seen:
            light = self.studio.shoot(self._light, without=self._without_shadow)
            light.body[is_under_ground(light)] = -1  # that throws no shadow upwards
        front = robots(shot, behind, self._opacity, has_ground=self.backdrop.is_ground_seen)
        background = self.backdrop.shadowed(light, self._opacity)
        return compose(front, background, self.size, dither=dither)

    def _behind_veils(self) -> Shot:
        """What is behind that which is see-through; it need not be sharp."""
        camera = replace(self.camera, width=self.size.width, height=self.size.height)
        veils = np.flatnonzero(self._opacity < 1).tolist()
        return self.studio.shoot(camera if self.scale > 1 else self.camera, without=veils)

"""What the camera of a robot sees: a color and a depth for each pixel.

Colors are those of visuals in the light of the world's sun, without shadows; the ground is gray.
What has no visual is not seen, nor is the inside of a closed one, as in Gazebo.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.model.transform import rotation_of_rpy
from wsgen.rendering.camera import View
from wsgen.rendering.render_items import UNPAINTED, WHITE, list_render_items
from wsgen.rendering.renderer import Renderer, nearness_of
from wsgen.simulation.scene import Scene
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose
    from wsgen.model.world import World
    from wsgen.simulation.scene import SpawnedRobot

    Poses = Mapping[str, Mapping[str, Pose]]

BACKGROUND = 0.7  # of red, green and blue, 0 to 1: Gazebo's, where nothing is
AMBIENT = 0.4  # light, likewise, of a scene that does not say another
GROUND_AMBIENT, GROUND_DIFFUSE = 0.3, 0.7  # `Gazebo/Grey`, which the ground is painted with
GROUND_EDGE = 50.0  # m, from the origin to each edge of the ground that is seen
LEVELS = 255


@dataclass(frozen=True, kw_only=True)
class Lens:
    """A camera that looks along the x axis of its frame, z up; its pixels are squares."""

    width: int  # pixels
    height: int
    focal: float  # pixels
    near: float  # m; nothing nearer is seen
    far: float  # m

    def view(self, pose: Pose) -> View:
        """What it sees from a place in the world."""
        ahead, left, up = np.array(rotation_of_rpy(pose.rpy)).T
        matrix = np.stack([-left * self.focal, -up * self.focal, ahead])
        return View(matrix, np.array(pose.xyz), self.width, self.height, self.near)


class Exposure(NamedTuple):
    """What a camera sees at a moment."""

    depth: NDArray[np.float32]  # height by width, m along its axis; infinite where nothing is
    rgb: NDArray[np.uint8] | None  # height by width by 3; None: colors were not wanted


class SensorScene:
    """A world that cameras look at."""

    def __init__(
        self, world: World, robots: Sequence[SpawnedRobot], *, is_classic: bool = False
    ) -> None:
        """Load what can be seen of the robots, static models among them.

        What has no color is white in Gazebo Classic.
        """
        items = list_render_items(
            Scene(world=world, robots=tuple(robots)),
            frozenset(),
            unpainted=WHITE if is_classic else UNPAINTED,
        )
        if not is_classic:  # there the ambient color has no effect
            items = [
                item
                if item.paint is None
                else replace(item, paint=item.paint._replace(ambient=item.rgba, diffuse=item.rgba))
                for item in items
            ]
        x, y, z = world.sun_direction
        self._sun = world.sun_color
        self._renderer = Renderer(
            [item for item in items if not item.is_collision], towards_light=(-x, -y, -z)
        )
        self._ground_color = [GROUND_AMBIENT * AMBIENT - GROUND_DIFFUSE * z * c for c in self._sun]
        self._has_ground = world.has_ground_plane

    def expose(self, lens: Lens, pose: Pose, poses: Poses, *, in_color: bool) -> Exposure:
        """What a camera at this place in the world sees, with all links at their poses."""
        self._renderer.arrange(dict(poses))
        view = lens.view(pose)
        seen = self._renderer.see(view, fronts=self._renderer.closed)
        keys = seen.nearest
        depth = np.full(keys.shape, np.inf, dtype=np.float32)
        places = np.flatnonzero(keys)
        depth[places] = 1 / nearness_of(keys[places])
        ground = self._ground(lens, view) if self._has_ground else None
        if ground is not None:
            is_ground = ground < depth
            depth[is_ground] = ground[is_ground]
        is_far = depth > lens.far
        depth[is_far] = np.inf
        shape = (lens.height, lens.width)
        if not in_color:
            return Exposure(depth.reshape(shape), None)
        place, colors = self._renderer.flat_colors(seen, ambient=AMBIENT, sun=self._sun)
        colors = np.concatenate([colors, [self._ground_color]]).astype(np.float32)
        colors[0] = BACKGROUND
        if ground is not None:
            place[is_ground] = len(colors) - 1
        place[is_far] = 0
        hidden = is_far if ground is None else is_far | is_ground
        rgb = _levels(colors).take(place, axis=0)
        for samples, texels in self._renderer.texels(seen):
            shown = np.flatnonzero(~hidden[samples])
            there, shades = samples[shown], colors.T.take(place[samples[shown]], axis=1)
            shades *= texels if len(shown) == len(samples) else texels.take(shown, axis=1)
            rgb[there] = _levels(shades).T
        others = self._renderer.transparent(seen)
        if others is not None:
            keys = others.nearest
            through = np.flatnonzero((keys > 0) & ~hidden)
            place, colors = self._renderer.flat_colors(
                others._replace(solid=keys), ambient=AMBIENT, sun=self._sun
            )
            behind = rgb[through] / np.float32(LEVELS)
            alpha = self._renderer.opacity[self._renderer.items_of(keys[through])]
            behind += (colors[place[through]] - behind) * alpha[:, None]
            rgb[through] = _levels(behind)
        return Exposure(depth.reshape(shape), rgb.reshape(*shape, 3))

    @staticmethod
    def _ground(lens: Lens, view: View) -> NDArray[np.float32] | None:
        """The depth of the ground, a square at z = 0, in each pixel; None where it is not seen."""
        if view.origin[2] <= 0:
            return None
        columns = np.arange(lens.width) + 0.5 - lens.width / 2
        rows = (np.arange(lens.height) + 0.5 - lens.height / 2)[:, None]
        # How x, y and z change along the ray of each pixel, for each meter of depth.
        x, y, falls = (
            (rows * down + (columns * right + ahead)).astype(np.float32).ravel()
            for right, down, ahead in np.linalg.inv(view.matrix)
        )
        depth = np.full(falls.shape, np.inf, dtype=np.float32)
        np.divide(-np.float32(view.origin[2]), falls, out=depth, where=falls < 0)
        depth[depth < lens.near] = np.inf
        with np.errstate(invalid="ignore"):  # a ray that never arrives
            for start, way in zip(view.origin, (x, y), strict=False):
                depth[np.abs(start + way * depth) > GROUND_EDGE] = np.inf
        return depth


def _levels(colors: NDArray[np.float32]) -> NDArray[np.uint8]:
    levels: NDArray[np.uint8] = (colors * LEVELS + 0.5).astype(np.uint8)
    return levels


def focal_length(width: int, field_of_view: float) -> float:
    """In pixels, of a picture that is so wide (pixels) and sees so much across (rad)."""
    return width / (2.0 * math.tan(field_of_view / 2.0))

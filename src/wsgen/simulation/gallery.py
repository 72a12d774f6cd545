"""The pictures of a scene: one of its robots, and a second one of all that is around them.

Load it when a picture is wanted: NumPy's and Pillow's loading would cost every trial as much as
its simulation does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.robot import Mesh
from wsgen.simulation.bullet_studio import Studio
from wsgen.simulation.exhibits import list_exhibits, subjects
from wsgen.simulation.framing import Size, extent, eye_camera
from wsgen.simulation.picture import write_caption, write_png
from wsgen.simulation.probe import seen_points
from wsgen.simulation.stage import Stage, finest_scale, lights

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.transform import Vector
    from wsgen.simulation.exhibits import Exhibit, Poses
    from wsgen.simulation.framing import Floats
    from wsgen.simulation.scene import Scene

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
GROUND_EDGE = 20.0  # m; scenery as wide as that and as high as the ground is the ground
GROUND_THICKNESS = 0.01  # m

ALOFT = 0.25  # of the robots' size: what is as high above the ground does not stand on it


class Gallery:
    """Takes the pictures of a scene, with the links where they are at some moment.

    `corners` are points of each robot (m, in the world), for meshes of which nobody knows the size
    and for robots of which nothing can be seen.
    """

    def __init__(
        self,
        scene: Scene,
        poses: Poses,
        corners: Mapping[str, Sequence[Vector]],
        refused: Container[str] = (),
    ) -> None:
        self.world = scene.world
        self.exhibits = list_exhibits(scene, refused)
        self.studio = Studio(self.exhibits, towards_light=lights(scene.world)[0])
        self.studio.arrange(poses)
        self._corners = corners
        self._subjects = [robot.entity for robot in subjects(scene) if robot.entity not in refused]
        if scene.world.has_ground_plane:
            self.studio.remove(_lies_in_the_ground)
        # The shadow of what is not in the picture would come from nowhere.
        self.scenery = self.studio.numbers(lambda exhibit: not exhibit.is_subject)

    def draw(self, file: Path) -> float | None:
        """Write a PNG of the robots; gives the edge of the ground's squares, m, if any are seen."""
        points = self.subject_points()
        stage = Stage(
            self.studio,
            self.world,
            points,
            PICTURE,
            finest_scale(self.studio, PICTURE, PATIENCE),
            without_shadow=self.scenery,
        )
        image = stage.take(dither=True)
        write_caption(image, [*self._captions(points), *_legend(stage.backdrop.tile)])
        write_png(image, file)
        return stage.backdrop.tile

    def draw_world(self, file: Path) -> float | None:
        """Likewise a smaller one of the robots with what is around them."""
        points = self.subject_points()
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        room = max(AROUND_LEAST, AROUND_SIZES * extent(points))
        scenery = self.studio.points(lambda exhibit: not exhibit.is_subject)
        near = [of_it for of_it in scenery.values() if abs(of_it - middle).max() < room]
        framed = np.vstack([points, *near])
        towards = self._best_view(framed)
        scale = finest_scale(self.studio, WORLD_PICTURE, PATIENCE)
        stage = Stage(self.studio, self.world, framed, WORLD_PICTURE, scale, towards=towards)
        image = stage.take(dither=True)
        write_caption(image, [*_legend(stage.backdrop.tile)])
        write_png(image, file)
        return stage.backdrop.tile

    def _best_view(self, points: Floats) -> Vector:
        """From which corner the robots are seen best; from the usual one, if well enough."""
        robots = list(self.studio.numbers(lambda exhibit: exhibit.is_subject))
        seen = []
        for towards in VIEWS:
            shot = self.studio.shoot(eye_camera(points, WORLD_PICTURE, towards=towards))
            seen.append(np.count_nonzero(np.isin(shot.body, robots)))
        return next(
            view for view, count in zip(VIEWS, seen, strict=True) if count >= ENOUGH * max(seen)
        )

    def subject_points(self) -> Floats:
        """Points that the robots lie between, as they are now (n by 3, m, in the world)."""
        around = self.studio.points(lambda exhibit: exhibit.is_subject)
        guess = self._corners_of_unknown()
        if not around and not len(guess):
            raise ValueError("nothing of it is anywhere: its poses are no numbers")
        numbers = self.studio.numbers(lambda exhibit: exhibit.is_subject)
        if not numbers:
            return guess
        whole = self.studio.numbers(lambda exhibit: not isinstance(exhibit.geometry, Mesh))
        if whole >= numbers:
            return np.vstack([guess, *around.values()])
        return seen_points(self.studio, numbers, around, whole, guess)

    def _corners_of_unknown(self) -> Floats:
        """Corners of the robots of which something may be outside of what exhibits lie between."""
        corners: list[Vector] = []
        for entity in self._subjects:
            own = [exhibit for exhibit in self.exhibits if exhibit.entity == entity]
            if not own or not all(exhibit.has_known_size for exhibit in own):
                corners += self._corners[entity]
        points: Floats = np.array(corners, dtype=np.float64).reshape(-1, 3)
        return points[np.isfinite(points).all(axis=1)]

    def _captions(self, points: Floats) -> Iterator[str]:
        """What a person would not see in the picture."""
        shown = [exhibit for exhibit in self.exhibits if exhibit.is_subject]
        if not shown:
            yield "nothing can be seen of it: no visual, no collision"
        elif any(exhibit.is_collision for exhibit in shown):
            yield "orange: collisions of links without a visual"
        if not self.world.has_ground_plane:
            return
        low, high = points[:, 2].min(), points[:, 2].max()
        if high < 0:
            yield f"{_length(-high)} under the ground"
        elif low > ALOFT * extent(points):
            yield f"{_length(low)} above the ground"


def _lies_in_the_ground(exhibit: Exhibit, points: Floats) -> bool:
    """Whether it is the ground, which is drawn in another way."""
    edges = np.ptp(points, axis=0)
    is_wide = min(edges[0], edges[1]) > GROUND_EDGE
    return not exhibit.is_subject and is_wide and abs(points[:, 2].max()) < GROUND_THICKNESS


def _legend(tile: float | None) -> Iterator[str]:
    if tile is not None:
        yield f"1 square = {tile:g} m"


def _length(metres: float) -> str:
    return f"{metres:.0f} m" if metres >= 10 else f"{metres:.2g} m"  # noqa: PLR2004  two digits

"""What a renderer draws of the robots in a scene: their visuals, or collisions instead."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Sphere
from wsgen.model.transform import IDENTITY, Pose, compose
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence

    from wsgen.model.robot import Geometry, Link, Paint, Primitive, Visual
    from wsgen.simulation.scene import Scene, SpawnedRobot


Rgba = tuple[float, float, float, float]
Poses = dict[str, "Mapping[str, Pose]"]  # of links, in the world: entity, then link

UNPAINTED: Rgba = (0.75, 0.75, 0.78, 1.0)  # about what Gazebo shows without a material
UNPAINTED_STATIC_MODEL: Rgba = (0.60, 0.57, 0.53, 1.0)  # a robot differs from what it is on
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)  # leaves a texture its colors
COLLISION: Rgba = (1.0, 0.44, 0.0, 0.5)  # what Gazebo paints collisions with
BLACKEST = 0.1  # Gazebo's `FlatBlack`
INVISIBLE = 0.1  # what has less alpha is not to be seen


@dataclass(frozen=True, kw_only=True)
class RenderItem:
    """Something that is drawn."""

    entity: str  # the robot and the link that carry it
    link: str
    geometry: Primitive | Mesh
    pose_in_link: Pose = IDENTITY
    rgba: Rgba
    paint: Paint | None = None  # see `Visual.paint`; for sensors
    texture: str | None = None  # an image file
    is_subject: bool = True  # of a robot that the picture is about
    is_collision: bool = False  # shown because its link has nothing else to show

    def pose(self, poses: Poses) -> Pose | None:
        """Where it is in the world; None where that is no number, or where it is not there."""
        if self.entity not in poses:
            return None
        pose = compose(poses[self.entity][self.link], self.pose_in_link)
        return pose if all(map(math.isfinite, (*pose.xyz, *pose.rpy))) else None


def list_render_items(
    scene: Scene, refused: Container[str], *, unpainted: Rgba | None = None
) -> list[RenderItem]:
    """What can be drawn of the robots that the engine took.

    A link without a visual that can be drawn shows its collisions, unless its maker has made its
    visuals invisible; a robot of which nothing is seen then shows those, too.

    With `unpainted`, the color of what has none, colors are as they are, for a sensor; those of
    pictures show more.
    """
    return [
        render_item
        for robot in scene.robots
        if robot.entity not in refused
        for render_item in _of_robot(robot, unpainted, is_subject=robot in subjects(scene))
    ]


def subjects(scene: Scene) -> Sequence[SpawnedRobot]:
    """The robots that a picture is about: those that are spawned into the world, if any are.

    Else those in the file of the world; all, where there are only static models.
    """
    robots = [robot for robot in scene.robots if not robot.is_static_model]
    return [robot for robot in robots if not robot.is_of_world] or robots or scene.robots


def _of_robot(robot: SpawnedRobot, unpainted: Rgba | None, *, is_subject: bool) -> list[RenderItem]:
    links = robot.robot.links
    seen = [
        one
        for link in links
        for one in _of_link(robot.entity, link, unpainted, is_subject=is_subject)
    ]
    return seen or [
        one for link in links for one in _collisions(robot.entity, link, is_subject=is_subject)
    ]


def _of_link(
    entity: str, link: Link, unpainted: Rgba | None, *, is_subject: bool
) -> Iterator[RenderItem]:
    visuals = [
        (visual, geometry) for visual in link.visuals if (geometry := drawable(visual.geometry))
    ]
    if not visuals:
        yield from _collisions(entity, link, is_subject=is_subject)
    for visual, geometry in visuals:
        if unpainted is not None:
            rgba = visual.rgba or (WHITE if visual.texture else unpainted)
        else:
            rgba = color_of(visual, UNPAINTED if is_subject else UNPAINTED_STATIC_MODEL)
        if rgba[3] >= INVISIBLE:
            yield RenderItem(
                entity=entity,
                link=link.name,
                geometry=geometry,
                pose_in_link=visual.pose_in_link,
                rgba=rgba,
                paint=None if visual.rgba is None else visual.paint,
                texture=visual.texture,
                is_subject=is_subject,
            )


def _collisions(entity: str, link: Link, *, is_subject: bool) -> Iterator[RenderItem]:
    for collision in link.collisions:
        geometry = drawable(collision.geometry)
        if geometry is not None:
            yield RenderItem(
                entity=entity,
                link=link.name,
                geometry=geometry,
                pose_in_link=collision.pose_in_link,
                rgba=COLLISION,
                is_subject=is_subject,
                is_collision=True,
            )


def drawable(geometry: Geometry) -> Primitive | Mesh | None:
    """The shape, if there is something to draw it from."""
    if isinstance(geometry, Mesh):
        return geometry if geometry.path is not None else None
    return geometry if isinstance(geometry, (Box, Cylinder, Sphere, Capsule)) else None


def color_of(visual: Visual, unpainted: Rgba) -> Rgba:
    """Its color, but for black, which is painted as little brighter as shows its edges."""
    red, green, blue, alpha = visual.rgba or (WHITE if visual.texture else unpainted)
    is_black = max(red, green, blue) < BLACKEST
    return (BLACKEST, BLACKEST, BLACKEST, alpha) if is_black else (red, green, blue, alpha)

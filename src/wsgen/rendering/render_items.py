"""What a renderer draws of the robots in a scene: their visuals, with primitives as triangles."""

from __future__ import annotations

import functools
import math
from dataclasses import field
from itertools import product
from typing import TYPE_CHECKING

from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Sphere
from wsgen.model.transform import IDENTITY, Pose, Vector, compose
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence

    from wsgen.model.robot import Geometry, Link, Primitive, Visual
    from wsgen.simulation.scene import Scene, SpawnedRobot


Profile = tuple[float, float, float, float]  # radius, z, and the normal's part outwards, along z

AROUND = 96  # faces around a round shape
UP = 24  # rings of a sphere
# A triangle costs its renderer the box around it: long sides are cut into pieces of some radii.
PIECE, MOST_PIECES = 0.5, 40


@dataclass
class Triangles:
    """Vertices (m) with a normal each; three indices make a triangle, counter-clockwise."""

    vertices: list[Vector] = field(default_factory=list)
    normals: list[Vector] = field(default_factory=list)
    indices: list[int] = field(default_factory=list)


@functools.cache  # robots have many that are alike
def tessellate(shape: Primitive) -> Triangles:
    """The surface of the shape, seen from its own frame; not to be changed."""
    if isinstance(shape, Box):
        return _box(shape.size)
    if isinstance(shape, Sphere):
        return _turned(_arc(shape.radius, -90, 90, 0.0))
    if isinstance(shape, Capsule):
        half = shape.length / 2
        side = _side(shape.radius, half)[1:-1]
        arcs = _arc(shape.radius, -90, 0, -half), _arc(shape.radius, 0, 90, half)
        return _turned(arcs[0] + side + arcs[1])
    half, radius = shape.length / 2, shape.radius
    triangles = _turned(_side(radius, half))
    for z, direction in ((-half, -1.0), (half, 1.0)):
        rim = [(0.0, z, 0.0, direction), (radius, z, 0.0, direction)]
        _append(triangles, _turned(rim if direction < 0 else rim[::-1]))
    return triangles


def _side(radius: float, half: float) -> list[Profile]:
    """From one rim of a cylinder to the other."""
    pieces = min(MOST_PIECES, max(1, math.ceil(2 * half / (PIECE * max(radius, 1e-9)))))
    return [(radius, half * (2 * piece / pieces - 1), 1.0, 0.0) for piece in range(pieces + 1)]


def _arc(radius: float, start: int, end: int, shift: float) -> list[Profile]:
    count = UP * (end - start) // 180
    angles = [math.radians(start + (end - start) * step / count) for step in range(count + 1)]
    return [
        (
            radius * math.cos(angle),
            shift + radius * math.sin(angle),
            math.cos(angle),
            math.sin(angle),
        )
        for angle in angles
    ]


def _turned(profile: list[Profile]) -> Triangles:
    """The profile turned about z."""
    triangles = Triangles()
    for step in range(AROUND + 1):
        angle = 2 * math.pi * step / AROUND
        cos, sin = math.cos(angle), math.sin(angle)
        for radius, z, outwards, along in profile:
            triangles.vertices.append((radius * cos, radius * sin, z))
            triangles.normals.append((outwards * cos, outwards * sin, along))
    rows = len(profile)
    for step in range(AROUND):
        for row in range(rows - 1):
            corner = step * rows + row
            triangles.indices += (corner, corner + rows, corner + rows + 1)
            triangles.indices += (corner, corner + rows + 1, corner + 1)
    return triangles


def _box(size: Vector) -> Triangles:
    triangles = Triangles()
    for axis in range(3):
        for direction in (-1.0, 1.0):
            first, second = (axis + 1) % 3, (axis + 2) % 3
            corner = len(triangles.vertices)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                vertex, normal = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
                vertex[axis] = direction * size[axis] / 2
                vertex[first], vertex[second] = u * size[first] / 2, v * size[second] / 2
                normal[axis] = direction
                triangles.vertices.append((vertex[0], vertex[1], vertex[2]))
                triangles.normals.append((normal[0], normal[1], normal[2]))
            order = (0, 1, 2, 0, 2, 3) if direction > 0 else (0, 2, 1, 0, 3, 2)
            triangles.indices += (corner + index for index in order)
    return triangles


def _append(triangles: Triangles, more: Triangles) -> None:
    start = len(triangles.vertices)
    triangles.vertices += more.vertices
    triangles.normals += more.normals
    triangles.indices += (start + index for index in more.indices)


Rgba = tuple[float, float, float, float]
Poses = dict[str, "Mapping[str, Pose]"]  # of links, in the world: entity, then link

UNPAINTED: Rgba = (0.75, 0.75, 0.78, 1.0)  # about what Gazebo shows without a material
UNPAINTED_STATIC_MODEL: Rgba = (0.60, 0.57, 0.53, 1.0)  # a robot differs from what it is on
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)  # leaves a texture its colors
COLLISION: Rgba = (1.0, 0.44, 0.0, 0.5)  # what Gazebo paints collisions with
BLACKEST = 0.1  # Gazebo's `FlatBlack`
TRIANGLES_OF_A_MESH = 5_000
INVISIBLE = 0.1  # what has less alpha is not to be seen


@dataclass(frozen=True, kw_only=True)
class RenderItem:
    """Something that is drawn."""

    entity: str  # the robot and the link that carry it
    link: str
    geometry: Primitive | Mesh
    pose_in_link: Pose = IDENTITY
    rgba: Rgba
    texture: str | None = None  # an image file
    is_subject: bool = True  # of a robot that the picture is about
    is_collision: bool = False  # shown because its link has nothing else to show

    def points(self) -> list[Vector]:
        """Points that it lies between, seen from its own frame, m; none where they are unknown."""
        if not isinstance(self.geometry, Mesh):
            return tessellate(self.geometry).vertices
        if self.geometry.bounds is None:
            return []
        x, y, z = (
            (low * factor, high * factor)
            for low, high, factor in zip(*self.geometry.bounds, self.geometry.scale, strict=True)
        )
        return list(product(x, y, z))

    @property
    def triangles(self) -> int:
        """How many are drawn; a guess where the mesh was not inspected."""
        if not isinstance(self.geometry, Mesh):
            return len(tessellate(self.geometry).indices) // 3
        return self.geometry.triangles or TRIANGLES_OF_A_MESH

    @property
    def has_known_size(self) -> bool:
        """Whether `points` gives any."""
        return not isinstance(self.geometry, Mesh) or self.geometry.bounds is not None

    def pose(self, poses: Poses) -> Pose | None:
        """Where it is in the world; None where that is no number."""
        pose = compose(poses[self.entity][self.link], self.pose_in_link)
        return pose if all(map(math.isfinite, (*pose.xyz, *pose.rpy))) else None


def list_render_items(scene: Scene, refused: Container[str]) -> list[RenderItem]:
    """What can be drawn of the robots that the engine took.

    A link without a visual that can be drawn shows its collisions, unless its maker has made its
    visuals invisible; a robot of which nothing is seen then shows those, too.
    """
    return [
        render_item
        for robot in scene.robots
        if robot.entity not in refused
        for render_item in _of_robot(robot, is_subject=robot in subjects(scene))
    ]


def subjects(scene: Scene) -> Sequence[SpawnedRobot]:
    """The robots that a picture is about: all, where there are only static models."""
    return [robot for robot in scene.robots if not robot.is_static_model] or scene.robots


def _of_robot(robot: SpawnedRobot, *, is_subject: bool) -> list[RenderItem]:
    links = robot.robot.links
    seen = [one for link in links for one in _of_link(robot.entity, link, is_subject=is_subject)]
    return seen or [
        one for link in links for one in _collisions(robot.entity, link, is_subject=is_subject)
    ]


def _of_link(entity: str, link: Link, *, is_subject: bool) -> Iterator[RenderItem]:
    visuals = [
        (visual, geometry) for visual in link.visuals if (geometry := _drawable(visual.geometry))
    ]
    if not visuals:
        yield from _collisions(entity, link, is_subject=is_subject)
    for visual, geometry in visuals:
        rgba = _color(visual, UNPAINTED if is_subject else UNPAINTED_STATIC_MODEL)
        if rgba[3] >= INVISIBLE:
            yield RenderItem(
                entity=entity,
                link=link.name,
                geometry=geometry,
                pose_in_link=visual.pose_in_link,
                rgba=rgba,
                texture=visual.texture,
                is_subject=is_subject,
            )


def _collisions(entity: str, link: Link, *, is_subject: bool) -> Iterator[RenderItem]:
    for collision in link.collisions:
        geometry = _drawable(collision.geometry)
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


def _drawable(geometry: Geometry) -> Primitive | Mesh | None:
    """The shape, if there is something to draw it from."""
    if isinstance(geometry, Mesh):
        return geometry if geometry.path is not None else None
    return geometry if isinstance(geometry, (Box, Cylinder, Sphere, Capsule)) else None


def _color(visual: Visual, unpainted: Rgba) -> Rgba:
    """Its color, but for black, which is painted as little brighter as shows its edges."""
    red, green, blue, alpha = visual.rgba or (WHITE if visual.texture else unpainted)
    is_black = max(red, green, blue) < BLACKEST
    return (BLACKEST, BLACKEST, BLACKEST, alpha) if is_black else (red, green, blue, alpha)

"""Primitive shapes as triangles for drawing: round ones round, edges sharp."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsgen.model.robot import Box, Capsule, Sphere

if TYPE_CHECKING:
    from wsgen.model.robot import Primitive

Vector = tuple[float, float, float]
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

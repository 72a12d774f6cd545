"""How far shapes reach: down, and out of the convex hull of others."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.robot import Box, Capsule, Cylinder, Primitive, Sphere
from wsgen.model.transform import Vector, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from wsgen.model.pose import Pose
    from wsgen.model.robot import Collision, Geometry

HULL_TOLERANCE = 1e-5  # m; what sticks out of a convex hull by less is on it


def lowest_point(geometry: Geometry, pose_in_world: Pose) -> float | None:
    """The z of the lowest point of a primitive, m; None for others, whose points are in files."""
    x, y, z = (abs(part) for part in rotation_of_rpy(pose_in_world.rpy)[2])
    if not isinstance(geometry, Primitive):
        return None
    if isinstance(geometry, Box):
        reach = sum(part * edge / 2 for part, edge in zip((x, y, z), geometry.size, strict=True))
    elif isinstance(geometry, Sphere):
        reach = geometry.radius
    elif isinstance(geometry, Capsule):
        reach = z * geometry.length / 2 + geometry.radius
    else:
        reach = _of_cylinder(geometry, math.hypot(x, y), z)
    return pose_in_world.xyz[2] - reach


def _of_cylinder(cylinder: Cylinder, across: float, along: float) -> float:
    return along * cylinder.length / 2 + across * cylinder.radius


def inside_hull(collisions: Sequence[Collision]) -> set[int]:
    """The numbers of the primitives that do not span the convex hull of all of them.

    The others alone have the same hull, but for `HULL_TOLERANCE`: whatever touches all of them
    from outside with a plane touches the same hull. A mesh, whose points are in a file, is taken
    for one that spans it.
    """
    points: list[Vector] = []
    owners: list[int] = []
    for number, collision in enumerate(collisions):
        if isinstance(collision.geometry, Primitive):
            points += _placed(_points_of(collision.geometry), collision.pose_in_link)
            owners += [number] * (len(points) - len(owners))
    faces = _hull(points)
    spanning = {owners[corner] for face in faces for corner in face.corners}
    return {
        number
        for number in set(owners) - spanning
        if faces and _is_within(faces, collisions[number])
    }


def _is_within(faces: Sequence[_Face], collision: Collision) -> bool:
    """Whether no point of a primitive, of which `_points_of` is in a hull, is outside of it."""
    if not isinstance(collision.geometry, Cylinder | Sphere | Capsule):
        return True  # a box has no more points
    return all(
        face.height(corner) <= HULL_TOLERANCE
        for corner in _placed(_box_around(collision.geometry), collision.pose_in_link)
        for face in faces
    )


def _placed(points: Iterable[Vector], pose: Pose) -> Iterator[Vector]:
    """The points of a shape, seen from its link."""
    rotation, (x, y, z) = rotation_of_rpy(pose.rpy), pose.xyz
    for point in points:
        a, b, c = rotate(rotation, point)
        yield (x + a, y + b, z + c)


def _box_around(geometry: Primitive) -> Iterator[Vector]:
    """The corners of a primitive's box."""
    if isinstance(geometry, Box):
        reach = geometry.size
    else:
        width = 2 * geometry.radius
        height = 0.0 if isinstance(geometry, Sphere) else geometry.length
        reach = (width, width, height if isinstance(geometry, Cylinder) else height + width)
    for signs in product((-0.5, 0.5), repeat=3):
        x, y, z = (sign * edge for sign, edge in zip(signs, reach, strict=True))
        yield (x, y, z)


def _points_of(geometry: Primitive) -> Iterator[Vector]:
    """All corners of a box; the outermost points of what is round along its own axes."""
    if isinstance(geometry, Box):
        yield from _box_around(geometry)
        return
    r, half = geometry.radius, 0.0 if isinstance(geometry, Sphere) else geometry.length / 2
    for side in (-1, 1):
        yield from ((side * r, 0.0, end) for end in (-half, half))
        yield from ((0.0, side * r, end) for end in (-half, half))
        if not isinstance(geometry, Cylinder):
            yield (0.0, 0.0, side * (half + r))


class _Face(NamedTuple):
    """A triangle of a convex hull."""

    corners: tuple[int, int, int]  # numbers of points; seen from outside they go round to the left
    normal: Vector  # outwards, of length 1
    offset: float  # m, of the triangle's plane along the normal

    def height(self, point: Vector) -> float:
        """How far a point is outside of the plane, m."""
        return _dot(self.normal, point) - self.offset


def _hull(points: Sequence[Vector]) -> list[_Face]:
    """The convex hull by quickhull; empty if the points are all in one plane.

    A point that is outside by less than `HULL_TOLERANCE` is taken for one inside.
    """
    outside: dict[_Face, list[int]] = {}  # with points that are outside of each, each point once
    _share(points, range(len(points)), _tetrahedron(points), outside)
    while (top := next((face for face, seen in outside.items() if seen), None)) is not None:
        tip = _farthest(points, outside[top], top.height)
        lit = [face for face in outside if face.height(points[tip]) > HULL_TOLERANCE]
        edges = {
            edge for a, b, c in (face.corners for face in lit) for edge in ((a, b), (b, c), (c, a))
        }
        rim = [edge for edge in edges if edge[::-1] not in edges]
        left = [number for face in lit for number in outside.pop(face)]
        _share(points, left, [_face(points, a, b, tip) for a, b in rim], outside)
    return list(outside)


def _farthest(
    points: Sequence[Vector], numbers: Iterable[int], distance: Callable[[Vector], float]
) -> int:
    """The number of the farthest point; of points as far, an outer one, which is a corner."""
    return max(
        numbers,
        key=lambda number: (round(distance(points[number]) / HULL_TOLERANCE), points[number]),
    )


def _share(
    points: Sequence[Vector],
    numbers: Iterable[int],
    faces: Sequence[_Face],
    outside: dict[_Face, list[int]],
) -> None:
    """Add the faces, each with those of the points that are outside of it and of no earlier one."""
    outside.update((face, []) for face in faces)
    for number in numbers:
        for face in faces:
            if face.height(points[number]) > HULL_TOLERANCE:
                outside[face].append(number)
                break


def _tetrahedron(points: Sequence[Vector]) -> list[_Face]:
    """Four faces that enclose some of the space between the points; none if there is none."""
    if not points:
        return []
    numbers = range(len(points))
    a = min(numbers, key=lambda number: points[number])
    b = _farthest(points, numbers, lambda point: math.dist(point, points[a]))
    length = math.dist(points[a], points[b])
    if length <= HULL_TOLERANCE:
        return []
    along = _minus(points[b], points[a])
    c = _farthest(
        points,
        numbers,
        lambda point: math.hypot(*_cross(along, _minus(point, points[a]))) / length,
    )
    if math.hypot(*_cross(along, _minus(points[c], points[a]))) <= HULL_TOLERANCE * length:
        return []
    base = _face(points, a, b, c)
    d = _farthest(points, numbers, lambda point: abs(base.height(point)))
    height = base.height(points[d])
    if abs(height) <= HULL_TOLERANCE:
        return []
    if height > 0:
        b, c = c, b
    corners = ((a, b, c), (a, d, b), (b, d, c), (c, d, a))
    return [_face(points, *three) for three in corners]


def _face(points: Sequence[Vector], a: int, b: int, c: int) -> _Face:
    """The triangle; its corners are not on one line."""
    normal = _cross(_minus(points[b], points[a]), _minus(points[c], points[a]))
    length = math.hypot(*normal)
    x, y, z = (part / length for part in normal)
    return _Face((a, b, c), (x, y, z), _dot((x, y, z), points[a]))


def _minus(left: Vector, right: Vector) -> Vector:
    return (left[0] - right[0], left[1] - right[1], left[2] - right[2])


def _dot(left: Vector, right: Vector) -> float:
    return left[0] * right[0] + left[1] * right[1] + left[2] * right[2]


def _cross(left: Vector, right: Vector) -> Vector:
    (a, b, c), (x, y, z) = left, right
    return (b * z - c * y, c * x - a * z, a * y - b * x)

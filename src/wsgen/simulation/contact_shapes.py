"""Groups the collisions of a link for PyBullet: by friction, and whether level ground touches them.

It needs to know how far shapes reach: down, and out of the convex hull of others.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.kinematics import split_trees
from wsgen.model.robot import (
    MOST_LINKS,
    Box,
    Capsule,
    Cylinder,
    Inertial,
    Joint,
    JointType,
    Link,
    Primitive,
    Sphere,
)
from wsgen.model.transform import Vector, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.model.robot import Collision, Robot
    from wsgen.model.transform import Pose


HULL_TOLERANCE = 1e-5  # m; what sticks out of a convex hull by less is on it


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
        for corner in _placed(box_around(collision.geometry), collision.pose_in_link)
        for face in faces
    )


def _placed(points: Iterable[Vector], pose: Pose) -> Iterator[Vector]:
    """The points of a shape, seen from its link."""
    rotation, (x, y, z) = rotation_of_rpy(pose.rpy), pose.xyz
    for point in points:
        a, b, c = rotate(rotation, point)
        yield (x + a, y + b, z + c)


def box_around(geometry: Primitive) -> Iterator[Vector]:
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
        yield from box_around(geometry)
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


# Of one friction in one link; with more of them, those inside the convex hull do not touch the
# ground. A thousand boxes flat on the ground are 4000 contacts, of which four hold them.
MOST_STANDING = 16

NOTHING = Inertial(mass=0.0, inertia=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def one_friction_a_link(tree: Robot) -> tuple[Robot, dict[str, str]]:
    """The same tree with one friction in every link.

    A caster that is lumped into its chassis has another friction than the chassis. Where a link has
    several, all but the first go into links without mass that are fixed to it. Gives with the tree
    the link that every link of it belongs to, by name.
    """
    links: list[Link] = []
    joints = list(tree.joints)
    owner = {link.name: link.name for link in tree.links}
    for link in tree.links:
        groups = _by_friction(link)
        if len(groups) < 2:  # noqa: PLR2004  one friction, or none
            links.append(link)
            continue
        first, *others = groups.values()
        links.append(replace(link, collisions=tuple(link.collisions[place] for place in first)))
        for number, collisions in enumerate(others, 1):
            name = _unused(f"{link.name} surface {number}", owner)
            owner[name] = link.name
            part, joint = _part_of(link, name, collisions)
            links.append(part)
            joints.append(joint)
    return replace(tree, links=tuple(links), joints=tuple(joints)), owner


def most_parts(robot: Robot) -> int:
    """How many links with one friction each the largest of its trees has."""
    return max(
        (len(one_friction_a_link(tree)[0].links) for tree, _ in split_trees(robot)), default=0
    )


def inner_collisions(link: Link) -> set[int]:
    """The numbers of those collisions that level ground need not touch.

    A plane holds a body by the convex hull of what touches it. What of one friction does not span
    the hull of its kind is in the air, or on the ground between others that hold the body without
    it: then only the distribution of the friction is another one. In an ordinary robot it is none.
    """
    inner: set[int] = set()
    for numbers in _by_friction(link).values():
        if len(numbers) > MOST_STANDING:
            inside = inside_hull([link.collisions[number] for number in numbers])
            inner |= {numbers[place] for place in inside}
    return inner


def inner_apart(
    tree: Robot, owner: Mapping[str, str]
) -> tuple[Robot, dict[str, str], tuple[str, ...]]:
    """A tree and its owners, as of `one_friction_a_link`, with the inner collisions apart.

    They are in links without mass that are fixed to theirs; the names of these come with the tree.
    What is static, which the ground does not touch, stays as it is, and so does a tree that would
    have more than `MOST_LINKS`.
    """
    links: list[Link] = []
    joints = list(tree.joints)
    owner_of = dict(owner)
    apart: list[str] = []
    for link in tree.links:
        inner = set() if tree.is_static else inner_collisions(link)
        if not inner:
            links.append(link)
            continue
        outer = [shape for number, shape in enumerate(link.collisions) if number not in inner]
        name = _unused(f"{link.name} inside", owner_of)
        owner_of[name] = owner[link.name]
        apart.append(name)
        part, joint = _part_of(link, name, sorted(inner))
        links += [replace(link, collisions=tuple(outer)), part]
        joints.append(joint)
    if len(links) > MOST_LINKS:
        return tree, dict(owner), ()
    return replace(tree, links=tuple(links), joints=tuple(joints)), owner_of, tuple(apart)


def _part_of(link: Link, name: str, numbers: Iterable[int]) -> tuple[Link, Joint]:
    """A link without mass for some of a link's collisions, and what fixes it there."""
    part = Link(
        name=name,
        inertial=NOTHING,
        collisions=tuple(link.collisions[number] for number in numbers),
        self_collide=link.self_collide,
    )
    return part, Joint(name=name, type=JointType.FIXED, parent=link.name, child=name)


def _by_friction(link: Link) -> dict[tuple[float, float], list[int]]:
    """The numbers of the collisions of each friction."""
    groups: dict[tuple[float, float], list[int]] = {}
    for number, collision in enumerate(link.collisions):
        groups.setdefault(collision.surface.along_world, []).append(number)
    return groups


def _unused(name: str, taken: Mapping[str, str]) -> str:
    while name in taken:
        name += "'"
    return name

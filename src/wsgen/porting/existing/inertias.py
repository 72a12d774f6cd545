"""The inertia of links: of the shapes that they have, and whether it is about the right point."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.inertia import (
    Six,
    about_link_axes,
    is_possible,
    matrix_of,
    moved,
    of_solid,
    turned,
)
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Sphere
from wsgen.model.transform import (
    IDENTITY,
    Vector,
    invert,
    rotate,
    rotation_of_rpy,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from wsgen.descriptions.meshes.requests import Solid
    from wsgen.model.robot import Geometry, Link, Robot
    from wsgen.model.transform import Pose

    # Path and scale of meshes -> what they have as solid bodies of density 1.
    Measure = Callable[[Sequence[tuple[str, Vector]]], Sequence[Solid | None]]


DENSITY = 1000.0  # kg/m³, of a link without a mass; that of water, and of many robots on average
# Shares of the inertia that the meshes of a link give: what is near, and what is far from it.
NEAR, FAR = 0.05, 0.3


class Body(NamedTuple):
    """Shapes that are filled."""

    mass: float  # kg
    center: Vector  # of mass, m
    inertia: Six  # about the center, kg m²
    is_known: bool = True  # all shapes have a volume that is closed


class Misplaced(NamedTuple):
    """An inertia that is not about the center of mass, as URDF has it."""

    link: str
    where: str  # about which point, or along which axes it is
    inertia: Six  # about the center of mass, along the axes of the link, kg m²


def filled(shapes: Sequence[tuple[Geometry, Pose]], measure: Measure) -> Body:
    """Mass, center and inertia of shapes with their poses; a mass of 0 where none has a volume."""
    meshes = [(one.path, one.scale) for one, _ in shapes if isinstance(one, Mesh) and one.path]
    solids = dict(zip(meshes, measure(meshes), strict=True)) if meshes else {}
    bodies = [(_solid_of(geometry, solids), pose) for geometry, pose in shapes]
    known = [(body, pose) for body, pose in bodies if body is not None]
    mass = sum(body.mass for body, _ in known)
    if mass <= 0:
        return Body(0.0, (0.0, 0.0, 0.0), (0.0,) * 6, is_known=False)
    placed = []
    for body, pose in known:
        turn = rotation_of_rpy(pose.rpy)
        x, y, z = rotate(turn, body.center)
        placed.append((body.mass, (pose.x + x, pose.y + y, pose.z + z), turned(body.inertia, turn)))
    x, y, z = (sum(own * at[i] for own, at, _ in placed) / mass for i in range(3))
    total: Six = (0.0,) * 6
    for own, at, six in placed:
        offset = (at[0] - x, at[1] - y, at[2] - z)
        total = _sum(total, moved(six, own, offset))
    is_known = len(known) == len(bodies) and all(body.is_known for body, _ in known)
    return Body(mass, (x, y, z), total, is_known)


def _sum(one: Six, other: Six, factor: float = 1.0) -> Six:
    xx, xy, xz, yy, yz, zz = (a + factor * b for a, b in zip(one, other, strict=True))
    return (xx, xy, xz, yy, yz, zz)


def _solid_of(geometry: Geometry, solids: dict[tuple[str, Vector], Solid | None]) -> Body | None:
    """A filled shape, in its frame."""
    if isinstance(geometry, Mesh):
        solid = solids.get((geometry.path or "", geometry.scale))
        if solid is None:
            return None
        xx, xy, xz, yy, yz, zz = (DENSITY * one for one in solid.inertia)
        inertia = (xx, xy, xz, yy, yz, zz)
        return Body(DENSITY * solid.volume, solid.center, inertia, solid.is_closed)
    volume = _volume(geometry)
    moments = None if volume is None else of_solid(geometry, DENSITY * volume)
    if volume is None or moments is None:
        return None
    x, y, z = moments
    return Body(DENSITY * volume, (0.0, 0.0, 0.0), (x, 0.0, 0.0, y, 0.0, z))


def _volume(geometry: Geometry) -> float | None:
    if isinstance(geometry, Box):
        return math.prod(geometry.size)
    if isinstance(geometry, Sphere):
        return 4 / 3 * math.pi * geometry.radius**3
    if isinstance(geometry, Cylinder | Capsule):
        ends = 4 / 3 * math.pi * geometry.radius**3 if isinstance(geometry, Capsule) else 0.0
        return math.pi * geometry.radius**2 * geometry.length + ends
    return None


def misplaced(robot: Robot, measure: Measure) -> list[Misplaced]:
    """Inertias that are not about the center of mass, but about an origin, as CAD shows them, too.

    The meshes of a link, filled evenly, tell: about one of these points the inertia agrees with
    them, and about the others, with the center of mass, it is far from it. Nothing is said of a
    link for which that is not so. Only those are measured whose inertia is larger than that of the
    whole box around their shapes.
    """
    poses = link_poses(robot, IDENTITY)
    likely = {}
    for link in robot.links:
        read = [*_readings(link, poses[link.name])] if link.name in poses else []
        shapes = [(one.geometry, one.pose_in_link) for one in link.visuals or link.collisions]
        if len(read) > 1 and link.inertial is not None:
            radius = _gyration(read[0][1], link.inertial.mass)
            if 0 < _gyration_of_box(shapes) < radius:
                likely[link] = (read, shapes)
    # One question for all: each is a process.
    meshes = {
        (one.path, one.scale): None
        for _, shapes in likely.values()
        for one, _ in shapes
        if isinstance(one, Mesh) and one.path
    }
    solids = dict(zip(meshes, measure([*meshes]), strict=True)) if meshes else {}
    found = []
    for link, (read, shapes) in likely.items():
        body = filled(shapes, lambda asked: [solids[one] for one in asked])
        inertial = link.inertial
        if inertial is None or not body.is_known or not body.mass > 0:
            continue
        share = inertial.mass / body.mass
        xx, xy, xz, yy, yz, zz = (share * one for one in body.inertia)
        meant = (xx, xy, xz, yy, yz, zz)
        radius = _gyration(meant, inertial.mass)
        (_, given), *others = read
        where, six = min(others, key=lambda one: _distance(one[1], meant))
        rivals = [given, *(other for _, other in others if _distance(other, six) > NEAR)]
        if (
            math.dist(body.center, inertial.pose_in_link.xyz) < NEAR * radius
            and _distance(six, meant) < NEAR
            and all(_distance(other, meant) > FAR for other in rivals)
        ):
            found.append(Misplaced(link.name, where, six))
    return found


def _readings(link: Link, pose: Pose) -> Iterator[tuple[str, Six]]:
    """Ways to read an inertia: about the center of mass, first as URDF has it.

    `pose` is that of the link, seen from the root with all joints at zero: from where exports of
    CAD see all parts.
    """
    inertial = link.inertial
    if inertial is None or inertial.mass <= 0 or not any(inertial.inertia):
        return
    given, center = about_link_axes(inertial), inertial.pose_in_link.xyz
    yield "", given
    for where, point in (("link", IDENTITY.xyz), ("root link", invert(pose).xyz)):
        x, y, z = (a - b for a, b in zip(center, point, strict=True))
        found = _sum(given, moved((0.0,) * 6, inertial.mass, (x, y, z)), -1.0)
        if is_possible(found):
            yield f"about the origin of the {where}", found


def _gyration(six: Six, mass: float) -> float:
    """The radius of gyration about a point, m."""
    return math.sqrt(max(0.0, six[0] + six[3] + six[5]) / 2 / mass)


def _gyration_of_box(shapes: Sequence[tuple[Geometry, Pose]]) -> float:
    """That of the filled box around shapes, a mesh among them; 0 if that is not known."""
    if not any(isinstance(one, Mesh) for one, _ in shapes):
        return 0.0
    corners = [
        rotate(rotation_of_rpy(pose.rpy), (x, y, z))
        for geometry, pose in shapes
        for x, y, z in itertools.product(*box_of(geometry))
    ]
    places = [pose.xyz for _, pose in shapes for _ in range(8)]
    edges = [
        max(a[i] + b[i] for a, b in zip(corners, places, strict=True))
        - min(a[i] + b[i] for a, b in zip(corners, places, strict=True))
        for i in range(3)
    ]
    return math.hypot(*edges) / math.sqrt(12)


def _distance(one: Six, other: Six) -> float:
    """How far an inertia is from another one, as a share of that (the norm of the matrix)."""
    apart = matrix_of(_sum(one, other, -1.0))
    return math.hypot(*apart[0], *apart[1], *apart[2]) / (
        math.hypot(*(value for row in matrix_of(other) for value in row)) or 1.0
    )


def box_of(geometry: Geometry) -> Sequence[tuple[float, float]]:
    """From where to where a shape reaches along each of its axes, m."""
    if isinstance(geometry, Mesh) and geometry.bounds is not None:
        low, high = geometry.bounds
        return [(a * s, b * s) for a, b, s in zip(low, high, geometry.scale, strict=True)]
    if isinstance(geometry, Box):
        return [(-edge / 2, edge / 2) for edge in geometry.size]
    if isinstance(geometry, Sphere | Cylinder | Capsule):
        half = 0.0 if isinstance(geometry, Sphere) else geometry.length / 2
        half += 0.0 if isinstance(geometry, Cylinder) else geometry.radius
        return [(-geometry.radius, geometry.radius)] * 2 + [(-half, half)]
    return [(0.0, 0.0)] * 3

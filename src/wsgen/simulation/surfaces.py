"""Where the surfaces of a robot are: its lowest point, corners around it, how far from a point."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Primitive, Sphere
from wsgen.model.transform import Pose, compose, invert, rotation_of_rpy
from wsgen.simulation.contact_shapes import box_around
from wsgen.simulation.engine import HullGap

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from numpy.typing import NDArray

    from wsgen.model.robot import Collision, Link, Robot
    from wsgen.model.transform import Vector


NO_GAP = 0.005  # m; engines find contacts up to a millimeter beside what touches


class UnreadError(Exception):
    """Why a mesh cannot be touched; it never leaves an engine."""


@lru_cache(maxsize=256)
def triangles_of(mesh: Mesh) -> NDArray[np.float64]:
    """The scaled triangles of a mesh that has a file, shape (n, 3, 3), n at least 1, m.

    Raises:
        UnreadError: They cannot be used.
    """
    # The readers take as long to import as a simulation, and many robots have no meshes.
    from wsgen.descriptions.meshes.content import BrokenMeshError  # noqa: PLC0415
    from wsgen.descriptions.meshes.worker import read_mesh  # noqa: PLC0415

    try:
        corners: NDArray[np.float64] = read_mesh(Path(str(mesh.path))).corners * np.array(
            mesh.scale
        )
    except (BrokenMeshError, OSError) as problem:
        raise UnreadError(f"it cannot read the mesh {mesh.path}: it {problem}") from None
    if not len(corners) or not np.isfinite(corners).all():
        raise UnreadError(
            f"it cannot use the mesh {mesh.path}: it has no triangles, or triangles "
            "that are too far away"
        )
    return corners


Touchable = Primitive | Mesh


def there(link: Link) -> Iterator[tuple[Touchable, Collision]]:
    """The collisions that can touch something: not meshes without a file, nor unknown shapes."""
    for collision in link.collisions:
        geometry = collision.geometry
        if isinstance(geometry, Primitive) or (isinstance(geometry, Mesh) and geometry.path):
            yield geometry, collision


def _placed(robot: Robot, poses: Mapping[str, Pose]) -> Iterator[tuple[Touchable, Pose]]:
    """What can be touched, with its pose in the world; those of the links are given by name."""
    for link in robot.links:
        for geometry, collision in there(link):
            yield geometry, compose(poses[link.name], collision.pose_in_link)


def lowest_point(robot: Robot, poses: Mapping[str, Pose]) -> float:
    """The z of the lowest point that can touch something, m; that of the root without any.

    The poses of the links are seen from the world.
    """
    lowest = (pose.xyz[2] - reach_down(shape, pose) for shape, pose in _placed(robot, poses))
    return min(lowest, default=poses[robot.root].xyz[2])


def lowest_points(robot: Robot, poses: Mapping[str, Pose]) -> dict[str, float]:
    """The z of the lowest point of each link that can touch something, m, by its name.

    The poses of the links are seen from the world.
    """
    found: dict[str, float] = {}
    for link in robot.links:
        for geometry, collision in there(link):
            pose = compose(poses[link.name], collision.pose_in_link)
            lowest = pose.xyz[2] - reach_down(geometry, pose)
            found[link.name] = min(lowest, found.get(link.name, lowest))
    return found


def reach_down(geometry: Touchable, pose: Pose) -> float:
    """How far it reaches below its frame, m."""
    down = rotation_of_rpy(pose.rpy)[2]
    if isinstance(geometry, Mesh):
        return -float((triangles_of(geometry) @ down).min())
    x, y, z = map(abs, down)
    if isinstance(geometry, Box):
        return sum(part * edge / 2 for part, edge in zip((x, y, z), geometry.size, strict=True))
    if isinstance(geometry, Sphere):
        return geometry.radius
    if isinstance(geometry, Capsule):
        return z * geometry.length / 2 + geometry.radius
    return z * geometry.length / 2 + math.hypot(x, y) * geometry.radius


def corners(robot: Robot, poses: Mapping[str, Pose]) -> list[Vector]:
    """The corners of boxes around all that can touch something, m; the root without any."""
    found = []
    for geometry, pose in _placed(robot, poses):
        found += [compose(pose, Pose(xyz=corner)).xyz for corner in _box_around(geometry)]
    return found or [poses[robot.root].xyz]


def _box_around(geometry: Touchable) -> Iterator[Vector]:
    if isinstance(geometry, Mesh):
        points = triangles_of(geometry).reshape(-1, 3)
        yield from product(*np.stack([points.min(axis=0), points.max(axis=0)], axis=1).tolist())
    else:
        yield from box_around(geometry)


MOST_PAIRS = 1 << 18  # of a ray and a triangle, at a time


def cast_rays(
    begins: NDArray[np.float64], ways: NDArray[np.float64], triangles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The fractions of their ways that rays get through triangles, shape (n,); infinity if through.

    Rays are where they begin and their ways, each of shape (n, 3); triangles are three corners,
    shape (m, 3, 3). All are in one frame, m. After Möller and Trumbore, "Fast, Minimum Storage
    Ray/Triangle Intersection" (1997).
    """
    fractions = np.full(len(begins), np.inf)
    if not len(triangles):
        return fractions
    corner = triangles[:, 0]
    first, second = triangles[:, 1] - corner, triangles[:, 2] - corner
    stride = max(1, MOST_PAIRS // len(triangles))
    for place in range(0, len(begins), stride):
        some = slice(place, place + stride)
        way = ways[some, None]
        normal = np.cross(way, second)
        offset = begins[some, None] - corner
        other = np.cross(offset, first)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = 1.0 / (first * normal).sum(axis=2)
            u = (offset * normal).sum(axis=2) * scale
            v = (way * other).sum(axis=2) * scale
            at = (second * other).sum(axis=2) * scale
            is_hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (at >= 0.0) & (at <= 1.0)
        fractions[some] = np.where(is_hit, at, np.inf).min(axis=1)
    return fractions


def hull_gaps(
    robot: Robot, poses: Mapping[str, Pose], touched: Iterable[tuple[str, str, Vector]]
) -> list[HullGap]:
    """Where meshes are touched that are farther from their triangles than `NO_GAP`.

    `touched` are the points where the links of a robot, by name, touch other entities; level
    ground is none of them. One gap a link and entity, the widest.
    """
    widest: dict[tuple[str, str], float] = {}
    for link, entity, point in touched:
        shapes = list(there(robot.link(link)))
        if any(isinstance(geometry, Mesh) for geometry, _ in shapes):
            in_link = compose(invert(poses[link]), Pose(xyz=point))
            gap = min(
                _distance(geometry, compose(invert(shape.pose_in_link), in_link).xyz)
                for geometry, shape in shapes
            )
            widest[link, entity] = max(gap, widest.get((link, entity), 0.0))
    return [
        HullGap(link=link, other_entity=entity, gap=gap)
        for (link, entity), gap in widest.items()
        if gap > NO_GAP
    ]


def _distance(geometry: Touchable, at: Vector) -> float:
    """How far a point is from a shape, seen from that, m; 0 inside of a primitive."""
    if isinstance(geometry, Mesh):
        return _to_triangles(triangles_of(geometry) - np.array(at))
    if isinstance(geometry, Box):
        beyond = (abs(part) - edge / 2 for part, edge in zip(at, geometry.size, strict=True))
        return math.hypot(*(max(0.0, part) for part in beyond))
    across = math.hypot(*at[:2])
    above = max(0.0, abs(at[2]) - (0.0 if isinstance(geometry, Sphere) else geometry.length / 2))
    if isinstance(geometry, Cylinder):
        return math.hypot(max(0.0, across - geometry.radius), above)
    return max(0.0, math.hypot(across, above) - geometry.radius)


def _to_triangles(corners: NDArray[np.float64]) -> float:
    """How far the origin is from the nearest of the triangles, shape (n, 3, 3)."""
    edges = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(edges[:, 0], edges[:, 1])
    with np.errstate(all="ignore"):  # some have no area
        shares = -(corners * edges).sum(axis=2) / (edges * edges).sum(axis=2)
        heights = (corners[:, 0] * normals).sum(axis=1) ** 2 / (normals * normals).sum(axis=1)
    on_edges = corners + np.nan_to_num(shares).clip(0.0, 1.0)[..., None] * edges
    squares = (on_edges * on_edges).sum(axis=2).min(axis=1)
    is_above = ((np.cross(corners, edges) * normals[:, None]).sum(axis=2) >= 0).all(axis=1)
    squares = np.where(is_above & (heights < squares), heights, squares)
    return math.sqrt(float(squares.min()))

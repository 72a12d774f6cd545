"""Where PyBullet's convex hulls touch something that the triangles of a mesh do not reach.

On level ground the two are the same: the corners of a hull are corners of its mesh. On and between
other things they are not, and Gazebo takes the triangles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.pose import Pose
from wsgen.model.robot import Box, Capsule, Cylinder, Mesh, Sphere
from wsgen.model.transform import compose, invert, quaternion_of_rpy
from wsgen.simulation.bullet_client import Client
from wsgen.simulation.engine import HullGap

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.model.robot import Collision
    from wsgen.model.transform import Vector
    from wsgen.simulation.bullet_body import BulletBody

PROBE = 1e-4  # m, radius of the sphere that feels for a surface
MARGIN = 0.001  # m, PyBullet's around convex shapes
# m; how far it feels, one after the other: far is slow, and near is usual.
REACHES = (0.005, 0.02, 0.1, 1.0)


def hull_gaps(
    client: Client, body: BulletBody, others: Iterable[tuple[int, str]]
) -> Iterator[HullGap]:
    """The contacts of a body's meshes that are farther from the triangles than the first reach.

    `others` are the bodies that it may rest on, with their entities; level ground is none of them.
    One gap a link and entity, the widest.
    """
    entities = dict(others)
    touched = [
        (link, entities[contact[2]], tuple(contact[5]))
        for contact in client.getContactPoints(bodyA=body.number)
        if contact[2] in entities and contact[9] > 0  # presses on it
        for link in [body.link_of(contact[3])]
    ]
    widest: dict[tuple[str, str], float] = {}
    poses = body.link_poses() if touched else {}
    for link in {link for link, _, _ in touched}:
        collisions = body.tree.link(link).collisions
        if not any(isinstance(shape.geometry, Mesh) for shape in collisions):
            continue
        into_link = invert(poses[link])
        places = [(entity, point) for name, entity, point in touched if name == link]
        seen_from_link = [compose(into_link, Pose(xyz=point)).xyz for _, point in places]
        for (entity, _), gap in zip(places, _gaps(collisions, seen_from_link), strict=True):
            widest[link, entity] = max(gap, widest.get((link, entity), 0.0))
    for (link, entity), gap in widest.items():
        if gap > REACHES[0]:
            yield HullGap(link=link, other_entity=entity, gap=gap)


def _gaps(collisions: Sequence[Collision], points: Sequence[Vector]) -> list[float]:
    """How far each point is from the surfaces, m; both are seen from the link."""
    client = Client()  # a world where meshes are their triangles
    try:
        surfaces = [number for shape in collisions if (number := _place(client, shape)) is not None]
        probe = client.createMultiBody(
            baseCollisionShapeIndex=client.createCollisionShape(client.GEOM_SPHERE, radius=PROBE)
        )
        return [_gap(client, probe, surfaces, point) for point in points]
    finally:
        client.close()


def _gap(client: Client, probe: int, surfaces: Iterable[int], point: Vector) -> float:
    client.resetBasePositionAndOrientation(probe, point, (0, 0, 0, 1))
    for reach in REACHES:
        near = [
            found[8] + PROBE
            for surface in surfaces
            for found in client.getClosestPoints(probe, surface, distance=reach)
        ]
        if near:
            return float(max(0.0, min(near) - MARGIN))
    return REACHES[-1]


def _place(client: Client, shape: Collision) -> int | None:
    geometry = shape.geometry
    if isinstance(geometry, Mesh):
        if geometry.path is None:
            return None
        made = client.createCollisionShape(
            client.GEOM_MESH,
            fileName=geometry.path,
            meshScale=geometry.scale,
            flags=client.GEOM_FORCE_CONCAVE_TRIMESH,
        )
    elif isinstance(geometry, Box):
        half = tuple(edge / 2 for edge in geometry.size)
        made = client.createCollisionShape(client.GEOM_BOX, halfExtents=half)
    elif isinstance(geometry, Sphere):
        made = client.createCollisionShape(client.GEOM_SPHERE, radius=geometry.radius)
    elif isinstance(geometry, Cylinder | Capsule):
        kind = client.GEOM_CYLINDER if isinstance(geometry, Cylinder) else client.GEOM_CAPSULE
        made = client.createCollisionShape(kind, radius=geometry.radius, height=geometry.length)
    else:
        return None
    return int(
        client.createMultiBody(
            baseCollisionShapeIndex=made,
            basePosition=shape.pose_in_link.xyz,
            baseOrientation=quaternion_of_rpy(shape.pose_in_link.rpy),
        )
    )

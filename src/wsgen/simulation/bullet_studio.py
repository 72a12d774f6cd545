"""Photographs robots with PyBullet's software renderer, which needs no display."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.pose import Pose
from wsgen.model.robot import Mesh
from wsgen.model.transform import compose, quaternion_of_rpy
from wsgen.simulation import picture
from wsgen.simulation.bullet_client import Client
from wsgen.simulation.shot import Camera, Shot
from wsgen.simulation.tessellation import tessellate

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.model.robot import Visual
    from wsgen.model.transform import Vector

UNPAINTED = (0.75, 0.75, 0.78, 1.0)  # about what Gazebo shows without a material
LIGHT_DIRECTION = (0.5, -1.1, 2.0)  # towards the light
LIGHT_AMBIENT = 0.55
LIGHT_SPECULAR = 0.05


def draw(seen: Iterable[tuple[Visual, Pose]], corners: Iterable[Vector], file: Path) -> float:
    """Write a PNG of what is to be seen, each with its pose in the world.

    `corners` are points that must be in the picture besides (m, in the world). Gives the edge of
    the ground's squares, m.
    """
    client = Client()  # a world with nothing but what is seen
    try:
        points = list(corners)
        for visual, pose in seen:
            points += _place(client, visual, pose)
        eye, light = picture.cameras(points)
        return picture.save(_shoot(client, eye), _shoot(client, light), file)
    finally:
        client.close()


def _place(client: Client, visual: Visual, pose: Pose) -> list[Vector]:
    """Put something to be seen into the studio; gives points that it reaches to, where known."""
    geometry = visual.geometry
    rgba = visual.rgba or UNPAINTED
    points: list[Vector] = []
    if not isinstance(geometry, Mesh):
        surface = tessellate(geometry)
        points = surface.vertices
        shape = client.createVisualShape(
            client.GEOM_MESH,
            vertices=surface.vertices,
            indices=surface.indices,
            normals=surface.normals,
            uvs=[(0.0, 0.0)] * len(surface.vertices),
            rgbaColor=rgba,
        )
    elif geometry.path is not None:
        shape = client.createVisualShape(
            client.GEOM_MESH,
            fileName=geometry.path,
            meshScale=geometry.scale,
            rgbaColor=rgba,
        )
    else:
        return []
    client.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=pose.xyz,
        baseOrientation=quaternion_of_rpy(pose.rpy),
    )
    return [compose(pose, Pose(xyz=point)).xyz for point in points]


def _shoot(client: Client, camera: Camera) -> Shot:
    """What the studio looks like through a camera, drawn without a display."""
    view = client.computeViewMatrix(camera.eye, camera.target, (0.0, 0.0, 1.0))
    projection = client.computeProjectionMatrixFOV(
        camera.field_of_view, camera.aspect, camera.near, camera.far
    )
    _, _, rgba, depth, body = client.getCameraImage(
        camera.width,
        camera.height,
        view,
        projection,
        renderer=client.ER_TINY_RENDERER,
        shadow=0,  # the ground has them, see `picture`
        lightDirection=LIGHT_DIRECTION,
        lightAmbientCoeff=LIGHT_AMBIENT,
        lightDiffuseCoeff=1 - LIGHT_AMBIENT,
        lightSpecularCoeff=LIGHT_SPECULAR,
    )
    return Shot(camera, view, projection, rgba, depth, body)

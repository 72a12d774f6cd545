"""Photographs robots with PyBullet's software renderer, which needs no display.

PyBullet comes in as an argument: `wsgen.simulation.bullet` is the one module that imports it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen.model.pose import Pose
from wsgen.model.robot import Mesh
from wsgen.model.transform import compose, quaternion_of_rpy
from wsgen.simulation import picture
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


def draw(
    pybullet: Any, seen: Iterable[tuple[Visual, Pose]], corners: Iterable[Vector], file: Path
) -> float:
    """Write a PNG of what is to be seen, each with its pose in the world.

    `corners` are points that must be in the picture besides (m, in the world). Gives the edge of
    the ground's squares, m.
    """
    client = pybullet.connect(pybullet.DIRECT)  # a world with nothing but what is seen
    try:
        points = list(corners)
        for visual, pose in seen:
            points += _place(pybullet, client, visual, pose)
        eye, light = picture.cameras(points)
        return picture.save(_shoot(pybullet, client, eye), _shoot(pybullet, client, light), file)
    finally:
        pybullet.disconnect(physicsClientId=client)


def _place(pybullet: Any, client: int, visual: Visual, pose: Pose) -> list[Vector]:
    """Put something to be seen into the studio; gives points that it reaches to, where known."""
    geometry = visual.geometry
    rgba = visual.rgba or UNPAINTED
    points: list[Vector] = []
    if not isinstance(geometry, Mesh):
        surface = tessellate(geometry)
        points = surface.vertices
        shape = pybullet.createVisualShape(
            pybullet.GEOM_MESH,
            vertices=surface.vertices,
            indices=surface.indices,
            normals=surface.normals,
            uvs=[(0.0, 0.0)] * len(surface.vertices),
            rgbaColor=rgba,
            physicsClientId=client,
        )
    elif geometry.path is not None:
        shape = pybullet.createVisualShape(
            pybullet.GEOM_MESH,
            fileName=geometry.path,
            meshScale=geometry.scale,
            rgbaColor=rgba,
            physicsClientId=client,
        )
    else:
        return []
    pybullet.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=pose.xyz,
        baseOrientation=quaternion_of_rpy(pose.rpy),
        physicsClientId=client,
    )
    return [compose(pose, Pose(xyz=point)).xyz for point in points]


def _shoot(pybullet: Any, client: int, camera: Camera) -> Shot:
    """What the studio looks like through a camera, drawn without a display."""
    view = pybullet.computeViewMatrix(camera.eye, camera.target, (0.0, 0.0, 1.0))
    projection = pybullet.computeProjectionMatrixFOV(
        camera.field_of_view, camera.aspect, camera.near, camera.far
    )
    _, _, rgba, depth, body = pybullet.getCameraImage(
        camera.width,
        camera.height,
        view,
        projection,
        renderer=pybullet.ER_TINY_RENDERER,
        shadow=0,  # the ground has them, see `picture`
        lightDirection=LIGHT_DIRECTION,
        lightAmbientCoeff=LIGHT_AMBIENT,
        lightDiffuseCoeff=1 - LIGHT_AMBIENT,
        lightSpecularCoeff=LIGHT_SPECULAR,
        physicsClientId=client,
    )
    return Shot(camera, view, projection, rgba, depth, body)

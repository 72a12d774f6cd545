"""The renderer: PyBullet's software renderer, which needs no display."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.model.robot import Box, Mesh
from wsgen.model.transform import IDENTITY, quaternion_of_rpy, rotation_of_rpy
from wsgen.rendering.camera import Shot, Size, eye_camera
from wsgen.rendering.render_items import RenderItem, tessellate
from wsgen.simulation.bullet import Client

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose, Vector
    from wsgen.rendering.camera import Camera, Floats
    from wsgen.rendering.render_items import Poses


# A face that looks into the light is as bright as its color, as in Gazebo; one that looks away
# keeps this share.
LIGHT_AMBIENT = 0.55
LIGHT_SPECULAR = 0.05

# About what a shot takes, s of CPU time. It is computed and not measured, so that the same things
# get the same pictures on every machine, however busy it is.
PIXEL_SECONDS, TRIANGLE_SECONDS, BODY_SECONDS = 0.15e-6, 0.35e-6, 0.13e-3

UNLIT = 0.75  # brightness of what has no normals
SOLID = 0.95  # of alpha: what has less is transparent


class Renderer:
    """A world of render items, at first at its origin."""

    def __init__(self, render_items: Iterable[RenderItem], *, towards_light: Vector) -> None:
        self._client = Client()
        self._light = towards_light
        self._bodies = [(render_item, self._place(render_item)) for render_item in render_items]
        self._poses: dict[int, Pose] = {}  # of the bodies that are anywhere

    def _place(self, render_item: RenderItem) -> int:
        client, geometry = self._client, render_item.geometry
        if isinstance(geometry, Mesh):
            shape = client.createVisualShape(
                client.GEOM_MESH,
                fileName=geometry.path,
                meshScale=geometry.scale,
                rgbaColor=render_item.rgba,
            )
        else:
            surface = tessellate(geometry)
            shape = client.createVisualShape(
                client.GEOM_MESH,
                vertices=surface.vertices,
                indices=surface.indices,
                normals=surface.normals,
                uvs=[(0.0, 0.0)] * len(surface.vertices),
                rgbaColor=render_item.rgba,
            )
        body = int(client.createMultiBody(baseVisualShapeIndex=shape))
        if render_item.texture is not None:
            image = client.loadTexture(render_item.texture)
            client.changeVisualShape(body, -1, textureUniqueId=image, rgbaColor=render_item.rgba)
        return body

    @property
    def opacity(self) -> list[float]:
        """Of each body by its number, 0 to 1."""
        table = [1.0] * (max((body for _, body in self._bodies), default=0) + 1)
        for render_item, body in self._bodies:
            table[body] = render_item.rgba[3] if render_item.rgba[3] < SOLID else 1.0
        return table

    @property
    def triangles(self) -> int:
        """How many are drawn of all bodies."""
        return sum(render_item.triangles for render_item, _ in self._bodies)

    def shot_seconds(self, pixels: float) -> float:
        """About the CPU time that a shot of so many pixels takes on a usual computer, s."""
        bodies = len(self._bodies) * BODY_SECONDS + self.triangles * TRIANGLE_SECONDS
        return bodies + pixels * PIXEL_SECONDS

    def arrange(self, poses: Poses) -> None:
        """Put everything where its link is; what is nowhere keeps its place, or is not shown."""
        for render_item, body in self._bodies:
            pose = render_item.pose(poses)
            if pose is not None:
                self._poses[body] = pose
                self._client.resetBasePositionAndOrientation(
                    body, pose.xyz, quaternion_of_rpy(pose.rpy)
                )
            elif body not in self._poses:
                self._show(render_item, body, alpha=0.0)

    def points(self, which: Callable[[RenderItem], bool] = lambda _: True) -> dict[int, Floats]:
        """Points (n by 3, m, in the world) that bodies lie between, by the bodies' numbers.

        Left out are those of which no point is known.
        """
        return {
            body: np.array(points) @ np.array(rotation_of_rpy(pose.rpy)).T + pose.xyz
            for render_item, body in self._bodies
            if which(render_item)
            and (pose := self._poses.get(body))
            and (points := render_item.points())
        }

    def numbers(self, which: Callable[[RenderItem], bool]) -> set[int]:
        """The numbers of the bodies of such render items."""
        return {body for render_item, body in self._bodies if which(render_item)}

    def remove(self, which: Callable[[RenderItem, Floats], bool]) -> None:
        """Take out what is such a render item and lies between such points."""
        around = self.points()
        gone = {
            body
            for render_item, body in self._bodies
            if body in around and which(render_item, around[body])
        }
        for body in gone:
            self._client.removeBody(body)
        self._bodies = [
            (render_item, body) for render_item, body in self._bodies if body not in gone
        ]

    def shoot(self, camera: Camera, *, without: Container[int] = ()) -> Shot:
        """What is seen through a camera, without some of the bodies.

        What is transparent is drawn as solid.
        """
        left_out = [one for one in self._bodies if one[1] in without]
        for render_item, body in left_out:
            self._show(render_item, body, alpha=0.0)  # the renderer leaves that out
        shot = self._shoot(camera)
        for render_item, body in left_out:
            if body in self._poses:
                self._show(render_item, body, alpha=1.0)
        return shot

    def _shoot(self, camera: Camera) -> Shot:
        client = self._client
        view = client.computeViewMatrix(camera.eye, camera.target, camera.up)
        projection = client.computeProjectionMatrixFOV(
            camera.field_of_view, camera.aspect, camera.near, camera.far
        )
        _, _, *images = client.getCameraImage(
            camera.width,
            camera.height,
            view,
            projection,
            renderer=client.ER_TINY_RENDERER,
            shadow=0,  # the ground has them, see `picture`
            lightDirection=self._light,
            lightAmbientCoeff=LIGHT_AMBIENT,
            lightDiffuseCoeff=1 - LIGHT_AMBIENT,
            lightSpecularCoeff=LIGHT_SPECULAR,
        )
        body = _as_array(images.pop(), "i", camera)
        depth = _as_array(images.pop(), "f", camera)
        rgba = _as_array(images.pop(), "B", camera, 4)
        self._paint_unlit(rgba, body)
        return Shot(camera, view, projection, rgba, depth, body)

    def _paint_unlit(self, rgba: NDArray[np.uint8], body: NDArray[np.int32]) -> None:
        """Give what has no normals its color: many STL files have none, and are drawn in black."""
        colors = {
            number: render_item.rgba
            for render_item, number in self._bodies
            if isinstance(render_item.geometry, Mesh)
            and str(render_item.geometry.path).lower().endswith("stl")
        }
        if not colors:
            return
        rgb, numbers = rgba.reshape(-1, 4)[:, :3], body.reshape(-1)
        for number in np.unique(numbers[~rgb.any(axis=1)]).tolist():
            if number in colors:
                is_unlit = (numbers == number) & ~rgb.any(axis=1)
                rgb[is_unlit] = [round(255 * UNLIT * part) for part in colors[number][:3]]

    def _show(self, render_item: RenderItem, body: int, *, alpha: float) -> None:
        self._client.changeVisualShape(body, -1, rgbaColor=(*render_item.rgba[:3], alpha))

    def close(self) -> None:
        """Give everything back."""
        self._client.close()


def draw_a_box() -> bool:
    """Whether this machine's PyBullet can draw: a box, of which something must be seen."""
    box = Box(size=(1.0, 1.0, 1.0))
    renderer = Renderer(
        [RenderItem(entity="", link="", geometry=box, rgba=(1.0, 0.0, 0.0, 1.0))],
        towards_light=(0.0, 0.0, 1.0),
    )
    renderer.arrange({"": {"": IDENTITY}})
    (points,) = renderer.points().values()
    shot = renderer.shoot(eye_camera(points, Size(8, 6)))
    return bool((shot.body >= 0).any() and shot.rgba[shot.body >= 0].any())


def _as_array(image: Any, typecode: str, camera: Camera, *channels: int) -> NDArray[Any]:
    """An image of PyBullet (of a type of `struct`), height by width by its channels.

    Built without NumPy, as `pybullet-arm64` is, PyBullet gives a tuple of all numbers. It is packed
    as C has it first: of a tuple, NumPy takes five times as long to make an array.
    """
    if isinstance(image, tuple):
        packed = image if typecode == "B" else struct.pack(f"{len(image)}{typecode}", *image)
        image = np.frombuffer(bytearray(packed), dtype=typecode)
    return np.asarray(image).reshape(camera.height, camera.width, *channels)

"""A camera, and what a renderer saw through it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wsgen.model.transform import Vector


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from, as renderers want it (OpenGL's conventions)."""

    eye: Vector  # m
    target: Vector  # m
    up: Vector  # a direction that is up in the picture
    field_of_view: float  # degrees, vertical
    aspect: float  # width over height
    near: float  # m
    far: float  # m
    width: int  # pixels to render
    height: int


@dataclass(frozen=True)
class Shot:
    """What a renderer saw through a camera."""

    camera: Camera
    view: tuple[float, ...]  # 4 by 4, column-major: world to camera
    projection: tuple[float, ...]  # 4 by 4, column-major: camera to clip space
    rgba: NDArray[np.uint8]  # height by width by 4
    depth: NDArray[np.float32]  # height by width, 0 to 1, of the depth buffer
    body: NDArray[np.int32]  # height by width; negative where nothing is seen

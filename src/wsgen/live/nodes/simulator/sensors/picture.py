"""Cameras as SDF describes them, and what becomes of their pictures. No ROS in here.

Sources: gazebosim/gz-sensors, src/CameraSensor.cc (intrinsics), src/PointCloudUtil.cc;
ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_plugins/src/gazebo_ros_camera.cpp.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.live.nodes.simulator.elements import number, vector
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import FLOAT32, layout
from wsgen.model.devices import pose_of
from wsgen.model.transform import IDENTITY, Pose
from wsgen.rendering.sensor_camera import Lens, focal_length
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.devices import Element

    Depth = NDArray[np.float32]
    Rgb = NDArray[np.uint8]

MOST_PIXELS = 4096 * 4096
NARROWEST, WIDEST = 0.01, 3.1  # rad; a flat picture cannot see more than half of all around
LEAST_NEAR = 0.01  # m
ENCODINGS = {
    "R8G8B8": "rgb8",
    "RGB_INT8": "rgb8",
    "B8G8R8": "bgr8",
    "BGR_INT8": "bgr8",
    "L8": "mono8",
    "L_INT8": "mono8",
}
BRIGHTNESS = np.array([0.299, 0.587, 0.114], dtype=np.float32)  # of red, green and blue
CLASSIC_FIELDS = {"x": (0, FLOAT32), "y": (4, FLOAT32), "z": (8, FLOAT32), "rgb": (16, FLOAT32)}
CLASSIC_STEP = 32
GZ_FIELDS = {**CLASSIC_FIELDS, "rgb": (12, FLOAT32)}
GZ_STEP = 16


@dataclass(frozen=True, kw_only=True)
class CameraSpec:
    """What a <camera> says."""

    lens: Lens
    pose: Pose = IDENTITY  # in the sensor
    encoding: str = "rgb8"
    near: float  # m, what a depth camera measures
    far: float  # m
    distortion: tuple[float, ...] = (0.0,) * 5  # k1, k2, p1, p2, k3: published, not drawn
    noise: float = 0.0  # standard deviation, of brightness (0 to 1) or depth (m)
    noise_mean: float = 0.0


class Intrinsics(NamedTuple):
    """What sensor_msgs/CameraInfo has of a camera."""

    focal: tuple[float, float]  # pixels
    center: tuple[float, float]
    projected_focal: tuple[float, float]
    projected_center: tuple[float, float]
    shift: tuple[float, float] = (0.0, 0.0)  # Tx, Ty
    rectification: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # by rows

    @property
    def k(self) -> list[float]:
        """The matrix of the camera, by rows."""
        (fx, fy), (cx, cy) = self.focal, self.center
        return [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]

    @property
    def p(self) -> list[float]:
        """The matrix of the projection, by rows."""
        (fx, fy), (cx, cy), (tx, ty) = self.projected_focal, self.projected_center, self.shift
        return [fx, 0.0, cx, tx, 0.0, fy, cy, ty, 0.0, 0.0, 1.0, 0.0]


def read_camera(camera: Element, *, sees_near: bool) -> CameraSpec:
    """What a <camera> says; `sees_near` is of depth cameras of Gazebo Sim.

    Raises:
        CannotWorkError: A number of it is none, or makes no picture.
    """
    width = round(number(camera, "image/width", 320))
    height = round(number(camera, "image/height", 240))
    if not (width > 0 and height > 0 and width * height <= MOST_PIXELS):
        raise CannotWorkError(f"its picture has {width} by {height} pixels. Write <image> sizes.")
    field_of_view = number(camera, "horizontal_fov", 1.047)
    if not NARROWEST <= field_of_view <= WIDEST:
        raise CannotWorkError(
            f"its <horizontal_fov> is {field_of_view:g} rad. Write one up to {WIDEST:g}."
        )
    near, far = number(camera, "clip/near", 0.1), number(camera, "clip/far", 100.0)
    near = number(camera, "depth_camera/clip/near", near)
    far = number(camera, "depth_camera/clip/far", far)
    if not 0 < near < far:
        raise CannotWorkError(
            f"its <clip> goes from {near:g} m to {far:g} m. Write a <far> above the <near>."
        )
    focal = number(camera, "lens/intrinsics/fx", focal_length(width, field_of_view))
    written = camera.get("image/format", "R8G8B8")
    keys = ("k1", "k2", "p1", "p2", "k3")
    return CameraSpec(
        lens=Lens(
            width=width,
            height=height,
            focal=focal,
            # What is too near is measured as such, and hides what is behind it.
            near=min(near, LEAST_NEAR) if sees_near else near,
            far=far,
        ),
        pose=pose_of(camera.find("pose")),
        encoding=ENCODINGS.get(written, "rgb8"),
        near=near,
        far=far,
        distortion=tuple(number(camera, f"distortion/{key}", 0.0) for key in keys),
        noise=number(camera, "noise/stddev", 0.0),
        noise_mean=number(camera, "noise/mean", 0.0),
    )


def gz_intrinsics(camera: Element, spec: CameraSpec) -> Intrinsics:
    """Those of Gazebo Sim: the center is the middle, unless <lens> says otherwise."""
    lens = spec.lens
    middle = {"fx": lens.focal, "fy": lens.focal, "cx": lens.width / 2, "cy": lens.height / 2}
    one = {key: number(camera, f"lens/intrinsics/{key}", middle[key]) for key in middle}
    other = {key: number(camera, f"lens/projection/p_{key}", one[key]) for key in middle}
    return Intrinsics(
        (one["fx"], one["fy"]),
        (one["cx"], one["cy"]),
        (other["fx"], other["fy"]),
        (other["cx"], other["cy"]),
        (
            number(camera, "lens/projection/tx", 0.0),
            number(camera, "lens/projection/ty", 0.0),
        ),
    )


def classic_intrinsics(plugin: Element, spec: CameraSpec) -> Intrinsics:
    """Those of Gazebo Classic's plugin: its center is half a pixel beside the middle."""
    lens = spec.lens
    center = (
        number(plugin, "cx", (lens.width + 1) / 2),
        number(plugin, "cy", (lens.height + 1) / 2),
    )
    focal = number(plugin, "focal_length") or lens.focal
    baseline = number(plugin, "hack_baseline")
    return Intrinsics(
        (focal, focal),
        center,
        (number(plugin, "P_fx", focal), number(plugin, "P_fy", focal)),
        (number(plugin, "P_cx", center[0]), number(plugin, "P_cy", center[1])),
        (number(plugin, "Tx", -focal * baseline), number(plugin, "Ty")),
        vector(plugin, "rectification_matrix"),
    )


def encoded(rgb: Rgb, encoding: str) -> Rgb:
    """The bytes of a picture (height by width by 3) in an encoding of ROS."""
    if encoding == "mono8":
        gray: Rgb = (rgb @ BRIGHTNESS + 0.5).astype(np.uint8)
        return gray
    return rgb[..., ::-1] if encoding == "bgr8" else rgb


def in_range(depth: Depth, near: float, far: float) -> Depth:
    """The depths, with -inf for what is too near and inf for what is too far."""
    measured = np.where(depth <= near, np.float32(-math.inf), depth)
    return np.where(depth >= far, np.float32(math.inf), measured)


def optical_points(depth: Depth, focal: float) -> tuple[Depth, Depth, Depth]:
    """The points of a depth image, to the right, down and ahead, m; not finite as the depths."""
    height, width = depth.shape
    across = ((np.arange(width) - (width - 1) / 2) / focal).astype(np.float32)
    down = ((np.arange(height) - (height - 1) / 2) / focal).astype(np.float32)
    is_there = np.isfinite(depth)
    with np.errstate(invalid="ignore"):
        x = np.where(is_there, depth * across, depth)
        y = np.where(is_there, depth * down[:, None], depth)
    return x, y, depth


def classic_cloud(depth: Depth, colors: Rgb, focal: float) -> NDArray[Any]:
    """The points of Gazebo Classic's depth camera, in its optical frame.

    The bytes of a color are in the order of the image.
    """
    cloud = np.zeros(depth.shape, layout(CLASSIC_FIELDS, CLASSIC_STEP))
    cloud["x"], cloud["y"], cloud["z"] = optical_points(depth, focal)
    _set_colors(cloud, colors)
    return cloud


def gz_cloud(depth: Depth, rgb: Rgb, focal: float) -> NDArray[Any]:
    """The points of Gazebo Sim's cameras: x ahead, y to the left, z up."""
    cloud = np.zeros(depth.shape, layout(GZ_FIELDS, GZ_STEP))
    right, down, cloud["x"] = optical_points(depth, focal)
    is_there = np.isfinite(depth)
    cloud["y"] = np.where(is_there, -right, depth)
    cloud["z"] = np.where(is_there, -down, depth)
    _set_colors(cloud, rgb[..., ::-1])
    return cloud


def _set_colors(cloud: NDArray[Any], colors: Rgb) -> None:
    """Put three bytes for each point where its color is."""
    packed = np.zeros((*cloud.shape, 4), dtype=np.uint8)
    packed[..., : colors.shape[-1] if colors.ndim > 2 else 1] = (  # noqa: PLR2004
        colors if colors.ndim > 2 else colors[..., None]  # noqa: PLR2004  gray has no third axis
    )
    cloud["rgb"] = packed.view("<f4")[..., 0]


def gray_of(depth: Depth) -> Rgb:
    """The picture that Gazebo Sim's depth camera gives its points: what is far is dark."""
    is_there = np.isfinite(depth)
    farthest = float(depth[is_there].max(initial=0.0))
    share = np.where(is_there, depth, 0.0) * (255 / farthest if farthest else 0.0)
    gray = (255 - share).astype(np.uint8)
    return np.repeat(gray[..., None], 3, axis=2)

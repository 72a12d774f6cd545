"""Cameras: `camera`, `multicamera`, `depth`, `depth_camera`, `rgbd_camera`; wsgen draws for them.

Gazebo Classic's `libgazebo_ros_camera.so` publishes `CAMERA/image_raw` and `CAMERA/camera_info`, of
a depth camera `CAMERA/depth/image_raw` (32FC1), `CAMERA/depth/camera_info` and `CAMERA/points` as
well; CAMERA is <camera_name> or the name of the sensor, the frame <frame_name> or the link
(ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_plugins/src/gazebo_ros_camera.cpp). Gazebo Sim
publishes the image on <topic>, else `/world/…/sensor/NAME/image`, and `camera_info` beside it; a
depth camera the depth (32FC1) there, and `…/points`; an RGB-D camera `…/image`, `…/depth_image`,
`…/points` and `…/camera_info` (gazebosim/gz-sensors, src/CameraSensor.cc, src/DepthCameraSensor.cc,
src/RgbdCameraSensor.cc).

Distortion is published in camera_info and not drawn.
"""

from __future__ import annotations

import array
import time
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_msgs.msg import Empty

from wsgen.live.nodes.simulator.elements import boolean, number
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.mounting import NEVER, Sensor, fill_cloud, sensor_qos
from wsgen.live.nodes.simulator.sensors.picture import (
    CLASSIC_FIELDS,
    GZ_FIELDS,
    classic_cloud,
    classic_intrinsics,
    encoded,
    gray_of,
    gz_cloud,
    gz_intrinsics,
    in_range,
    read_camera,
)
from wsgen.model.devices import Element
from wsgen.model.transform import compose
from wsgen.rendering.sensor_camera import SensorScene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.sensors.picture import CameraSpec, Intrinsics
    from wsgen.model.devices import MountedSensor
    from wsgen.model.transform import Pose

CAMERA_PLUGIN = ("gazebo_ros_camera",)
DEPTH_KINDS = ("depth", "depth_camera")
RGBD_KINDS = ("rgbd_camera", "rgbd")


class Eye(NamedTuple):
    """One camera of a sensor, and its topics."""

    spec: CameraSpec
    intrinsics: Intrinsics
    frame: str
    image: Any | None  # publishers
    infos: tuple[Any, ...]
    depth: Any | None = None
    points: Any | None = None
    nearest: float = 0.0  # m, of depths
    farthest: float = np.inf

    @property
    def is_wanted(self) -> bool:
        """Whether somebody wants a picture of it."""
        publishers = (self.image, self.depth, self.points)
        return any(publisher is not None and publisher.is_wanted for publisher in publishers)


class _Drawing:
    """What all cameras of a simulator share."""

    def __init__(self, *, is_classic: bool) -> None:
        self._is_classic = is_classic
        self._robots: tuple[Any, ...] = ()
        self._scene: SensorScene | None = None

    def scene(self, view: Any) -> SensorScene:
        """The world as it is; loaded again when robots came or went."""
        if self._scene is None or self._robots != tuple(map(id, view.robots)):
            self._scene = SensorScene(view.world, view.robots, is_classic=self._is_classic)
            self._robots = tuple(map(id, view.robots))
        return self._scene


_drawings: WeakKeyDictionary[Any, _Drawing] = WeakKeyDictionary()


class Camera(Sensor):
    """A sensor with a camera, or several."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self.is_depth = sensor.kind in DEPTH_KINDS
        self.is_rgbd = sensor.kind in RGBD_KINDS
        self.eyes: list[Eye] = []
        self._random = np.random.default_rng(self.seed)
        self._triggers: int | None = None  # pictures to take; None: it needs none
        # Gazebo adds a <camera> that is not there, with what sdformat has for one.
        cameras = list(sensor.element.find_all("camera")) or [Element(tag="camera")]
        if host.simulator == "classic":
            for plugin in self.classic_plugins(CAMERA_PLUGIN):
                self._open_classic(plugin, cameras)
        elif sensor.kind == "multicamera":
            raise CannotWorkError("Gazebo Sim has none. Write a sensor for each camera.")
        else:
            self._open_gz(cameras[0])
        self._drawing = _drawings.setdefault(host, _Drawing(is_classic=host.simulator == "classic"))
        if not self.eyes:
            self.period = NEVER

    def _open_classic(self, plugin: Element, cameras: list[Element]) -> None:
        node = self.classic_node(plugin)
        name = plugin.get("camera_name") or self.sensor.name
        is_several = self.sensor.kind == "multicamera"

        def publisher(kind: type, topic: str, depth: int = 5) -> Any:
            qos = sensor_qos(plugin, topic, depth)
            return self.host.publisher(self.robot, kind, topic, node=node, qos=qos)

        for camera in cameras if is_several else cameras[:1]:
            spec = read_camera(camera, sees_near=False)
            base = f"{name}/{camera.attributes.get('name', 'default')}" if is_several else name
            infos = [publisher(CameraInfo, f"{base}/camera_info")]
            if self.is_depth:
                infos.append(publisher(CameraInfo, f"{base}/depth/camera_info", 1))
            self.eyes.append(
                Eye(
                    spec,
                    classic_intrinsics(plugin, spec),
                    self.classic_frame(plugin),
                    publisher(Image, f"{base}/image_raw"),
                    tuple(infos),
                    publisher(Image, f"{base}/depth/image_raw") if self.is_depth else None,
                    publisher(PointCloud2, f"{base}/points", 1) if self.is_depth else None,
                    number(plugin, "min_depth"),
                    number(plugin, "max_depth"),
                )
            )
        if boolean(plugin, "triggered"):
            self._take_triggers(f"{name}/image_trigger", node)

    def _open_gz(self, camera: Element) -> None:
        measures_depth = self.is_depth or self.is_rgbd
        spec = read_camera(camera, sees_near=measures_depth)
        suffix = "" if self.is_rgbd else "/depth_image" if self.is_depth else "/image"
        topic = self.topic(suffix)
        info = f"{topic}/camera_info"  # whatever the description says
        if not self.is_rgbd:
            info = camera.get("camera_info_topic") or f"{_folder(topic)}/camera_info"

        def publisher(kind: type, name: str) -> Any:
            return self.host.publisher(self.robot, kind, name)

        image = None if self.is_depth else f"{topic}/image" if self.is_rgbd else topic
        depth = f"{topic}/depth_image" if self.is_rgbd else topic if self.is_depth else None
        self.eyes.append(
            Eye(
                spec,
                gz_intrinsics(camera, spec),
                camera.get("optical_frame_id") or self.gz_frame,
                None if image is None else publisher(Image, image),
                (publisher(CameraInfo, info),),
                None if depth is None else publisher(Image, depth),
                publisher(PointCloud2, f"{topic}/points") if measures_depth else None,
                spec.near,
                spec.far,
            )
        )
        if boolean(camera, "triggered", default=False):
            self._take_triggers(camera.get("trigger_topic") or f"{topic}/trigger", None)

    def _take_triggers(self, topic: str, node: Any) -> None:
        self._triggers = 0

        def trigger(_message: Any) -> None:
            self._triggers = (self._triggers or 0) + 1

        kind = Empty
        if node is None:  # Gazebo Sim's takes gz.msgs.Boolean
            from std_msgs.msg import Bool  # noqa: PLC0415  few have it

            kind = Bool
        self.host.subscription(self.robot, kind, topic, trigger, node=node)

    def update(self) -> None:
        """Take the pictures that somebody wants."""
        if self._triggers is not None:
            if not self._triggers:
                return
            self._triggers -= 1
        for eye in self.eyes:
            for publisher in eye.infos:
                if publisher.is_wanted:
                    publisher.publish(self._info(eye))
            if eye.is_wanted and self.pose().is_finite:  # if not, the robot has exploded
                begun = time.thread_time()
                self._take(eye)
                self.keep_pace(time.thread_time() - begun, "Make <image> smaller.")

    def _take(self, eye: Eye) -> None:
        view = self.host.view()
        scene = self._drawing.scene(view)
        has_points = eye.points is not None and eye.points.is_wanted
        in_color = (eye.image is not None and eye.image.is_wanted) or (
            has_points and not (self.is_depth and self.host.simulator == "gz")
        )
        place: Pose = compose(self.pose(), eye.spec.pose)
        depth, rgb = scene.expose(eye.spec.lens, place, view.poses, in_color=in_color)
        if rgb is not None:
            rgb = self._noisy(eye.spec, rgb)
        if eye.image is not None and eye.image.is_wanted and rgb is not None:
            pixels = encoded(rgb, eye.spec.encoding)
            eye.image.publish(self._image(eye, pixels, eye.spec.encoding))
        if eye.depth is None and eye.points is None:
            return
        if self.host.simulator == "classic":  # where nothing is, is the end of what it sees
            depth = np.minimum(depth, np.float32(eye.spec.far))
        if self.is_depth and eye.spec.noise:
            noise = self._random.normal(eye.spec.noise_mean, eye.spec.noise, depth.shape)
            depth = (depth + noise).astype(np.float32)
        measured = in_range(depth, eye.nearest, eye.farthest)
        if eye.depth is not None and eye.depth.is_wanted:
            eye.depth.publish(self._image(eye, measured, "32FC1"))
        if eye.points is not None and has_points:
            eye.points.publish(self._cloud(eye, measured, rgb))

    def _noisy(self, spec: CameraSpec, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        if not spec.noise or self.is_depth:
            return rgb
        noise = self._random.standard_normal(rgb.shape, dtype=np.float32)
        noise *= np.float32(255 * spec.noise)
        noise += rgb + np.float32(255 * spec.noise_mean + 0.5)
        return noise.clip(0, 255).astype(np.uint8)

    def _image(self, eye: Eye, pixels: NDArray[Any], encoding: str) -> Any:
        message = self.stamped(Image, eye.frame)
        message.height, message.width = pixels.shape[:2]
        message.encoding = encoding
        message.is_bigendian = 0
        data = np.ascontiguousarray(pixels)
        message.step = data.nbytes // data.shape[0]
        message.data = array.array("B", data.tobytes())
        return message

    def _cloud(self, eye: Eye, depth: NDArray[np.float32], rgb: NDArray[np.uint8] | None) -> Any:
        message = self.stamped(PointCloud2, eye.frame)
        is_dense = bool(np.isfinite(depth).all())
        focal = eye.spec.lens.focal
        colors = gray_of(depth) if rgb is None else rgb
        if self.host.simulator == "classic":
            cloud = classic_cloud(depth, encoded(colors, eye.spec.encoding), focal)
            fill_cloud(message, CLASSIC_FIELDS, cloud, is_dense=is_dense)
        else:
            fill_cloud(message, GZ_FIELDS, gz_cloud(depth, colors, focal), is_dense=is_dense)
        return message

    def _info(self, eye: Eye) -> Any:
        message = self.stamped(CameraInfo, eye.frame)
        message.width, message.height = eye.spec.lens.width, eye.spec.lens.height
        message.distortion_model = "plumb_bob"
        message.d = list(eye.spec.distortion)
        message.k = eye.intrinsics.k
        message.r = list(eye.intrinsics.rectification)
        message.p = eye.intrinsics.p
        return message


def _folder(topic: str) -> str:
    """What a topic lies in."""
    return "/" + topic.strip("/").rpartition("/")[0] if "/" in topic.strip("/") else ""

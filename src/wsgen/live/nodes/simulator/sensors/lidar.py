"""Lidars: `ray`, `gpu_ray`, `lidar`, `gpu_lidar`.

Gazebo Classic's `libgazebo_ros_ray_sensor.so` publishes on `~/out` what its <output_type> says,
sensor_msgs/PointCloud2 without one, in the frame of the link or <frame_name>, reliably with depth 5
(ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_plugins/src/gazebo_ros_ray_sensor.cpp, and
gazebo_ros/include/gazebo_ros/conversions/sensor_msgs.hpp). Gazebo Sim publishes a LaserScan on
<topic>, else `/world/…/sensor/NAME/scan`, and a cloud on the same with `/points` behind it
(gazebosim/gz-sensors, src/Lidar.cc and src/GpuLidarSensor.cc; the scan of several rows is the
middle one: gazebosim/ros_gz, ros_gz_bridge/src/convert/sensor_msgs.cpp).

All of them see collisions here; those of a GPU see visuals in Gazebo. Intensities are the
<laser_retro> of what is hit, for those of a GPU that of its visual (reflection.py), and for
Classic's plugin no less than <min_intensity>.
"""

from __future__ import annotations

import array
import math
import time
from operator import is_
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from sensor_msgs.msg import ChannelFloat32, LaserScan, PointCloud, PointCloud2, Range

from wsgen.live.nodes.simulator.elements import number, text
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.lidar_rays import Housings, Reflection, Scanner, read_lidar
from wsgen.live.nodes.simulator.sensors.mounting import (
    FLOAT32,
    NEVER,
    UINT16,
    Sensor,
    fill_cloud,
    layout,
    sensor_qos,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.sensors.lidar_rays import CastRays
    from wsgen.model.devices import Element, MountedSensor
    from wsgen.simulation.scene import SpawnedRobot

    Floats = NDArray[np.float64]

GPU = "gpu_"  # kinds that begin so see visuals in Gazebo
RAY_SENSOR = ("gazebo_ros_ray_sensor",)
CLASSIC_FIELDS = {
    "x": (0, FLOAT32),
    "y": (4, FLOAT32),
    "z": (8, FLOAT32),
    "intensity": (12, FLOAT32),
}
CLASSIC_STEP = 16
GZ_FIELDS = {**CLASSIC_FIELDS, "ring": (16, UINT16)}
GZ_STEP = 18
TYPES = {
    "sensor_msgs/LaserScan": LaserScan,
    "sensor_msgs/PointCloud": PointCloud,
    "sensor_msgs/PointCloud2": PointCloud2,
    "sensor_msgs/Range": Range,
}
RADIATION = {"infrared": Range.INFRARED, "ultrasound": Range.ULTRASOUND}


class _Reflections:
    """What reflects in the world of a simulator, for all of its lidars."""

    def __init__(self) -> None:
        self._robots: tuple[SpawnedRobot, ...] = ()  # that are known
        self._known: dict[bool, Reflection] = {}
        self._housings: Housings | None = None

    def cast_rays(self, host: Host, starts: Floats, ends: Floats, cast: CastRays) -> Floats:
        """How far rays of Gazebo Classic get, which see from inside what they begin in."""
        self._look_at(host)
        if self._housings is None:
            has_ground = host.view().world.has_ground_plane
            self._housings = Housings(self._robots, has_ground=has_ground)
        return np.minimum(cast(starts, ends), self._housings.leave(starts, ends, host.view().poses))

    def intensities(
        self, host: Host, starts: Floats, ends: Floats, fractions: Floats, *, is_gpu: bool
    ) -> Floats:
        """Those of rays; what reflects is read again when robots came or went."""
        self._look_at(host)
        if is_gpu not in self._known:
            has_ground = host.view().world.has_ground_plane
            self._known[is_gpu] = Reflection(self._robots, is_gpu=is_gpu, has_ground=has_ground)
        reflection = self._known[is_gpu]
        if not reflection.is_any:
            return np.zeros(len(fractions))
        return reflection.intensities(starts, ends, fractions, host.view().poses)

    def _look_at(self, host: Host) -> None:
        robots = tuple(robot.spawned for robot in host.robots.values())
        if len(robots) != len(self._robots) or not all(map(is_, robots, self._robots)):
            self._robots = robots
            self._known.clear()
            self._housings = None


_reflections: WeakKeyDictionary[Any, _Reflections] = WeakKeyDictionary()


class Output:
    """One topic of a lidar."""

    def __init__(self, publisher: Any, kind: type, frame: str) -> None:
        self.publisher = publisher
        self.kind = kind
        self.frame = frame
        self.least_intensity = 0.0
        self.radiation: int = Range.INFRARED


class Lidar(Sensor):
    """A lidar."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self.outputs: list[Output] = []
        self._is_of_classic = host.simulator == "classic" and not sensor.kind.startswith(GPU)
        spec = read_lidar(self.of("lidar", "ray"), interpolates=self._is_of_classic)
        self.scanner = Scanner(spec, np.random.default_rng(self.seed))
        if host.simulator == "classic":
            for plugin in self.classic_plugins(RAY_SENSOR):
                self.outputs.append(self._classic(plugin))
        else:
            topic, frame = self.topic("/scan"), self.gz_frame
            for kind, name in ((LaserScan, topic), (PointCloud2, f"{topic}/points")):
                self.outputs.append(Output(host.publisher(robot, kind, name), kind, frame))
        if not self.outputs:
            self.period = NEVER

    def _classic(self, plugin: Element) -> Output:
        written = text(plugin, "output_type", self.robot)
        kind = TYPES.get(written)
        if kind is None:
            raise CannotWorkError(
                f"its <output_type> is `{written}`. Write one of {', '.join(TYPES)}."
            )
        radiation = text(plugin, "radiation_type", self.robot)
        if kind is Range and radiation not in RADIATION:
            raise CannotWorkError(
                f"its <radiation_type> is `{radiation}`. Write ultrasound or infrared."
            )
        publisher = self.host.publisher(
            self.robot,
            kind,
            "~/out",
            node=self.classic_node(plugin),
            qos=sensor_qos(plugin, "~/out"),
        )
        output = Output(publisher, kind, self.classic_frame(plugin))
        output.least_intensity = number(plugin, "min_intensity")
        output.radiation = RADIATION.get(radiation, output.radiation)
        return output

    def update(self) -> None:
        """Scan, if somebody wants it."""
        wanted = [output for output in self.outputs if output.publisher.is_wanted]
        if not wanted or not self.pose().is_finite:  # the robot has exploded
            return
        begun = time.thread_time()
        ranges, intensities = self.scanner.scan(self.pose(), self._cast_rays, self._reflect)
        for output in wanted:
            message = self.stamped(output.kind, output.frame)
            bright = np.maximum(intensities, output.least_intensity)
            if output.kind is LaserScan:
                self._fill_scan(message, ranges, bright)
            elif output.kind is Range:
                self._fill_range(message, ranges, output)
            elif output.kind is PointCloud:
                self._fill_old_cloud(message, ranges, bright)
            else:
                self._fill_cloud(message, ranges, bright)
            output.publisher.publish(message)
        self.keep_pace(time.thread_time() - begun, "Write fewer <samples>.")

    def _cast_rays(self, starts: Floats, ends: Floats) -> Floats:
        """How far rays get."""
        if not self._is_of_classic:
            return self.robot.cast_rays(starts, ends)
        reflections = _reflections.setdefault(self.host, _Reflections())
        return reflections.cast_rays(self.host, starts, ends, self.robot.cast_rays)

    def _reflect(self, starts: Floats, ends: Floats, fractions: Floats) -> Floats:
        """The intensities of rays."""
        reflections = _reflections.setdefault(self.host, _Reflections())
        is_gpu = self.sensor.kind.startswith(GPU)
        return reflections.intensities(self.host, starts, ends, fractions, is_gpu=is_gpu)

    def _fill_scan(self, message: Any, ranges: Floats, intensities: Floats) -> None:
        spec = self.scanner.spec
        middle = spec.up.count // 2
        message.angle_min, message.angle_max = spec.across.least, spec.across.most
        message.angle_increment = spec.across.step
        if spec.across.count == 1 and self.host.simulator == "classic":  # it divides by 0
            message.angle_increment = math.inf if spec.across.most > spec.across.least else math.nan
        message.range_min, message.range_max = spec.nearest, spec.farthest
        message.ranges = _floats(ranges[middle])
        message.intensities = _floats(intensities[middle])

    def _fill_range(self, message: Any, ranges: Floats, output: Output) -> None:
        spec = self.scanner.spec
        message.radiation_type = output.radiation
        widths = (angles.most - angles.least for angles in (spec.across, spec.up))
        message.field_of_view = max(widths)
        message.min_range, message.max_range = spec.nearest, spec.farthest
        # Where nothing is seen, Gazebo leaves the largest number of the type.
        nearest = float(ranges.min())
        message.range = float(np.finfo(np.float32).max) if nearest == math.inf else nearest

    def _fill_cloud(self, message: Any, ranges: Floats, intensities: Floats) -> None:
        points = self.scanner.points(ranges).astype(np.float32)
        if self.host.simulator == "classic":
            is_seen = np.isfinite(ranges)
            seen = points[is_seen]
            cloud = np.zeros((1, len(seen)), layout(CLASSIC_FIELDS, CLASSIC_STEP))
            cloud["x"], cloud["y"], cloud["z"] = seen.T
            cloud["intensity"] = intensities[is_seen]
            fill_cloud(message, CLASSIC_FIELDS, cloud, is_dense=True)
            return
        cloud = np.zeros(self.scanner.spec.shape, layout(GZ_FIELDS, GZ_STEP))
        for place, axis in enumerate("xyz"):
            cloud[axis] = points[..., place]
        cloud["intensity"] = intensities
        cloud["ring"] = np.arange(len(cloud))[:, None]
        is_dense = bool(np.isfinite(ranges).all())
        fill_cloud(message, GZ_FIELDS, cloud, is_dense=is_dense)

    def _fill_old_cloud(self, message: Any, ranges: Floats, intensities: Floats) -> None:
        from geometry_msgs.msg import Point32  # noqa: PLC0415  few use it

        is_seen = np.isfinite(ranges)
        seen = self.scanner.points(ranges)[is_seen].tolist()
        message.points = [Point32(x=x, y=y, z=z) for x, y, z in seen]
        values = _floats(intensities[is_seen])
        message.channels = [ChannelFloat32(name="intensity", values=values)]


def _floats(numbers: Floats) -> array.array[float]:
    """What a message takes without a look at each number."""
    return array.array("f", numbers.astype(np.float32).tobytes())

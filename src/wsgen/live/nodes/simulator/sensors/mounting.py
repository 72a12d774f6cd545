"""What all sensors have in common: where they are, what they are called, when they measure, noise.

Sources: gazebosim/gz-sim, src/rendering/RenderUtil.cc and src/systems/imu/Imu.cc (topics and names
of sensors), gazebosim/ros_gz, ros_gz_bridge/src/convert/utils.cpp (`::` becomes `/` in frames);
ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_ros/src/utils.cpp (`SensorFrameID`) and
gazebo_ros/src/qos.cpp. Noise is that of Gazebo's Gaussian model, from a seed (gazebosim/gz-sensors,
src/GaussianNoiseModel.cc; Gazebo Classic's is the same, gazebo/sensors/GaussianNoiseModel.cc).
Point clouds are as their messages have them.
"""

from __future__ import annotations

import array
import math
import zlib
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from wsgen.gazebo.plugins import stem
from wsgen.gazebo.sensors import FRAME_NAMES
from wsgen.gazebo.successors import ROS_1_PLUGINS
from wsgen.live.nodes.simulator.elements import number
from wsgen.live.nodes.simulator.host import CannotWorkError, Plugin
from wsgen.live.nodes.simulator.topics import written_qos
from wsgen.model.transform import compose, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from numpy.typing import NDArray

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element, MountedSensor
    from wsgen.model.transform import Pose, Vector

    Floats = NDArray[np.float64]


NEVER = math.inf  # s
SHARE = 0.5  # of the time, that all sensors together take
CHEAP = 0.05  # of the time: what takes no more keeps its rate
MEMORY = 10  # measurements, of whose times the mean is known
TELL_AFTER = 5  # measurements
ENOUGH = 1.2  # times the period of the description: what is not longer is not reported
FASTEST_PERIOD = 0.01  # s, of a sensor that gives no rate: Gazebo's measures in every step

# By simulator and sensor: how many seconds of CPU time it takes in a simulated one.
_loads: WeakKeyDictionary[Host, WeakKeyDictionary[Sensor, float]] = WeakKeyDictionary()


class Sensor(Plugin):
    """A sensor of a robot."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        self.host = host
        self.robot = robot
        self.sensor = sensor
        rate = number(sensor.element, "update_rate", 0.0)
        # s, simulated, between two measurements, as the description has it
        self.rated_period = 1.0 / rate if rate > 0 else max(FASTEST_PERIOD, host.step_seconds)
        self.period = self.rated_period
        self._measured = 0
        self._seconds = 0.0  # of CPU time, that a measurement takes
        self._has_reported = False
        # The same noise in every run.
        self.seed = zlib.crc32(f"{robot.entity}/{sensor.link}/{sensor.name}".encode())

    def reset(self) -> None:
        """Nothing: what was measured before does not matter."""

    def pose(self) -> Pose:
        """Where it is in the world."""
        return compose(self.robot.link_poses()[self.sensor.link], self.sensor.pose_in_link)

    def velocity(self) -> tuple[Floats, Floats]:
        """How its origin moves (m/s), and how it turns (rad/s), in the world."""
        (u, v, w), angular = self.robot.link_velocities()[self.sensor.link]
        link = self.robot.link_poses()[self.sensor.link]
        x, y, z = rotate(rotation_of_rpy(link.rpy), self.sensor.pose_in_link.xyz)
        a, b, c = angular
        linear = (u + b * z - c * y, v + c * x - a * z, w + a * y - b * x)
        return np.array(linear), np.array(angular)

    def stamped(self, kind: Any, frame: str) -> Any:
        """A message of now, which is seen from a frame."""
        message = kind()
        message.header.stamp = self.host.stamp()
        message.header.frame_id = frame
        return message

    def keep_pace(self, seconds: float, advice: str) -> None:
        """Measure as often as the time allows, where a measurement has taken so long (s, of CPU).

        At a rate of simulation that is not `max`, all sensors together take no more than a share of
        the time, if they are not cheap; what one gives less of is said once, with an advice. The
        first measurement, for which things are loaded, does not count.
        """
        self._measured += 1
        if self._measured == 1:
            return
        loads = _loads.setdefault(self.host, WeakKeyDictionary())
        self._seconds += (seconds - self._seconds) / min(self._measured - 1, MEMORY)
        loads[self] = self._seconds / self.rated_period
        if self.host.rate is None:
            return
        # Of a second, what all take if they measure as often as they should.
        taken = sum(loads.values()) * self.host.rate
        is_cheap = loads[self] * self.host.rate < CHEAP
        period = self.rated_period * (1.0 if is_cheap else max(1.0, taken / SHARE))
        self.period = period
        is_late = self._measured > TELL_AFTER and period > ENOUGH * self.rated_period
        if is_late and not self._has_reported:
            self._has_reported = True
            self.host.warn(
                f"`{self.robot.entity}`: the {self.sensor.kind} sensor `{self.sensor.name}` "
                f"measures less often than {1 / self.rated_period:g} times a second: on this "
                f"machine it takes {1000 * self._seconds:.0f} ms. {advice}"
            )

    def topic(self, suffix: str, name: str = "") -> str:
        """Gazebo Sim's: what the sensor says, or one by all that it is in."""
        return name or self.sensor.element.get("topic") or f"/{self.scoped_name('/')}{suffix}"

    def scoped_name(self, delimiter: str) -> str:
        """World, models, link and sensor, each with its kind before it."""
        *models, link = self.sensor.link.split("::")
        parts = ["world", self.host.world]
        for model in (self.robot.entity, *models):
            parts += ["model", model]
        return delimiter.join((*parts, "link", link, "sensor", self.sensor.name))

    @property
    def gz_frame(self) -> str:
        """The frame in messages of Gazebo Sim, as a bridge has it."""
        given = (self.sensor.element.get(name) for name in FRAME_NAMES)
        own = f"{self.robot.entity}::{self.sensor.link}::{self.sensor.name}"
        return (next(filter(None, given), "") or own).replace("::", "/")

    def classic_frame(self, plugin: Element) -> str:
        """The frame in messages of a plugin of Gazebo Classic."""
        return plugin.get("frame_name") or self.sensor.link.rpartition("::")[2]

    def classic_plugins(self, names: Collection[str]) -> Iterator[Element]:
        """The plugins in the sensor that have one of these names; the others are named.

        Raises:
            CannotWorkError: A plugin is of ROS 1.
        """
        for plugin in self.sensor.plugins:
            filename = plugin.attributes.get("filename", "")
            instead = ROS_1_PLUGINS.get(stem(filename))
            if stem(filename) in names:
                yield plugin
            elif instead is not None:
                raise CannotWorkError(f"`{filename}` is of ROS 1. Write {instead}.")
            else:
                self.host.warn(
                    f"`{self.robot.entity}`: wsgen does not simulate the plugin `{filename}` of "
                    f"the sensor `{self.sensor.name}`."
                )

    def classic_node(self, plugin: Element) -> Any:
        """The node of a plugin of Gazebo Classic."""
        return self.host.node(self.robot, plugin)

    def of(self, *names: str) -> Element:
        """The element that describes this kind of sensor.

        Raises:
            CannotWorkError: There is none.
        """
        found = (self.sensor.element.find(name) for name in names)
        element = next((one for one in found if one is not None), None)
        if element is None:
            raise CannotWorkError(f"it has no <{names[0]}>. Describe the sensor in it.")
        return element


class OfGazeboSim(Sensor):
    """A sensor of Gazebo Sim alone: ROS 2 has no plugin of Gazebo Classic for it."""

    message: Any = None  # its type

    def open(self, topic: str) -> None:
        """Publish on <topic>, else on that of Gazebo, below `/world/…/sensor/NAME`."""
        self._publisher: Any = None
        if self.host.simulator == "classic":
            list(self.classic_plugins(()))
            self.period = NEVER
        else:
            self._publisher = self.host.publisher(self.robot, self.message, self.topic(topic))

    def fill(self, message: Any) -> None:
        """Put in what is measured."""
        raise NotImplementedError

    def update(self) -> None:
        """Publish what is measured, if somebody wants it."""
        if self._publisher is None or not self._publisher.is_wanted:
            return
        message = self.stamped(self.message, self.gz_frame)
        self.fill(message)
        self._publisher.publish(message)


def sensor_qos(plugin: Element | None = None, topic: str = "", depth: int = 5) -> Any:
    """The QoS of a sensor's topic: reliable, of that depth, or what the <qos> of a plugin says."""
    return written_qos(None if plugin is None else plugin.find("ros"), topic, depth)


def rotation(pose: Pose) -> Floats:
    """The rotation of a frame as a matrix, which takes its vectors to where the pose is seen."""
    return np.array(rotation_of_rpy(pose.rpy))


def put(vector: Any, values: Vector | Floats) -> None:
    """Set x, y and z of a message."""
    vector.x, vector.y, vector.z = map(float, values)


GAUSSIAN = ("gaussian", "gaussian_quantized")


class Noise:
    """What one channel of a sensor adds to what is true.

    Attributes:
        deviation: The standard deviation of the white noise, in the unit of the channel.
    """

    def __init__(self, element: Element | None, random: np.random.Generator) -> None:
        """Take what a <noise> says; its type is an attribute, or an element in Gazebo Classic.

        Raises:
            CannotWorkError: A number of it is none.
        """
        self._random = random
        self.deviation = self._mean = self._bias = self._precision = 0.0
        self._drift = self._correlation = 0.0
        kind = "none" if element is None else element.attributes.get("type") or element.get("type")
        self.is_there = element is not None and kind in GAUSSIAN
        if element is None or not self.is_there:
            return
        self._mean, self.deviation = number(element, "mean", 0.0), number(element, "stddev", 0.0)
        spread = number(element, "bias_stddev", 0.0)
        self._bias = number(element, "bias_mean", 0.0)
        if spread > 0:
            self._bias = random.normal(self._bias, spread)
        if random.random() < 0.5:  # noqa: PLR2004  as often negative
            self._bias = -self._bias
        self._precision = number(element, "precision", 0.0)
        self._drift = number(element, "dynamic_bias_stddev", 0.0)
        self._correlation = number(element, "dynamic_bias_correlation_time", 0.0)

    @property
    def variance(self) -> float:
        """That of the white noise."""
        return self.deviation**2

    def apply(self, true: Floats, seconds: float = 0.0) -> Floats:
        """What is measured of what is true, any shape, so many seconds after the last time."""
        if not self.is_there:
            return true
        if self._drift > 0 and self._correlation > 0 and seconds > 0:
            share = seconds / self._correlation
            spread = math.sqrt(-(self._drift**2) * self._correlation / 2 * math.expm1(-2 * share))
            self._bias = math.exp(-share) * self._bias + self._random.normal(0.0, spread)
        measured: Floats = true + (self._bias + self._mean)
        if self.deviation > 0:
            measured += self._random.normal(0.0, self.deviation, np.shape(true))
        if self._precision > 0:
            measured = np.round(measured / self._precision) * self._precision
        return measured


FLOAT32, UINT16 = 7, 4  # of sensor_msgs/PointField
SIZES = {FLOAT32: 4, UINT16: 2}
NUMPY = {FLOAT32: "<f4", UINT16: "<u2"}


def layout(fields: dict[str, tuple[int, int]], step: int) -> np.dtype[Any]:
    """The NumPy type of points with these fields: offset and type (of PointField) by name."""
    return np.dtype(
        {
            "names": list(fields),
            "formats": [NUMPY[kind] for _, kind in fields.values()],
            "offsets": [offset for offset, _ in fields.values()],
            "itemsize": step,
        }
    )


def fill_cloud(
    message: Any, fields: dict[str, tuple[int, int]], points: NDArray[Any], *, is_dense: bool
) -> None:
    """Put points (rows by columns, of the type of `layout`) into a sensor_msgs/PointCloud2."""
    from sensor_msgs.msg import PointField  # noqa: PLC0415  nodes alone

    message.height, message.width = points.shape
    message.fields = [
        PointField(name=name, offset=offset, datatype=kind, count=1)
        for name, (offset, kind) in fields.items()
    ]
    message.point_step = points.dtype.itemsize
    message.row_step = points.dtype.itemsize * points.shape[1]
    message.is_bigendian = False
    message.is_dense = bool(is_dense)
    message.data = array.array("B", points.tobytes())

"""Sensors of how a robot moves and where it is: IMU, GNSS, altitude, pressure, magnetic field.

Gazebo Classic's `libgazebo_ros_imu_sensor.so` publishes a sensor_msgs/Imu on `~/out` in the frame
of the link or <frame_name>; the orientation is that in the world unless
<initial_orientation_as_reference> says otherwise (ros-simulation/gazebo_ros_pkgs, branch ros2,
gazebo_plugins/src/gazebo_ros_imu_sensor.cpp). Gazebo Sim publishes on <topic>, else
`/world/…/sensor/NAME/imu`; the orientation is against the one at the beginning unless a
<localization> says otherwise (gazebosim/gz-sensors, src/ImuSensor.cc; gazebosim/gz-sim,
src/systems/imu/Imu.cc). Either has variances of gyroscope and accelerometer on the diagonals of
the covariances, and zeros for the orientation.

The acceleration is the mean since the last measurement; Gazebo's is that of the last step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import Vector3Stamped
from sensor_msgs.msg import FluidPressure, MagneticField, NavSatFix, NavSatStatus
from sensor_msgs.msg import Imu as ImuMessage

from wsgen.live.nodes.simulator.elements import boolean, number
from wsgen.live.nodes.simulator.host import CannotWorkError
from wsgen.live.nodes.simulator.sensors.motion import (
    CHANNELS,
    InertialUnit,
    pressure_at,
    read_origin,
    reference_of,
)
from wsgen.live.nodes.simulator.sensors.mounting import (
    NEVER,
    Noise,
    OfGazeboSim,
    Sensor,
    put,
    rotation,
    sensor_qos,
)
from wsgen.model.devices import numbers_of
from wsgen.model.transform import quaternion_of_rpy, rpy_of_rotation

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.devices import Element, MountedSensor
    from wsgen.model.transform import Matrix


IMU_SENSOR = ("gazebo_ros_imu_sensor",)


class Imu(Sensor):
    """An inertial measurement unit."""

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        self.outputs: list[tuple[Any, str]] = []
        imu = sensor.element.find("imu")
        self._has_orientation = True
        reference = None
        if host.simulator == "classic":
            for plugin in self.classic_plugins(IMU_SENSOR):
                self._open_classic(plugin)
                if not boolean(plugin, "initial_orientation_as_reference"):
                    reference = np.eye(3)
        else:
            reference = reference_of(imu)
            if imu is not None:
                self._has_orientation = boolean(imu, "enable_orientation", default=True)
            publisher = host.publisher(robot, ImuMessage, self.topic("/imu"))
            self.outputs.append((publisher, self.gz_frame))
        self.unit = InertialUnit(
            imu,
            np.random.default_rng(self.seed),
            gravity=host.gravity,
            reference=rotation(self.pose()) if reference is None else reference,
        )
        if not self.outputs:
            self.period = NEVER

    def _open_classic(self, plugin: Element) -> None:
        publisher = self.host.publisher(
            self.robot,
            ImuMessage,
            "~/out",
            node=self.classic_node(plugin),
            qos=sensor_qos(plugin, "~/out"),
        )
        self.outputs.append((publisher, self.classic_frame(plugin)))

    def reset(self) -> None:
        """Begin again."""
        self.unit.forget(time=True)

    def update(self) -> None:
        """Measure, if somebody wants it."""
        is_wanted = any(publisher.is_wanted for publisher, _ in self.outputs)
        if not is_wanted or not self.pose().is_finite:  # the robot has exploded
            self.unit.forget()
            return
        measured = self.unit.measure(self.pose(), *self.velocity(), self.host.now)
        for publisher, frame in self.outputs:
            message = self.stamped(ImuMessage, frame)
            quaternion = message.orientation
            if self._has_orientation:
                rows: Matrix = tuple(map(tuple, measured.orientation.tolist()))  # type: ignore[assignment]
                turned = quaternion_of_rpy(rpy_of_rotation(rows))
                quaternion.x, quaternion.y, quaternion.z, quaternion.w = turned
            put(message.angular_velocity, measured.turning)
            put(message.linear_acceleration, measured.acceleration)
            for channel in CHANNELS:
                covariance = getattr(message, f"{channel}_covariance")
                for place, noise in zip((0, 4, 8), self.unit.noises[channel], strict=True):
                    covariance[place] = noise.variance
            publisher.publish(message)


GPS_SENSOR = ("gazebo_ros_gps_sensor",)
NOISES = ("position_sensing", "velocity_sensing")


class NavSat(Sensor):
    """A receiver of satellite navigation: `gps`, `navsat`.

    Gazebo Classic's `libgazebo_ros_gps_sensor.so` publishes sensor_msgs/NavSatFix on `~/out` and
    the velocity, east, north and up, on `~/vel` (ros-simulation/gazebo_ros_pkgs, branch ros2,
    gazebo_plugins/src/gazebo_ros_gps_sensor.cpp). Gazebo Sim publishes on <topic>, else
    `/world/…/sensor/NAME/navsat` (gazebosim/gz-sensors, src/NavSatSensor.cc). Without
    <spherical_coordinates> in the world there is no place on Earth, and nothing is published.
    """

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        origin = read_origin(host.surroundings.get("spherical_coordinates"), host.simulator)
        if origin is None:
            raise CannotWorkError(
                "the world says not where on Earth it is. Write <spherical_coordinates> into it."
            )
        self.origin = origin
        random = np.random.default_rng(self.seed)
        element = sensor.element.find("navsat") or sensor.element.find("gps")
        self._noises = {
            (what, way): Noise(
                None if element is None else element.find(f"{what}/{way}/noise"), random
            )
            for what in NOISES
            for way in ("horizontal", "vertical")
        }
        self.outputs: list[tuple[Any, Any, str]] = []
        if host.simulator == "classic":
            for plugin in self.classic_plugins(GPS_SENSOR):
                node = self.classic_node(plugin)
                fix, velocity = (
                    host.publisher(robot, kind, topic, node=node, qos=sensor_qos(plugin, topic))
                    for kind, topic in ((NavSatFix, "~/out"), (Vector3Stamped, "~/vel"))
                )
                self.outputs.append((fix, velocity, self.classic_frame(plugin)))
        else:
            publisher = host.publisher(robot, NavSatFix, self.topic("/navsat"))
            self.outputs.append((publisher, None, self.gz_frame))
        if not self.outputs:
            self.period = NEVER

    def update(self) -> None:
        """Publish where it is, if somebody wants it."""
        for fix, velocity, frame in self.outputs:
            if fix.is_wanted:
                fix.publish(self._fix(frame))
            if velocity is not None and velocity.is_wanted:
                velocity.publish(self._velocity(frame))

    def _fix(self, frame: str) -> Any:
        message = self.stamped(NavSatFix, frame)
        across = self._noises["position_sensing", "horizontal"]
        up = self._noises["position_sensing", "vertical"]
        is_classic = self.host.simulator == "classic"
        xyz = np.array(self.pose().xyz)
        if is_classic:  # whose noise is in meters
            xyz = np.array([*across.apply(xyz[:2]), float(up.apply(xyz[2:])[0])])
        latitude, longitude, elevation = self.origin.place((xyz[0], xyz[1], xyz[2]))
        if not is_classic:  # whose noise is in degrees, but for the elevation
            latitude, longitude = across.apply(np.array([latitude, longitude])).tolist()
            elevation = float(up.apply(np.array(elevation)))
        message.latitude, message.longitude, message.altitude = latitude, longitude, elevation
        message.status.status = NavSatStatus.STATUS_FIX
        if is_classic:
            message.status.service = NavSatStatus.SERVICE_GPS
            message.position_covariance_type = NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN
            for place, noise in zip((0, 4, 8), (across, across, up), strict=True):
                message.position_covariance[place] = noise.variance
        return message

    def _velocity(self, frame: str) -> Any:
        message = self.stamped(Vector3Stamped, frame)
        x, y, z = self.velocity()[0].tolist()
        east, north, up = self.origin.east_north_up((x, y, z)).tolist()
        across = self._noises["velocity_sensing", "horizontal"]
        east, north = across.apply(np.array([east, north])).tolist()
        up = float(self._noises["velocity_sensing", "vertical"].apply(np.array(up)))
        put(message.vector, (east, north, up))
        return message


class Altimeter(OfGazeboSim):
    """The height against the one at the beginning, and its change.

    As ros_gz_interfaces/Altimeter (gazebosim/gz-sensors, src/AltimeterSensor.cc; gazebosim/gz-sim,
    src/systems/altimeter/Altimeter.cc).
    """

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        random = np.random.default_rng(self.seed)
        self._noises = [
            Noise(sensor.element.find(f"altimeter/{what}/noise"), random)
            for what in ("vertical_position", "vertical_velocity")
        ]
        self._reference = self.pose().xyz[2]
        if host.simulator != "classic":
            from ros_gz_interfaces.msg import Altimeter as Message  # noqa: PLC0415  of Gazebo Sim

            self.message = Message
        self.open("/altimeter")

    def fill(self, message: Any) -> None:
        """As in the base."""
        height, climb = self.pose().xyz[2] - self._reference, self.velocity()[0][2]
        message.vertical_position = float(self._noises[0].apply(np.array(height)))
        message.vertical_velocity = float(self._noises[1].apply(np.array(climb)))
        message.vertical_reference = self._reference


class AirPressure(OfGazeboSim):
    """The pressure by the standard atmosphere, Pa.

    As sensor_msgs/FluidPressure (gazebosim/gz-sensors, src/AirPressureSensor.cc).
    """

    message = FluidPressure

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        element = sensor.element
        self._noise = Noise(
            element.find("air_pressure/pressure/noise"), np.random.default_rng(self.seed)
        )
        self._altitude = number(element, "air_pressure/reference_altitude", 0.0)
        self.open("/air_pressure")

    def fill(self, message: Any) -> None:
        """As in the base."""
        true = pressure_at(self._altitude + self.pose().xyz[2])
        message.fluid_pressure = float(self._noise.apply(np.array(true)))
        message.variance = self._noise.variance


FIELD = (5.5645e-6, 22.8758e-6, -42.3884e-6)  # T, SDF's default


class Magnetometer(OfGazeboSim):
    """The <magnetic_field> of the world in the frame of the sensor, T.

    As sensor_msgs/MagneticField (gazebosim/gz-sensors, src/MagnetometerSensor.cc). The tables of
    the field of Earth are not used.
    """

    message = MagneticField

    def __init__(self, host: Host, robot: RobotHandle, sensor: MountedSensor) -> None:
        super().__init__(host, robot, sensor)
        written = host.surroundings.get("magnetic_field")
        numbers = [] if written is None else numbers_of(written.text)
        self._field = np.array(numbers if len(numbers) == len(FIELD) else FIELD)
        random = np.random.default_rng(self.seed)
        self._noises = [
            Noise(sensor.element.find(f"magnetometer/{axis}/noise"), random) for axis in "xyz"
        ]
        self.open("/magnetometer")

    def fill(self, message: Any) -> None:
        """As in the base."""
        own = rotation(self.pose()).T @ self._field
        measured = [noise.apply(part) for noise, part in zip(self._noises, own, strict=True)]
        put(message.magnetic_field, np.array(measured))

"""Messages of sensors for tests without ROS: those of `fake_ros`, and what sensors need besides."""

from __future__ import annotations

import sys
import types
from typing import TYPE_CHECKING, Any

from live.nodes.fake_ros import Message, install_messages

if TYPE_CHECKING:
    from collections.abc import Callable

    import pytest

# As in `fake_ros`; `9` is a list of nine zeros.
_MESSAGES = """
std_msgs/Empty
geometry_msgs/Point32 x:n y:n z:n
geometry_msgs/Wrench force:Vector3 torque:Vector3
geometry_msgs/WrenchStamped header:Header wrench:Wrench
geometry_msgs/Vector3Stamped header:Header vector:Vector3
sensor_msgs/Imu header:Header orientation:Quaternion orientation_covariance:9 \
 angular_velocity:Vector3 angular_velocity_covariance:9 linear_acceleration:Vector3 \
 linear_acceleration_covariance:9
sensor_msgs/LaserScan header:Header angle_min:n angle_max:n angle_increment:n time_increment:n \
 scan_time:n range_min:n range_max:n ranges:l intensities:l
sensor_msgs/Range header:Header radiation_type:n field_of_view:n min_range:n max_range:n range:n
sensor_msgs/ChannelFloat32 name:s values:l
sensor_msgs/PointCloud header:Header points:l channels:l
sensor_msgs/PointField name:s offset:n datatype:n count:n
sensor_msgs/PointCloud2 header:Header height:n width:n fields:l is_bigendian:b point_step:n \
 row_step:n data:l is_dense:b
sensor_msgs/Image header:Header height:n width:n encoding:s is_bigendian:n step:n data:l
sensor_msgs/CameraInfo header:Header height:n width:n distortion_model:s d:l k:l r:l p:l
sensor_msgs/NavSatStatus status:n service:n
sensor_msgs/NavSatFix header:Header status:NavSatStatus latitude:n longitude:n altitude:n \
 position_covariance:9 position_covariance_type:n
sensor_msgs/FluidPressure header:Header fluid_pressure:n variance:n
sensor_msgs/MagneticField header:Header magnetic_field:Vector3 magnetic_field_covariance:9
gazebo_msgs/ContactState info:s collision1_name:s collision2_name:s wrenches:l \
 total_wrench:Wrench contact_positions:l contact_normals:l depths:l
gazebo_msgs/ContactsState header:Header states:l
ros_gz_interfaces/Entity id:n name:s type:n
ros_gz_interfaces/JointWrench body_1_wrench:Wrench body_2_wrench:Wrench
ros_gz_interfaces/Contact collision1:Entity collision2:Entity positions:l normals:l depths:l \
 wrenches:l
ros_gz_interfaces/Contacts header:Header contacts:l
ros_gz_interfaces/Altimeter header:Header vertical_position:n vertical_velocity:n \
 vertical_reference:n
sensor_msgs/BatteryState header:Header voltage:n current:n charge:n capacity:n \
 design_capacity:n percentage:n power_supply_status:n present:b
control_msgs/SteeringControllerStatus header:Header traction_wheels_position:l \
 traction_wheels_velocity:l steer_positions:l traction_command:l steering_angle_command:l
control_msgs/MecanumDriveControllerState header:Header front_left_wheel_velocity:n \
 back_left_wheel_velocity:n back_right_wheel_velocity:n front_right_wheel_velocity:n \
 reference_velocity:Twist
ackermann_msgs/AckermannDrive steering_angle:n speed:n
"""
_CONSTANTS = {
    "BatteryState": {
        f"POWER_SUPPLY_STATUS_{name}": number
        for number, name in enumerate(("CHARGING", "DISCHARGING", "NOT_CHARGING", "FULL"), 1)
    },
    "Range": {"ULTRASOUND": 0, "INFRARED": 1},
    "NavSatStatus": {"STATUS_FIX": 0, "SERVICE_GPS": 1},
    "NavSatFix": {"COVARIANCE_TYPE_DIAGONAL_KNOWN": 2},
}
_PLAIN: dict[str, Callable[[], Any]] = {
    "n": float,
    "s": str,
    "l": list,
    "b": bool,
    "9": lambda: [0.0] * 9,
}
_SHARED = {
    "Header": "std_msgs",
    "Vector3": "geometry_msgs",
    "Quaternion": "geometry_msgs",
    "Twist": "geometry_msgs",
}


def install_sensor_messages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have all messages of sensors, and the QoS of rclpy."""
    install_messages(monkeypatch)
    made: dict[str, Any] = {
        name: getattr(sys.modules[f"{package}.msg"], name) for name, package in _SHARED.items()
    }
    for line in _MESSAGES.strip().splitlines():
        name, *fields = line.split()
        package, _, short = name.partition("/")
        pairs = (field.split(":") for field in fields)
        kinds = {field: _PLAIN.get(kind) or made[kind] for field, kind in pairs}
        content = {"FIELDS": kinds, "__module__": f"{package}.msg", **_CONSTANTS.get(short, {})}
        made[short] = type(short, (Message,), content)
        if f"{package}.msg" not in sys.modules:
            whole, module = types.ModuleType(package), types.ModuleType(f"{package}.msg")
            whole.msg = module  # type: ignore[attr-defined]
            monkeypatch.setitem(sys.modules, package, whole)
            monkeypatch.setitem(sys.modules, f"{package}.msg", module)
        setattr(sys.modules[f"{package}.msg"], short, made[short])
    qos: Any = types.ModuleType("rclpy.qos")
    qos.QoSProfile = types.SimpleNamespace
    qos.ReliabilityPolicy = types.SimpleNamespace(RELIABLE="reliable", BEST_EFFORT="best_effort")
    qos.DurabilityPolicy = types.SimpleNamespace(VOLATILE="volatile", TRANSIENT_LOCAL="local")
    monkeypatch.setitem(sys.modules, "rclpy", types.ModuleType("rclpy"))
    monkeypatch.setitem(sys.modules, "rclpy.qos", qos)

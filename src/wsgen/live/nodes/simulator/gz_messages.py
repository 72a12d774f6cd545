"""Which messages of Gazebo Sim are which messages of ROS.

Here plugins speak ROS's messages on the topics of Gazebo, each the first one of its kind, and a
bridge makes the one that its rule wants of it. Source: gazebosim/ros_gz,
ros_gz_bridge/ros_gz_bridge/mappings.py and the conversions in ros_gz_bridge/src/convert.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

# Gazebo's type, without `gz.msgs.` -> ROS's types; the first one is what plugins speak here.
PAIRS: dict[str, tuple[str, ...]] = {
    "Actuators": ("actuator_msgs/Actuators",),
    "Altimeter": ("ros_gz_interfaces/Altimeter",),
    "AnnotatedAxisAligned2DBox": ("vision_msgs/Detection2D",),
    "AnnotatedAxisAligned2DBox_V": ("vision_msgs/Detection2DArray",),
    "AnnotatedOriented3DBox": ("vision_msgs/Detection3D",),
    "AnnotatedOriented3DBox_V": ("vision_msgs/Detection3DArray",),
    "Any": ("rcl_interfaces/ParameterValue",),
    "BatteryState": ("sensor_msgs/BatteryState",),
    "Boolean": ("std_msgs/Bool",),
    "CameraInfo": ("sensor_msgs/CameraInfo",),
    "Clock": ("rosgraph_msgs/Clock",),
    "Color": ("std_msgs/ColorRGBA",),
    "Contact": ("ros_gz_interfaces/Contact",),
    "Contacts": ("ros_gz_interfaces/Contacts",),
    "Dataframe": ("ros_gz_interfaces/Dataframe",),
    "Double": ("std_msgs/Float64",),
    "Empty": ("std_msgs/Empty",),
    "Entity": ("ros_gz_interfaces/Entity",),
    "EntityWrench": ("ros_gz_interfaces/EntityWrench",),
    "Float": ("std_msgs/Float32",),
    "Float_V": ("ros_gz_interfaces/Float32Array",),
    "FluidPressure": ("sensor_msgs/FluidPressure",),
    "GUICamera": ("ros_gz_interfaces/GuiCamera",),
    "Header": ("std_msgs/Header",),
    "IMU": ("sensor_msgs/Imu",),
    "Image": ("sensor_msgs/Image",),
    "Int32": ("std_msgs/Int32",),
    "JointTrajectory": ("trajectory_msgs/JointTrajectory",),
    "JointWrench": ("ros_gz_interfaces/JointWrench",),
    "Joy": ("sensor_msgs/Joy",),
    "LaserScan": ("sensor_msgs/LaserScan",),
    "Light": ("ros_gz_interfaces/Light",),
    "Magnetometer": ("sensor_msgs/MagneticField",),
    "MaterialColor": ("ros_gz_interfaces/MaterialColor",),
    "Model": ("sensor_msgs/JointState",),
    "NavSat": ("sensor_msgs/NavSatFix", "gps_msgs/GPSFix"),
    "Odometry": ("nav_msgs/Odometry",),
    "OdometryWithCovariance": ("nav_msgs/Odometry",),
    "Param": ("ros_gz_interfaces/ParamVec",),
    "Param_V": ("ros_gz_interfaces/ParamVec",),
    "PointCloudPacked": ("sensor_msgs/PointCloud2",),
    "Pose": (
        *("geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped", "geometry_msgs/Pose"),
        "geometry_msgs/Transform",
    ),
    "PoseWithCovariance": (
        *("geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseWithCovariance"),
    ),
    "Pose_V": ("tf2_msgs/TFMessage", "geometry_msgs/PoseArray"),
    "Quaternion": ("geometry_msgs/Quaternion",),
    "SensorNoise": ("ros_gz_interfaces/SensorNoise",),
    "StringMsg": ("std_msgs/String",),
    "StringMsg_V": ("ros_gz_interfaces/StringVec",),
    "Time": ("builtin_interfaces/Time",),
    "TrackVisual": ("ros_gz_interfaces/TrackVisual",),
    "Twist": ("geometry_msgs/Twist", "geometry_msgs/TwistStamped"),
    "TwistWithCovariance": (
        *("geometry_msgs/TwistWithCovariance", "geometry_msgs/TwistWithCovarianceStamped"),
    ),
    "UInt32": ("std_msgs/UInt32",),
    "Vector3d": ("geometry_msgs/Vector3", "geometry_msgs/Point"),
    "VideoRecord": ("ros_gz_interfaces/VideoRecord",),
    "Wrench": ("geometry_msgs/WrenchStamped", "geometry_msgs/Wrench"),
}
PREFIXES = ("gz.msgs.", "ignition.msgs.")


def short_ros_type(name: str) -> str:
    """`sensor_msgs/LaserScan` of a name with or without `/msg/`."""
    return name.replace("/msg/", "/")


def short_gz_type(name: str) -> str | None:
    """`LaserScan` of `gz.msgs.LaserScan` or the older name; None of any other name."""
    prefix = next((one for one in PREFIXES if name.startswith(one)), None)
    return None if prefix is None else name[len(prefix) :]


def name_of(message_type: type) -> str:
    """`sensor_msgs/LaserScan` of a class of messages."""
    return f"{message_type.__module__.partition('.')[0]}/{message_type.__name__}"


def message_class(name: str) -> type | None:
    """The class of a message type; None where its package is not installed."""
    package, _, message = short_ros_type(name).partition("/")
    try:
        found: type | None = getattr(importlib.import_module(f"{package}.msg"), message, None)
    except ImportError:
        return None
    return found


def conversion(source: str, target: str) -> Callable[[Any], Any] | None:
    """What makes a message of one type of another one; None where they have nothing in common."""
    if source == target:
        return _same
    return _CONVERSIONS.get((source, target))


def _same(message: Any) -> Any:
    return message


def _unstamped_twist(message: Any) -> Any:
    return message.twist


def _stamped_twist(message: Any) -> Any:
    made = _new("geometry_msgs/TwistStamped")
    made.twist = message
    return made


def _pose_array(message: Any) -> Any:
    made = _new("geometry_msgs/PoseArray")
    for transform in message.transforms:
        made.header = transform.header
        made.poses.append(_pose(transform))
    return made


def _pose(stamped: Any) -> Any:
    pose = _new("geometry_msgs/Pose")
    position, translation = pose.position, stamped.transform.translation
    position.x, position.y, position.z = translation.x, translation.y, translation.z
    pose.orientation = stamped.transform.rotation
    return pose


def _stamped_pose(stamped: Any) -> Any:
    made = _new("geometry_msgs/PoseStamped")
    made.header, made.pose = stamped.header, _pose(stamped)
    return made


def _unstamped_transform(message: Any) -> Any:
    return message.transform


def _unstamped_wrench(message: Any) -> Any:
    return message.wrench


def _stamped_wrench(message: Any) -> Any:
    made = _new("geometry_msgs/WrenchStamped")
    made.wrench = message
    return made


def _new(name: str) -> Any:
    made = message_class(name)
    assert made is not None  # noqa: S101  geometry_msgs are always there
    return made()


_CONVERSIONS: dict[tuple[str, str], Callable[[Any], Any]] = {
    ("geometry_msgs/TwistStamped", "geometry_msgs/Twist"): _unstamped_twist,
    ("geometry_msgs/Twist", "geometry_msgs/TwistStamped"): _stamped_twist,
    ("tf2_msgs/TFMessage", "geometry_msgs/PoseArray"): _pose_array,
    ("geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped"): _stamped_pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Pose"): _pose,
    ("geometry_msgs/TransformStamped", "geometry_msgs/Transform"): _unstamped_transform,
    ("geometry_msgs/WrenchStamped", "geometry_msgs/Wrench"): _unstamped_wrench,
    ("geometry_msgs/Wrench", "geometry_msgs/WrenchStamped"): _stamped_wrench,
}

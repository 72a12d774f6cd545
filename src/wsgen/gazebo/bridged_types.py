"""The types of messages that ros_gz_bridge converts to each other, from Humble on.

Source: gazebosim/ros_gz, ros_gz_bridge/ros_gz_bridge/mappings.py and the conversions in
ros_gz_bridge/src/convert.
"""

from __future__ import annotations

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
    "DVLVelocityTracking": ("marine_acoustic_msgs/Dvl",),
    "Dataframe": ("ros_gz_interfaces/Dataframe",),
    "Double": ("std_msgs/Float64",),
    "Empty": ("std_msgs/Empty",),
    "Entity": ("ros_gz_interfaces/Entity",),
    "EntityFactory": ("ros_gz_interfaces/EntityFactory",),
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
    "LaserScan": ("sensor_msgs/LaserScan", "sensor_msgs/Range"),
    "Light": ("ros_gz_interfaces/Light",),
    "LogicalCameraImage": ("ros_gz_interfaces/LogicalCameraImage",),
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
    "WorldControl": ("ros_gz_interfaces/WorldControl",),
    "WorldStatistics": ("ros_gz_interfaces/WorldStatistics",),
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

"""The sensors of Gazebo: the topics that they have in Gazebo Sim, and the systems that they need.

Source: gazebosim/gz-sensors; gazebosim/gz-sim, src/systems.
"""

from __future__ import annotations

from typing import NamedTuple

_LIDAR = (("", "LaserScan"), ("/points", "PointCloudPacked"))
_DEPTH = (("", "Image"), ("/points", "PointCloudPacked"))
_RGBD = (
    ("/image", "Image"),
    ("/depth_image", "Image"),
    ("/points", "PointCloudPacked"),
    ("/camera_info", "CameraInfo"),
)


class SensorTopics(NamedTuple):
    """The topics of a kind of sensors in Gazebo Sim."""

    default: str  # what ends the name of its own topic
    topics: tuple[tuple[str, str], ...]  # what comes after its own topic, with the types
    has_info: bool = False  # beside its own topic is a `camera_info`


SENSORS = {
    **dict.fromkeys(("gpu_lidar", "gpu_ray", "lidar", "ray"), SensorTopics("/scan", _LIDAR)),
    "imu": SensorTopics("/imu", (("", "IMU"),)),
    "camera": SensorTopics("/image", (("", "Image"),), has_info=True),
    **dict.fromkeys(("depth", "depth_camera"), SensorTopics("/depth_image", _DEPTH, has_info=True)),
    **dict.fromkeys(("rgbd", "rgbd_camera"), SensorTopics("", _RGBD)),
    "contact": SensorTopics("/contact", (("", "Contacts"),)),
    "force_torque": SensorTopics("/forcetorque", (("", "Wrench"),)),
    "magnetometer": SensorTopics("/magnetometer", (("", "Magnetometer"),)),
    "air_pressure": SensorTopics("/air_pressure", (("", "FluidPressure"),)),
    "altimeter": SensorTopics("/altimeter", (("", "Altimeter"),)),
    **dict.fromkeys(("navsat", "gps"), SensorTopics("/navsat", (("", "NavSat"),))),
}

# Plugin of a sensor in Gazebo Classic, as `stem` gives it -> its topics as nodes of ROS name them,
# with their types. `{camera}` is <camera_name>, or the name of the sensor; `{output_type}` is a
# parameter.
# Source: ros-simulation/gazebo_ros_pkgs, branch ros2, gazebo_plugins/src.
_IMAGE, _INFO = "sensor_msgs/Image", "sensor_msgs/CameraInfo"
TOPICS_OF_CLASSIC = {
    "gazebo_ros_bumper": {"bumper_states": "gazebo_msgs/ContactsState"},
    "gazebo_ros_camera": {"{camera}/image_raw": _IMAGE, "{camera}/camera_info": _INFO},
    "gazebo_ros_gps_sensor": {
        "~/out": "sensor_msgs/NavSatFix",
        "~/vel": "geometry_msgs/Vector3Stamped",
    },
    "gazebo_ros_imu_sensor": {"~/out": "sensor_msgs/Imu"},
    "gazebo_ros_ray_sensor": {"~/out": "{output_type}"},
}
# Those that its camera has besides for a depth camera.
TOPICS_OF_DEPTH = {
    "{camera}/depth/image_raw": _IMAGE,
    "{camera}/depth/camera_info": _INFO,
    "{camera}/points": "sensor_msgs/PointCloud2",
}
DEPTH_KINDS = ("depth", "depth_camera")

# Kind of a sensor -> the system without which it sends nothing. Where a robot or model has the
# system it works for all, but for the default ones, which ask for the name of a world.
SYSTEM_OF_SENSOR = {
    **dict.fromkeys(
        (
            *("camera", "multicamera", "depth", "depth_camera", "rgbd", "rgbd_camera"),
            *("thermal", "thermal_camera", "segmentation", "segmentation_camera"),
            *("boundingbox", "boundingbox_camera", "wideanglecamera", "wide_angle_camera"),
            *("gpu_ray", "gpu_lidar"),
        ),
        "Sensors",
    ),
    **dict.fromkeys(("ray", "lidar"), "CpuLidar"),  # of Rotary; older ones have none
    **dict.fromkeys(("gps", "navsat"), "NavSat"),
    "imu": "Imu",
    "contact": "Contact",
    "force_torque": "ForceTorque",
    "altimeter": "Altimeter",
    "air_pressure": "AirPressure",
    "air_speed": "AirSpeed",
    "magnetometer": "Magnetometer",
    "logical_camera": "LogicalCamera",
}
# Where a sensor may name the frame of its messages, over the generations of Gazebo Sim.
FRAME_NAMES = ("frame_id", "gz_frame_id", "ignition_frame_id")
# What Gazebo Sim simulates only from Rotary on, and the distribution that may have that.
RAYS = ("ray", "lidar")
WITH_RAYS = ("rolling",)
# Of these sensors a plugin sends messages with a frame.
WITH_FRAMES = frozenset(
    (
        *("camera", "depth", "depth_camera", "rgbd", "rgbd_camera", "ray", "gpu_ray", "lidar"),
        *("gpu_lidar", "imu", "navsat", "gps", "magnetometer"),
    )
)

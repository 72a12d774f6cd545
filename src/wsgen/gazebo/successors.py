"""What a plugin of one simulator is in the other, and what one of ROS 1 is in ROS 2.

Source: the repositories that `plugins` names; the migration guide of ros_gz.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.gazebo.plugins import stem

if TYPE_CHECKING:
    from collections.abc import Collection

# Plugin of Gazebo Classic -> what Gazebo Sim has instead.
SUCCESSORS = {
    "gazebo_ros_diff_drive": "gz-sim-diff-drive-system",
    "gazebo_ros_joint_state_publisher": "gz-sim-joint-state-publisher-system",
    "gazebo_ros_ackermann_drive": "gz-sim-ackermann-steering-system",
    "gazebo_ros_p3d": "gz-sim-odometry-publisher-system",
    "gazebo_ros_planar_move": "gz-sim-velocity-control-system",
    "gazebo_ros_ft_sensor": "gz-sim-forcetorque-system",
    "gazebo_ros2_control": "gz_ros2_control-system",
}
# What moves the joints of a robot in Gazebo Sim.
_DRIVES = (
    *("diff-drive", "ackermann-steering", "mecanum-drive", "tracked-vehicle", "velocity-control"),
    *("gz_ros2_control-system", "ign_ros2_control-system"),
)
_STATES = ("joint-state-publisher", "gz_ros2_control-system", "ign_ros2_control-system")
# Plugin of Gazebo Classic -> those of Gazebo Sim that do the same in a robot for both.
COUNTERPARTS = {
    **dict.fromkeys(
        (
            *("gazebo_ros_diff_drive", "gazebo_ros_ackermann_drive", "gazebo_ros_planar_move"),
            *("gazebo_ros_tricycle_drive", "gazebo_ros2_control"),
        ),
        _DRIVES,
    ),
    "gazebo_ros_joint_state_publisher": _STATES,
    "gazebo_ros_joint_pose_trajectory": (*_STATES, "joint-trajectory-controller"),
    "gazebo_ros_p3d": ("odometry-publisher", "pose-publisher"),
    "gazebo_ros_ft_sensor": ("forcetorque",),
}
# What somebody writes for one simulator who knows the other -> what it is called there.
OF_THE_OTHER: dict[str, dict[str, str]] = {
    "gazebo_ros_diff_drive": {
        "wheel_radius": "wheel_diameter",
        "odom_topic": "odometry_topic",
        "topic": "command_topic",
        "child_frame_id": "robot_base_frame",
        "frame_id": "odometry_frame",
        "odom_publish_frequency": "update_rate",
    },
    "diff-drive": {
        "wheel_diameter": "wheel_radius",
        "odometry_topic": "odom_topic",
        "command_topic": "topic",
        "robot_base_frame": "child_frame_id",
        "odometry_frame": "frame_id",
        "update_rate": "odom_publish_frequency",
    },
}
# Parameters of the plugins of ROS 1 -> what those of ROS 2 have, where snake case is not it.
FROM_ROS_1 = {
    "robotNamespace": "<ros><namespace>",
    "topicName": "<ros><remapping>",
    "imageTopicName": "<ros><remapping>",
    "cameraInfoTopicName": "<ros><remapping>",
    "bodyName": "<body_name>",
    "torque": "<max_wheel_torque>",
}
# Plugin libraries that no ROS 2 release has, with what took their place.
ROS_1_PLUGINS = {
    "gazebo_ros_control": "libgazebo_ros2_control.so with <ros2_control> tags",
    "gazebo_ros_skid_steer_drive": "libgazebo_ros_diff_drive.so with two wheel pairs",
    "gazebo_ros_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_gpu_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_block_laser": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_range": "libgazebo_ros_ray_sensor.so",
    "gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
    "gazebo_ros_depth_camera": "libgazebo_ros_camera.so",
    "gazebo_ros_openni_kinect": "libgazebo_ros_camera.so",
    "gazebo_ros_multicamera": "libgazebo_ros_camera.so",
    "gazebo_ros_f3d": "libgazebo_ros_ft_sensor.so",
    "gazebo_ros_joint_pose_trajectory_plugin": "libgazebo_ros_joint_pose_trajectory.so",
    "gazebo_ros_joint_trajectory": "libgazebo_ros_joint_pose_trajectory.so",
    "gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
    "roboticsgroup_gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
    "hector_gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
    "hector_gazebo_ros_gps": "libgazebo_ros_gps_sensor.so",
}


def is_served(name: str, right: Collection[str]) -> bool:
    """Whether plugins for the right simulator do what one for the other does."""
    same = COUNTERPARTS.get(name) or [
        classic for classic, systems in COUNTERPARTS.items() if name in systems
    ]
    # Of sensors and of what only one simulator has, any plugin shows that both are meant.
    return any(one in right for one in same) if same else bool(right)


def predecessor(name: str) -> str | None:
    """The plugin of Gazebo Classic that a system of Gazebo Sim follows, by its stem."""
    for classic, system in SUCCESSORS.items():
        if stem(system) == name:
            return f"lib{classic}.so"
    return None

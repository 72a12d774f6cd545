"""What is known about ROS 2 distributions and the Gazebos for them: data, each with its source.

State of 2026-11-21. `wsgen.model.target` gives these tables their types and words; a distribution
that comes or goes changes this file and nothing else.
"""

from __future__ import annotations

# Key -> where it is written.
SOURCES = {
    "CLSEOL": "ros-simulation/gazebo_ros_pkgs#1568; ros/rosdistro#44369",
    "CMAKE": "release notes of CMake 3.31 and 4.0; ros2/ros2cli, ros2pkg",
    "DOC": "ros2/ros2_documentation, source/Releases.rst; ros/rosdistro, index-v4.yaml",
    "GR2C": "ros2-gbp/gazebo_ros2_control-release",
    "GRP": "ros2-gbp/gazebo_ros_pkgs-release, gazebo_ros and gazebo_plugins",
    "GZC": "ros2-gbp/ign_ros2_control-release, gz_ros2_control",
    "GZIDX": "gazebosim/docs, index.yaml",
    "GZROS": "gazebosim/docs, common/ros_installation.md",
    "GZSENS": "gazebosim/gz-sensors#306 and #444",
    "GZS": "gazebosim/gz-sim, src/SystemLoader.cc and src/systems",
    "REP2000": "ros-infrastructure/rep, rep-2000.rst; for Lyrical ros2/ros2_documentation, "
    "source/Releases/lyrical/supported-platforms.rst",
    "RGZ": "ros2-gbp/ros_ign-release, ros_gz_sim and ros_gz_bridge",
    "ROSDISTRO": "ros/rosdistro, DISTRO/distribution.yaml of 2026-08-22",
    "SDF": "gazebosim/sdformat, CMakeLists.txt",
}

DISTROS = ("humble", "iron", "jazzy", "kilted", "lyrical", "rolling")  # oldest first

# Fact -> its source, then its value for each of DISTROS. Dates are YYYY-MM-DD, or YYYY-MM where no
# day is announced; None where there is none.
# fmt: off
OF_DISTROS: dict[str, tuple[str | None, ...]] = {
    "released":
        ("DOC", "2022-05-23", "2023-05-23", "2024-05-23", "2025-05-23", "2026-05-22", "2020-06"),
    "end_of_life": ("DOC", "2027-05", "2024-12-04", "2029-05", "2026-12", "2031-05", None),
    "support": ("DOC", "long-term", "ended", "long-term", "short-term", "long-term", "rolling"),
    "ubuntu": ("REP2000", "22.04", "22.04", "24.04", "24.04", "26.04", "26.04"),
    "ubuntu_codename": ("REP2000", "jammy", "jammy", "noble", "noble", "resolute", "resolute"),
    "python": ("REP2000", "3.10", "3.10", "3.12", "3.12", "3.14", "3.14"),
    "cmake": ("REP2000", "3.22.1", "3.22.1", "3.28.3", "3.28.3", "4.2.3", "4.2.3"),
    # That every generated CMakeLists asks for: CMake 4 warns about minimums below 3.10.
    "cmake_minimum": ("CMAKE", "3.20", "3.20", "3.20", "3.20", "3.20", "3.20"),
    "gz_name": ("GZROS", "Fortress", "Fortress", "Harmonic", "Ionic", "Jetty", "Jetty"),
    # Of gz-sim.
    "gz_version": ("GZROS", "6", "6", "8", "9", "10", "10"),
    "gz_end_of_life": ("GZIDX", "2027-05", None, "2029-05", "2026-12", "2031-05", None),
    "gz_sdf_version": ("SDF", "1.9", "1.9", "1.11", "1.12", "1.12", "1.12"),
    # Element of a <sensor> that says in which frame its messages are.
    "gz_frame_tag":
        ("GZSENS", "gz_frame_id", "gz_frame_id", "gz_frame_id", "frame_id", "frame_id", "frame_id"),
}
# fmt: on

# The same for Gazebo Classic 11, whatever the distribution.
OF_CLASSIC: dict[str, tuple[str, str]] = {
    "version": ("GRP", "11"),
    "end_of_life": ("CLSEOL", "2025-01"),
    "sdf_version": ("SDF", "1.7"),
}

# Package -> the distributions it is released for, of those packages that are not in all of them
# (ROSDISTRO).
RELEASED_FOR = {
    "gazebo_ros": ("humble", "iron"),
    "gazebo_ros_pkgs": ("humble", "iron"),
    "gazebo_plugins": ("humble", "iron"),
    "gazebo_dev": ("humble", "iron"),
    "gazebo_msgs": ("humble", "iron", "jazzy"),
    "gazebo_ros2_control": ("humble", "iron"),
    "ign_ros2_control": ("humble",),
    "gz_sim_vendor": ("jazzy", "kilted", "lyrical", "rolling"),
}
WITHOUT_CLASSIC = tuple(distro for distro in DISTROS if distro not in RELEASED_FOR["gazebo_ros"])
# The others that generated packages may need: in every distribution.
RELEASED_FOR_ALL = (
    "ament_cmake",
    "ament_cmake_pytest",
    "ament_lint_auto",
    "ament_lint_common",
    "controller_manager",
    "geometry_msgs",
    "gz_ros2_control",
    "joint_state_publisher",
    "joint_state_publisher_gui",
    "launch",
    "launch_ros",
    "rclpy",
    "robot_state_publisher",
    "ros2_control",
    "ros2_controllers",
    "ros2launch",
    "ros_gz",
    "ros_gz_bridge",
    "ros_gz_sim",
    "rviz2",
    "sensor_msgs",
    "xacro",
)

# Simulator -> what starts it and puts a robot into it: the same in all its distributions.
# Fact -> source and value.
PROGRAMS: dict[str, dict[str, tuple[str, str]]] = {
    "classic": {
        "package": ("GRP", "gazebo_ros"),
        "launch_file": ("GRP", "gazebo.launch.py"),
        "spawner": ("GRP", "spawn_entity.py"),
        "topic_flag": ("GRP", "-topic"),
        "entity_flag": ("GRP", "-entity"),
        "pose_flags": ("GRP", "-x -y -z -R -P -Y"),
    },
    "gz": {
        "package": ("RGZ", "ros_gz_sim"),
        "launch_file": ("RGZ", "gz_sim.launch.py"),
        "spawner": ("RGZ", "create"),
        "topic_flag": ("RGZ", "-topic"),
        "entity_flag": ("RGZ", "-name"),
        "pose_flags": ("RGZ", "-x -y -z -R -P -Y"),
        "bridge_package": ("RGZ", "ros_gz_bridge"),
        "bridge": ("RGZ", "parameter_bridge"),
    },
}

# Simulator -> role -> source, file name, name. The gz-sim names serve Fortress from 6.16 to Jetty.
# In Gazebo Classic the name is free; it is by custom that of the library.
PLUGINS: dict[str, dict[str, tuple[str, str, str]]] = {
    "classic": {
        "diff_drive": ("GRP", "libgazebo_ros_diff_drive.so", "gazebo_ros_diff_drive"),
        "joint_state_publisher": (
            "GRP",
            "libgazebo_ros_joint_state_publisher.so",
            "gazebo_ros_joint_state_publisher",
        ),
        "camera_sensor": ("GRP", "libgazebo_ros_camera.so", "gazebo_ros_camera"),
        "imu_sensor": ("GRP", "libgazebo_ros_imu_sensor.so", "gazebo_ros_imu_sensor"),
        "ray_sensor": ("GRP", "libgazebo_ros_ray_sensor.so", "gazebo_ros_ray_sensor"),
        "ros2_control": ("GR2C", "libgazebo_ros2_control.so", "gazebo_ros2_control"),
    },
    "gz": {
        "physics": ("GZS", "gz-sim-physics-system", "gz::sim::systems::Physics"),
        "user_commands": ("GZS", "gz-sim-user-commands-system", "gz::sim::systems::UserCommands"),
        "scene_broadcaster": (
            "GZS",
            "gz-sim-scene-broadcaster-system",
            "gz::sim::systems::SceneBroadcaster",
        ),
        "sensors": ("GZS", "gz-sim-sensors-system", "gz::sim::systems::Sensors"),
        "imu": ("GZS", "gz-sim-imu-system", "gz::sim::systems::Imu"),
        "contact": ("GZS", "gz-sim-contact-system", "gz::sim::systems::Contact"),
        "diff_drive": ("GZS", "gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive"),
        "joint_state_publisher": (
            "GZS",
            "gz-sim-joint-state-publisher-system",
            "gz::sim::systems::JointStatePublisher",
        ),
        "odometry_publisher": (
            "GZS",
            "gz-sim-odometry-publisher-system",
            "gz::sim::systems::OdometryPublisher",
        ),
        "joint_position_controller": (
            "GZS",
            "gz-sim-joint-position-controller-system",
            "gz::sim::systems::JointPositionController",
        ),
        "ros2_control": (
            "GZC",
            "gz_ros2_control-system",
            "gz_ros2_control::GazeboSimROS2ControlPlugin",
        ),
    },
}

# Simulator -> source, <plugin> in <hardware> of <ros2_control>.
ROS2_CONTROL_HARDWARE = {
    "classic": ("GR2C", "gazebo_ros2_control/GazeboSystem"),
    "gz": ("GZC", "gz_ros2_control/GazeboSimSystem"),
}

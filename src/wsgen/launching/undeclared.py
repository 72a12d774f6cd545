"""What is reported about a package that is used and not declared in package.xml."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence


UNDECLARED_PACKAGE = Rule(
    code="LCH045",
    name="undeclared-package",
    severity=Severity.WARNING,
    summary="The launch file uses packages that `package.xml` does not declare.",
    what="Compares the packages of which the launch files of a package look up a folder or a "
    "program with the dependencies in `package.xml`.",
    why="`rosdep install` does not install them, so that the launch fails on another machine.",
    example="Node(package='slam_toolbox', executable='sync_slam_toolbox_node')",
    instead="<!-- package.xml -->\n<exec_depend>slam_toolbox</exec_depend>",
)
MOST_NAMED = 12  # packages in a message

_CORE_MESSAGES = "std_msgs|builtin_interfaces|geometry_msgs"
# A package -> a pattern of the packages that come with it, from their package.xml in ros/rosdistro.
BROUGHT = {
    "ament_cmake_auto": "ament_cmake",
    "common_interfaces": f"{_CORE_MESSAGES}|sensor_msgs|nav_msgs|(?:actionlib|diagnostic|shape|"
    "stereo|trajectory|visualization)_msgs|std_srvs",
    "controller_interface": "hardware_interface|rclcpp|rclcpp_lifecycle",
    "controller_manager": "controller_interface|hardware_interface|controller_manager_msgs|"
    "ros2_control_test_assets|ros2controlcli",
    "cv_bridge": "sensor_msgs|std_msgs|geometry_msgs|builtin_interfaces",
    "desktop": r"\w+",  # too much to say what it lacks
    "desktop_full": r"\w+",
    "effort_controllers": "forward_command_controller",
    "gazebo_ros2_control": "controller_manager|hardware_interface|gazebo_ros",
    "gazebo_ros_pkgs": "gazebo_(?:ros|plugins|msgs|dev)",
    "geometry_msgs": "std_msgs|builtin_interfaces",
    "gz_ros2_control": "controller_manager|hardware_interface",
    "hardware_interface": "pluginlib|rclcpp|rclcpp_lifecycle|control_msgs|lifecycle_msgs",
    "ign_ros2_control": "controller_manager|hardware_interface|gz_ros2_control",
    "image_transport": "sensor_msgs|message_filters|rclcpp|pluginlib",
    "joint_state_publisher_gui": "joint_state_publisher",
    "launch_ros": "ament_index_python|launch",
    "moveit": r"moveit_\w+",
    "moveit_core": r"rclcpp|geometric_shapes|octomap_msgs|\w+_msgs|tf2_\w+",
    "moveit_py": r"moveit_\w+",
    "moveit_ros": r"moveit_ros_\w+",
    "moveit_ros_planning": r"rclcpp\w*|moveit_core|moveit_msgs|pluginlib",
    "moveit_ros_planning_interface": r"rclcpp\w*|moveit_core|moveit_msgs|moveit_ros_planning",
    "nav2_bringup": r"nav2_\w+|slam_toolbox|navigation2|rclcpp_components",
    "nav2_util": r"rclcpp\w*|nav2_msgs|nav2_common|geometry_msgs|lifecycle_msgs",
    "nav_msgs": _CORE_MESSAGES,
    "navigation2": r"nav2_\w+",
    "perception": r"\w+",
    "pluginlib": "class_loader",
    "position_controllers": "forward_command_controller",
    "rclcpp": r"builtin_interfaces|rcl_interfaces|rosgraph_msgs|statistics_msgs|rcl|rcutils|rmw|"
    r"rmw_implementation|rcl_yaml_param_parser|rcpputils|ament_index_cpp|libstatistics_collector|"
    r"rosidl_\w+",
    "rclcpp_action": "action_msgs|rclcpp",
    "rclcpp_cascade_lifecycle": "rclcpp|rclcpp_lifecycle|lifecycle_msgs",
    "rclcpp_components": "ament_index_cpp|class_loader|composition_interfaces|rclcpp",
    "rclcpp_lifecycle": "lifecycle_msgs|rclcpp",
    "rclpy": "builtin_interfaces|rcl_interfaces|action_msgs|unique_identifier_msgs|lifecycle_msgs|"
    "rosgraph_msgs|ament_index_python|rpyutils|rosidl_runtime_py",
    "ros2_control": "controller_manager|controller_manager_msgs|controller_interface|"
    "hardware_interface|joint_limits|ros2controlcli|transmission_interface",
    "ros2_controllers": r"\w+_(?:controllers?|broadcaster)",
    "ros2launch": "ament_index_python|launch|launch_ros|launch_xml|launch_yaml",
    "ros_base": r"\w+",
    "ros_core": r"\w+",
    "ros_gz": r"ros_gz_\w+",
    "ros_ign": r"ros_(?:ign|gz)_\w+",
    "ros_ign_bridge": "ros_gz_bridge",
    "ros_ign_gazebo": "ros_gz_sim",
    "rosidl_default_generators": "builtin_interfaces|service_msgs|action_msgs",
    "rqt_gui": "qt_gui|python_qt_binding|rqt_gui_py",
    "rqt_gui_py": "rqt_gui|qt_gui|python_qt_binding|rclpy",
    "rviz2": "rviz_common|rviz_default_plugins|rviz_rendering",
    "rviz_common": "rclcpp|pluginlib|tf2_ros|rviz_rendering|rviz_ogre_vendor",
    "sensor_msgs": _CORE_MESSAGES,
    "sensor_msgs_py": "sensor_msgs",
    "simulation": r"\w+",
    "slam_toolbox": "nav2_map_server",
    "tf2_geometry_msgs": "tf2|tf2_ros|tf2_ros_py|geometry_msgs|std_msgs",
    "tf2_ros": "tf2|tf2_msgs|tf2_ros_py|tf2_py|geometry_msgs|message_filters|builtin_interfaces",
    "tf2_ros_py": "tf2_ros|tf2_msgs|tf2_py|geometry_msgs|std_msgs|sensor_msgs|builtin_interfaces",
    "trajectory_msgs": _CORE_MESSAGES,
    "turtlebot3_gazebo": "gazebo_ros_pkgs|gazebo_ros",
    "velocity_controllers": "forward_command_controller",
    "visualization_msgs": f"{_CORE_MESSAGES}|sensor_msgs",
}


def is_brought(package: str, declared: Collection[str]) -> bool:
    """Whether one of the declared packages needs a package, so that it is installed with it."""
    return any(
        one in BROUGHT and re.fullmatch(BROUGHT[one], package) is not None for one in declared
    )


def undeclared(packages: Sequence[str], users: str) -> tuple[str, str]:
    """Message and hint.

    Args:
        packages: their names, at least one.
        users: what uses them, with its verb: "the launch file uses".
    """
    lines = " ".join(f"<exec_depend>{package}</exec_depend>" for package in packages)
    return (
        f"package.xml does not declare {listed(packages)}, which {users}.",
        f"Add to package.xml: {lines}",
    )


def listed(names: Sequence[str]) -> str:
    """The first names, and how many follow."""
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory("liner")
    gazebo = os.path.join(get_package_share_directory("gazebo_ros"), "launch", "gazebo.launch.py")
    robot = Command(["xacro ", os.path.join(share, "urdf", "liner.urdf.xacro")])
    return LaunchDescription(
        [
            DeclareLaunchArgument("by", default_value="camera", choices=["camera", "lidar"]),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(gazebo),
                launch_arguments={"world": os.path.join(share, "worlds", "ring.world")}.items(),
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[
                    {
                        "robot_description": ParameterValue(robot, value_type=str),
                        "use_sim_time": True,
                    }
                ],
            ),
            Node(
                package="gazebo_ros",
                executable="spawn_entity.py",
                arguments=[
                    "-topic",
                    "robot_description",
                    "-entity",
                    "liner",
                    "-y",
                    "-1.0",
                    "-z",
                    "0.05",
                ],
            ),
            Node(
                package="liner",
                executable=[LaunchConfiguration("by"), "_follower"],
                name="follower",
                parameters=[{"use_sim_time": True}],
            ),
        ]
    )

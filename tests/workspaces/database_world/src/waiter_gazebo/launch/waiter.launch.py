import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('waiter_gazebo')
    gazebo_ros = get_package_share_directory('gazebo_ros')
    with open(os.path.join(share, 'urdf', 'waiter.urdf')) as file:
        description = file.read()
    return LaunchDescription([
        DeclareLaunchArgument(
            'world', default_value=os.path.join(gazebo_ros, 'worlds', 'empty.world')),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(gazebo_ros, 'launch', 'gazebo.launch.py')),
            launch_arguments={'world': LaunchConfiguration('world')}.items()),
        Node(
            package='robot_state_publisher', executable='robot_state_publisher',
            parameters=[{'robot_description': description}]),
        Node(
            package='gazebo_ros', executable='spawn_entity.py',
            arguments=['-entity', 'waiter', '-topic', 'robot_description', '-z', '0.3']),
    ])

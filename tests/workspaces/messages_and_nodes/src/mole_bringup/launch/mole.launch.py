import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    urdf = os.path.join(get_package_share_directory('mole_bringup'), 'urdf', 'mole.urdf')
    with open(urdf) as file:
        description = file.read()
    gazebo = os.path.join(
        get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource(gazebo)),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': description}]),
        Node(package='gazebo_ros', executable='spawn_entity.py',
             arguments=['-topic', 'robot_description', '-entity', 'mole', '-z', '0.1']),
        Node(package='mole_control', executable='digger_node'),
        Node(package='mole_bringup', executable='commander'),
    ])

import os

import xacro
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    pkg = get_package_share_directory('beetle_bringup')
    description = xacro.process_file(os.path.join(pkg, 'urdf', 'beetle.urdf.xacro')).toxml()

    gazebo = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(
            os.path.join(get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')),
        launch_arguments={'world': os.path.join(pkg, 'worlds', 'garden.world')}.items(),
    )
    state_publisher = Node(
        package='robot_state_publisher',
        executable='robot_state_publisher',
        parameters=[{'robot_description': description, 'use_sim_time': True}],
    )
    spawn = Node(
        package='gazebo_ros',
        executable='spawn_entity.py',
        arguments=['-topic', 'robot_description', '-entity', 'beetle', '-z', '0.06'],
    )
    circles = Node(
        package='beetle_bringup',
        executable='drive_in_circles',
        parameters=[os.path.join(pkg, 'config', 'circles.yaml')],
    )
    return LaunchDescription([gazebo, state_publisher, spawn, circles])

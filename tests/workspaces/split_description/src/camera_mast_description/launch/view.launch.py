import os

import xacro
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('camera_mast_description')
    description = xacro.process_file(os.path.join(share, 'urdf', 'camera_mast.urdf.xacro')).toxml()
    return LaunchDescription([
        DeclareLaunchArgument('use_sim_time', default_value='false'),
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            parameters=[{
                'robot_description': description,
                'use_sim_time': LaunchConfiguration('use_sim_time'),
            }],
        ),
    ])

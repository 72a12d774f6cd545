import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('snail_gazebo')
    gz_sim = os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(gz_sim),
            launch_arguments={'gz_args': '-r ' + os.path.join(share, 'worlds', 'bed.sdf')}.items()),
        Node(package='ros_gz_sim', executable='create', arguments=[
            '-name', 'snail', '-z', '0.1', '-file', os.path.join(share, 'models', 'snail', 'model.sdf')]),
    ])

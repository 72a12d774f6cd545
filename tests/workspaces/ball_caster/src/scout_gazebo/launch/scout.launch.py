import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('scout_gazebo')
    world = os.path.join(share, 'worlds', 'yard.sdf')
    model = os.path.join(share, 'models', 'scout', 'model.sdf')
    gz_sim = os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(gz_sim), launch_arguments={'gz_args': '-r ' + world}.items()),
        Node(
            package='ros_gz_sim', executable='create',
            arguments=['-name', 'scout', '-file', model, '-z', '0.15']),
    ])

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    gazebo = os.path.join(get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')
    urdf = os.path.join(get_package_share_directory('own_cart'), 'urdf', 'cart.urdf')
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource(gazebo)),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': open(urdf).read()}]),
        Node(package='own_cart', executable='put_cart.py'),
    ])

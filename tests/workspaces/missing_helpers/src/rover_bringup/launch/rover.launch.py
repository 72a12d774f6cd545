"""Gazebo with the rover, and everything that we use with it."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, RegisterEventHandler
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessStart
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare
from teleop_tools_msgs.action import Increment  # noqa: F401


def generate_launch_description():
    share = get_package_share_directory('rover_bringup')
    navigation = get_package_share_directory('nav2_bringup')
    model = os.path.join(share, 'urdf', 'rover.urdf.xacro')

    gazebo = IncludeLaunchDescription(
        PythonLaunchDescriptionSource([FindPackageShare('gazebo_ros'), '/launch/gazebo.launch.py']))
    publisher = Node(
        package='robot_state_publisher', executable='robot_state_publisher',
        parameters=[{'robot_description': ParameterValue(
            Command(['xacro ', model]), value_type=str)}])
    driver = Node(package='rplidar_ros', executable='rplidar_node', name='lidar')
    spawner = Node(
        package='gazebo_ros', executable='spawn_entity.py',
        arguments=['-topic', 'robot_description', '-entity', 'rover', '-z', '0.1'])
    mapping = Node(
        package='slam_toolbox', executable='async_slam_toolbox_node',
        parameters=[os.path.join(get_package_share_directory('slam_toolbox'), 'config',
                                 'mapper_params_online_async.yaml')],
        condition=IfCondition(LaunchConfiguration('slam')))

    return LaunchDescription([
        DeclareLaunchArgument('slam', default_value='true'),
        gazebo,
        publisher,
        driver,
        RegisterEventHandler(OnProcessStart(target_action=driver, on_start=[spawner])),
        mapping,
        Node(package='teleop_twist_keyboard', executable='teleop_twist_keyboard', prefix='xterm -e'),
        Node(package='rviz2', executable='rviz2', arguments=[
            '-d', PathJoinSubstitution([FindPackageShare('nav2_bringup'), 'rviz', 'nav2_view.rviz'])]),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                os.path.join(navigation, 'launch', 'navigation_launch.py')),
            launch_arguments={'use_sim_time': 'true'}.items()),
    ])

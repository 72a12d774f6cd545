import os
import tempfile

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument, ExecuteProcess, IncludeLaunchDescription, OpaqueFunction,
    RegisterEventHandler)
from launch.event_handlers import OnProcessExit, OnShutdown
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('depot_bot')
    headless = LaunchConfiguration('headless')

    world = tempfile.mktemp(prefix='depot_', suffix='.sdf')
    expand_world = ExecuteProcess(cmd=[
        'xacro', '-o', world, ['headless:=', headless],
        os.path.join(share, 'worlds', 'depot.sdf.xacro')])
    simulator = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(os.path.join(
            get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')),
        launch_arguments={'gz_args': ['-r -s ', world]}.items())

    expand_robot = ExecuteProcess(
        cmd=['ros2 run xacro xacro', os.path.join(share, 'urdf', 'bot.urdf.xacro'),
             'mass:=2.5', '>', 'bot.urdf', '&&', 'echo expanded'],
        shell=True)
    spawner = Node(
        package='ros_gz_sim', executable='create',
        arguments=['-file', 'bot.urdf', '-name', 'bot', '-z', '0.4'])

    view = ExecuteProcess(cmd=['gz', 'sim', '-g'], on_exit=OpaqueFunction(
        function=lambda context: os.remove(world)))
    return LaunchDescription([
        DeclareLaunchArgument('headless', default_value='True'),
        expand_world,
        RegisterEventHandler(OnShutdown(on_shutdown=[
            OpaqueFunction(function=lambda context: os.remove(world))])),
        simulator,
        expand_robot,
        RegisterEventHandler(OnProcessExit(target_action=expand_robot, on_exit=[spawner])),
        view,
    ])

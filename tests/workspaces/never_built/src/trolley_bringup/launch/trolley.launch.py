import os

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch import LaunchDescription
from launch.actions import AppendEnvironmentVariable, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    description = get_package_share_directory('trolley_description')
    models = AppendEnvironmentVariable(
        'GAZEBO_MODEL_PATH', os.path.join(get_package_prefix('trolley_description'), 'share')
    )
    gazebo = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(
            os.path.join(get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')
        ),
        launch_arguments={'world': os.path.join(description, 'worlds', 'yard.world')}.items(),
    )
    model = IncludeLaunchDescription(
        PathJoinSubstitution(
            [FindPackageShare('trolley_bringup'), 'launch', 'robot_state_publisher.launch.xml']
        )
    )
    spawn = Node(
        package='gazebo_ros',
        executable='spawn_entity.py',
        arguments=['-entity', 'trolley', '-topic', 'robot_description', '-z', '0.3'],
    )
    return LaunchDescription([models, gazebo, model, spawn])

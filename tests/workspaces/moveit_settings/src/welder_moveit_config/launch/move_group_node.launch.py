import os

import yaml
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def load(name):
    share = get_package_share_directory('welder_moveit_config')
    with open(os.path.join(share, 'config', name)) as stream:
        return yaml.safe_load(stream) if name.endswith('.yaml') else stream.read()


def generate_launch_description():
    return LaunchDescription([
        Node(
            package='moveit_ros_move_group',
            executable='move_group',
            parameters=[
                {'robot_description_semantic': load('welder.srdf')},
                {'robot_description_kinematics': load('kinematics.yaml')},
                load('moveit_controllers.yaml'),
            ],
        ),
    ])

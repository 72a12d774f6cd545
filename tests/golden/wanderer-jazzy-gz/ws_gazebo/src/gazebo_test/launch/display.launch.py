"""Show the robot of this package in RViz, with a slider for each joint and no simulation."""

from launch import LaunchDescription
from launch.substitutions import Command, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Start robot_state_publisher, the sliders and RViz."""
    share = FindPackageShare('gazebo_test')
    model = PathJoinSubstitution([share, 'model', 'robot.xacro'])

    # The quotes keep a path with spaces together. Without ParameterValue, launch would parse the
    # text as YAML.
    robot_description = ParameterValue(Command(['xacro "', model, '"']), value_type=str)
    robot_state_publisher = Node(
        package='robot_state_publisher',
        executable='robot_state_publisher',
        output='screen',
        parameters=[{'robot_description': robot_description}],
    )

    joint_sliders = Node(
        package='joint_state_publisher_gui',
        executable='joint_state_publisher_gui',
        output='screen',
    )

    rviz = Node(
        package='rviz2',
        executable='rviz2',
        output='screen',
        arguments=['-d', PathJoinSubstitution([share, 'config', 'robot.rviz'])],
    )

    return LaunchDescription([
        robot_state_publisher,
        joint_sliders,
        rviz,
    ])

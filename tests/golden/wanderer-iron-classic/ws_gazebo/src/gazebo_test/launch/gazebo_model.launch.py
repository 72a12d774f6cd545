"""Start Gazebo Classic with a world and spawn the robot of this package."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Declare the arguments; start Gazebo, robot_state_publisher and the spawner."""
    share = FindPackageShare('gazebo_test')
    model = PathJoinSubstitution([share, 'model', 'robot.xacro'])
    world = PathJoinSubstitution([share, 'model', 'boxes.world'])

    arguments = [
        DeclareLaunchArgument(
            'world', default_value=world, description='World file (SDF) that Gazebo loads'),
        DeclareLaunchArgument(
            'x', default_value='0.0', description='Spawn position along x, in meters'),
        DeclareLaunchArgument(
            'y', default_value='0.0', description='Spawn position along y, in meters'),
        # The wheels touch the ground at z = 0; the robot is spawned 1 cm above it.
        DeclareLaunchArgument(
            'z', default_value='0.01',
            description='Spawn height of the robot above the ground, in meters'),
        DeclareLaunchArgument(
            'gui', default_value='true', description='Open the window of Gazebo: true or false'),
        DeclareLaunchArgument(
            'use_sim_time', default_value='true', description='Use the time of Gazebo'),
    ]

    gazebo = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(
            PathJoinSubstitution([FindPackageShare('gazebo_ros'), 'launch', 'gazebo.launch.py'])),
        launch_arguments={
            'world': LaunchConfiguration('world'),
            'gui': LaunchConfiguration('gui'),
        }.items(),
    )

    # The quotes keep a path with spaces together. Without ParameterValue, launch would parse the
    # text as YAML.
    robot_description = ParameterValue(Command(['xacro "', model, '"']), value_type=str)
    robot_state_publisher = Node(
        package='robot_state_publisher',
        executable='robot_state_publisher',
        output='screen',
        parameters=[{
            'robot_description': robot_description,
            'use_sim_time': LaunchConfiguration('use_sim_time'),
        }],
    )

    # Reads the robot from the topic of robot_state_publisher.
    spawn_robot = Node(
        package='gazebo_ros',
        executable='spawn_entity.py',
        output='screen',
        arguments=[
            '-topic', 'robot_description',
            '-entity', 'gazebo_test',
            '-x', LaunchConfiguration('x'),
            '-y', LaunchConfiguration('y'),
            '-z', LaunchConfiguration('z'),
        ],
    )

    # Drives the robot by the scans of its lidar; see scripts/wanderer.py.
    wanderer = Node(
        package='gazebo_test',
        executable='wanderer.py',
        name='wanderer',
        output='screen',
        parameters=[{
            'speed': 0.4,
            'use_sim_time': ParameterValue(LaunchConfiguration('use_sim_time'), value_type=bool),
        }],
    )

    return LaunchDescription([
        *arguments,
        gazebo,
        robot_state_publisher,
        spawn_robot,
        wanderer,
    ])

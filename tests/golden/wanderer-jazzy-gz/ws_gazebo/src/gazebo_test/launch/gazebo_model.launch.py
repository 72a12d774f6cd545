"""Start Gazebo Sim with a world and spawn the robot of this package."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition, UnlessCondition
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
            'headless', default_value='false',
            description='Run Gazebo without a window: true or false'),
        DeclareLaunchArgument(
            'use_sim_time', default_value='true', description='Use the time of Gazebo'),
    ]

    # `headless` chooses between two ways to start Gazebo. It takes its options as one string; the
    # quotes keep a path with spaces together.
    gz_sim = PythonLaunchDescriptionSource(
        PathJoinSubstitution([FindPackageShare('ros_gz_sim'), 'launch', 'gz_sim.launch.py']))
    gazebo = IncludeLaunchDescription(
        gz_sim,
        launch_arguments={
            'gz_args': ['-r -v 4 "', LaunchConfiguration('world'), '"'],
            'on_exit_shutdown': 'true',
        }.items(),
        condition=UnlessCondition(LaunchConfiguration('headless')),
    )
    gazebo_headless = IncludeLaunchDescription(
        gz_sim,
        launch_arguments={
            'gz_args': ['-r -s -v 4 "', LaunchConfiguration('world'), '"'],
            'on_exit_shutdown': 'true',
        }.items(),
        condition=IfCondition(LaunchConfiguration('headless')),
    )

    # Bridges the topics of the file between Gazebo and ROS.
    bridge_file = PathJoinSubstitution([share, 'config', 'bridge.yaml'])
    bridge = Node(
        package='ros_gz_bridge',
        executable='parameter_bridge',
        output='screen',
        parameters=[{'config_file': ParameterValue(bridge_file, value_type=str)}],
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
        package='ros_gz_sim',
        executable='create',
        output='screen',
        arguments=[
            '-topic', 'robot_description',
            '-name', 'gazebo_test',
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
        gazebo_headless,
        bridge,
        robot_state_publisher,
        spawn_robot,
        wanderer,
    ])

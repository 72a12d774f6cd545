import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import ExecuteProcess, TimerAction
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('shell_cart')
    urdf = os.path.join(share, 'urdf', 'cart.urdf')
    world = os.path.join(share, 'worlds', 'lane.world')
    with open(urdf) as file:
        description = file.read()
    quoted = description.replace('"', '\\"')
    request = '{name: "cart", xml: "' + quoted + '", initial_pose: {position: {z: 0.16}}}'

    return LaunchDescription([
        ExecuteProcess(
            cmd=['gazebo --verbose', world, '-s libgazebo_ros_init.so -s libgazebo_ros_factory.so'],
            shell=True,
        ),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': description}]),
        TimerAction(period=5.0, actions=[
            ExecuteProcess(cmd=['ros2', 'service', 'call', '/spawn_entity',
                                'gazebo_msgs/srv/SpawnEntity', request]),
        ]),
    ])

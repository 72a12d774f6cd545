import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import ExecuteProcess, Shutdown, TimerAction


def generate_launch_description():
    share = get_package_share_directory('shell_cart')
    urdf = os.path.join(share, 'urdf', 'cart.urdf')
    world = os.path.join(share, 'worlds', 'lane.world')
    return LaunchDescription([
        ExecuteProcess(
            cmd=['ruby $(which ign) gazebo -r', world], shell=True, on_exit=Shutdown()
        ),
        TimerAction(period=4.0, actions=[
            ExecuteProcess(
                cmd=['bash', '-c', f'ros2 run ros_gz_sim create -file {urdf} -name cart -z 0.16'],
            ),
        ]),
    ])

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def ask(question, answers):
    print(question)
    for number, answer in enumerate(answers, start=1):
        print('  (' + str(number) + ') ' + answer)
    while True:
        given = input('  Please select: ')
        if given in [str(number) for number in range(1, len(answers) + 1)]:
            return int(given)
        print('Please try again.')


def generate_launch_description():
    share = get_package_share_directory('choosy_arm')
    arm = ask('Which arm?', ['the small one', 'the large one'])
    gripper = ask('Has it got a gripper?', ['yes', 'no'])
    name = 'arm' + str(arm) + ('_gripper' if gripper == 1 else '')
    with open(os.path.join(share, 'urdf', 'arm' + str(arm) + '.urdf')) as file:
        robot = file.read()
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(
                get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')),
            launch_arguments={'gz_args': '-r empty.sdf'}.items()),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': robot}]),
        Node(package='ros_gz_sim', executable='create',
             arguments=['-topic', 'robot_description', '-name', name]),
    ])

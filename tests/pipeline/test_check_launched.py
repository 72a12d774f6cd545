"""Launch files are checked with what they start: worlds, robots, bridges, controllers, frames."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from pathlib import Path

DEPENDENCIES = (
    "controller_manager",
    "gz_ros2_control",
    "robot_state_publisher",
    "ros_gz_bridge",
    "ros_gz_sim",
    "rviz2",
    "xacro",
)
MANIFEST = f"""\
<package format="3">
  <name>cart</name>
  <version>0.0.1</version>
  <description>A cart.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  {"".join(f"<exec_depend>{name}</exec_depend>" for name in DEPENDENCIES)}
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(cart NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf worlds config DESTINATION share/cart)
ament_package()
"""
LAUNCH = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory('cart')
    world = os.path.join(share, 'worlds', 'office.sdf')
    path = os.path.join(share, 'urdf', 'cart.urdf.xacro')
    text = ParameterValue(Command(['xacro ', path]), value_type=str)
    gazebo = os.path.join(
        get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(gazebo),
            launch_arguments={'gz_args': ['-r ', world]}.items()),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': text, 'use_sim_time': True}]),
        Node(package='ros_gz_sim', executable='create',
             arguments=['-world', 'office', '-topic', 'robot_description', '-name', 'cart',
                        '-z', '0.1']),
        Node(package='ros_gz_bridge', executable='parameter_bridge',
             arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock'],
             parameters=[{'config_file': os.path.join(share, 'config', 'bridge.yaml')}]),
        Node(package='controller_manager', executable='spawner', arguments=['broadcaster']),
        Node(package='rviz2', executable='rviz2',
             arguments=['-d', os.path.join(share, 'config', 'cart.rviz')]),
    ])
"""
URDF = """\
<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base_link">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.2" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual name="v"><geometry><box size="1 1 0.2"/></geometry></visual>
    <collision name="c"><geometry><box size="1 1 0.2"/></geometry></collision>
  </link>
  <gazebo>
    <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
      <parameters>$(find cart)/config/controllers.yaml</parameters>
    </plugin>
  </gazebo>
  <gazebo reference="base_link">
    <sensor name="lidar" type="gpu_lidar"><topic>scan</topic></sensor>
  </gazebo>
</robot>
"""
USER_COMMANDS = (
    '<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>'
)
WORLD = f"""\
<sdf version="1.8">
  <world name="office">
    <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>
    {USER_COMMANDS}
    <plugin filename="gz-sim-scene-broadcaster-system"
      name="gz::sim::systems::SceneBroadcaster"/>
    <light name="sun" type="directional"/>
    <model name="ground">
      <static>true</static>
      <link name="link">
        <collision name="c">
          <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
        </collision>
      </link>
    </model>
  </world>
</sdf>
"""
BRIDGE = """\
- ros_topic_name: /scan
  gz_topic_name: /scan
  ros_type_name: sensor_msgs/msg/LaserScan
  gz_type_name: gz.msgs.LaserScan
  direction: GZ_TO_ROS
"""
CONTROLLERS = """\
controller_manager:
  ros__parameters:
    broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
"""
RVIZ = "Visualization Manager:\n  Global Options:\n    Fixed Frame: base_link\n"
FILES = {
    "package.xml": MANIFEST,
    "CMakeLists.txt": CMAKE,
    "launch/cart.launch.py": LAUNCH,
    "urdf/cart.urdf.xacro": URDF,
    "worlds/office.sdf": WORLD,
    "config/bridge.yaml": BRIDGE,
    "config/controllers.yaml": CONTROLLERS,
    "config/cart.rviz": RVIZ,
}
# Rules about the robot and its packages, which are not meant here.
ELSEWHERE = ("ROB", "PKG", "BLD")


def reported(
    folder: Path, changes: dict[str, tuple[str, str]]
) -> list[tuple[str, str, int | None]]:
    package = folder / "src" / "cart"
    for name, text in FILES.items():
        old, new = changes.get(name, ("", ""))
        assert old in text
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace(old, new) if old else text, encoding="utf-8")
    environment = {"PATH": os.environ["PATH"], "ROS_DISTRO": "jazzy"}
    outcome = check(CheckRequest(paths=[package]), environment=environment)
    return [
        (one.name, "" if one.file is None else one.file.relative_to(package).as_posix(), one.line)
        for one in outcome.diagnostics
        if not one.code.startswith(ELSEWHERE)
    ]


@pytest.mark.slow
def test_what_is_right_is_silent(tmp_path: Path) -> None:
    assert reported(tmp_path, {}) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "change", "expected"),
    [
        (
            "worlds/office.sdf",
            ('name="office"', 'name="default"'),
            ("other-world-name", "launch/cart.launch.py", 24),
        ),
        (
            "worlds/office.sdf",
            (USER_COMMANDS, ""),
            ("missing-system-plugin", "worlds/office.sdf", 3),
        ),
        (
            "launch/cart.launch.py",
            (
                "package='ros_gz_sim', executable='create'",
                "package='gazebo_ros', executable='spawn_entity.py'",
            ),
            ("spawner-of-other-simulator", "launch/cart.launch.py", 24),
        ),
        (
            "launch/cart.launch.py",
            (
                "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock",
                "/a@std_msgs/msg/Bool[gz.msgs.Boolean",
            ),
            ("no-clock-bridge", "launch/cart.launch.py", 22),
        ),
        (
            "config/bridge.yaml",
            ("gz_topic_name: /scan", "gz_topic_name: /scn"),
            ("unknown-bridge-topic", "config/bridge.yaml", 1),
        ),
        (
            "config/controllers.yaml",
            ("    broadcaster:", "    joints:"),
            ("unknown-controller", "launch/cart.launch.py", 30),
        ),
        (
            "config/controllers.yaml",
            ("JointStateBroadcaster", "JointStatesBroadcaster"),
            ("unknown-controller-type", "config/controllers.yaml", 4),
        ),
        (
            "launch/cart.launch.py",
            ("cart.rviz", "robot.rviz"),
            ("missing-argument-file", "launch/cart.launch.py", 31),
        ),
        (
            "config/cart.rviz",
            ("base_link", "base_lnk"),
            ("unpublished-frame", "config/cart.rviz", 3),
        ),
        (
            "launch/cart.launch.py",
            ("'0.1'", "'0.0'"),
            ("spawned-in-ground", "launch/cart.launch.py", 24),
        ),
        (
            "launch/cart.launch.py",
            ("'-r '", "'-r'"),
            ("glued-arguments", "launch/cart.launch.py", 21),
        ),
    ],
)
def test_what_does_not_fit_is_reported(
    tmp_path: Path, file: str, change: tuple[str, str], expected: tuple[str, str, int]
) -> None:
    assert expected in reported(tmp_path, {file: change})

"""A sound package for Gazebo Sim on Jazzy, and what is reported when one text of it changes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.pipeline.check import CheckOutcome

DEPENDENCIES = (
    "controller_manager",
    "gz_ros2_control",
    "joint_state_broadcaster",
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
    <sensor name="lidar" type="gpu_lidar">
      <topic>scan</topic>
      <gz_frame_id>base_link</gz_frame_id>
    </sensor>
  </gazebo>
  <link name="lift">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.02" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual name="v"><geometry><box size="0.4 0.4 0.1"/></geometry></visual>
    <collision name="c"><geometry><box size="0.4 0.4 0.1"/></geometry></collision>
  </link>
  <joint name="lift_joint" type="prismatic">
    <parent link="base_link"/>
    <child link="lift"/>
    <origin xyz="0 0 0.2"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.3" effort="50" velocity="0.5"/>
  </joint>
  <ros2_control name="cart" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="lift_joint">
      <command_interface name="position"/>
      <state_interface name="position"/>
    </joint>
  </ros2_control>
</robot>
"""
USER_COMMANDS = (
    '<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>'
)
SENSORS = '<plugin filename="gz-sim-sensors-system" name="gz::sim::systems::Sensors"/>'
WORLD = f"""\
<sdf version="1.8">
  <world name="office">
    <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>
    {USER_COMMANDS}
    <plugin filename="gz-sim-scene-broadcaster-system"
      name="gz::sim::systems::SceneBroadcaster"/>
    {SENSORS}
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


def check_cart(
    folder: Path, changes: Mapping[str, tuple[str, str]], *, distro: str = "jazzy"
) -> tuple[Path, CheckOutcome]:
    """Write the package, with a text of each of some files replaced by another, and check it."""
    package = folder / "src" / "cart"
    for name, text in FILES.items():
        old, new = changes.get(name, ("", ""))
        assert old in text
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace(old, new) if old else text, encoding="utf-8")
    environment = {"PATH": os.environ["PATH"], "ROS_DISTRO": distro}
    return package, check(CheckRequest(paths=[package]), environment=environment)

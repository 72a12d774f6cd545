"""A workspace of which a page shows everything: what stands, falls, breaks, and is left out."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from forks import run_wsgen

if TYPE_CHECKING:
    import subprocess

MANIFEST = """\
<package format="3"><name>{name}</name><version>0.0.1</version><description>Of a test.</description>
<maintainer email="ada@example.org">Ada</maintainer><license>Apache-2.0</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<export><build_type>ament_cmake</build_type></export></package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project({name} NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf DESTINATION share/{name})
ament_package()
"""
# What a launch file may say: nothing of it may become markup.
HOSTILE = (
    "</script><script>alert(1)</script><img src=x onerror=alert(1)> \"quotes' & \\u202e\\x07 ü 漢"
)
LAUNCH = f"""\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('{{name}}')
    gazebo = os.path.join(get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')
    return LaunchDescription([
        DeclareLaunchArgument(
            'note', default_value=\"\"\"{HOSTILE}\"\"\", description='<b>bold</b>'),
        IncludeLaunchDescription(PythonLaunchDescriptionSource(gazebo)),
        ExecuteProcess(cmd=['echo', '</script><!--']),
        Node(package='gazebo_ros', executable='spawn_entity.py',
             arguments=['-entity', '{{name}}', '-z', '0.3',
                        '-file', os.path.join(share, 'urdf', 'robot.urdf')]),
    ])
"""
LINK = """<link name="{name}"><inertial><mass value="{mass}"/>
<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
<visual><geometry><box size="{size}"/></geometry>
<material name="{color}"><color rgba="{color}"/></material></visual>
<collision><geometry><box size="{size}"/></geometry></collision></link>
"""
JOINT = """<joint name="{name}" type="fixed"><parent link="base"/><child link="{child}"/>
<origin xyz="{xyz}"/></joint>
"""
EVIL = "&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;"


def top_heavy(arm: str = "arm") -> str:
    """A box whose arm pulls it over."""
    return (
        '<robot name="crane">\n'
        + LINK.format(name="base", mass=1, size="0.2 0.2 0.6", color="0.9 0.6 0.1 1")
        + LINK.format(name=arm, mass=6, size="0.8 0.1 0.1", color="0.2 0.4 0.8 1")
        + JOINT.format(name=f"base_to_{arm}", child=arm, xyz="0.5 0 0.35")
        + "</robot>\n"
    )


SWING = """<robot name="swing"><link name="world"/>
<joint name="hinge" type="continuous"><parent link="world"/><child link="arm"/>
<origin xyz="0 0 1" rpy="0.4 0 0"/><axis xyz="1 0 0"/></joint>
<link name="arm"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.001"/></inertial>
<visual><origin xyz="0 0 -0.3"/><geometry><cylinder radius="0.03" length="0.6"/></geometry></visual>
</link></robot>
"""
WORLD = """<sdf version="1.7"><world name="office"><include><uri>model://ground_plane</uri></include>
<model name="table"><static>true</static><link name="top"><pose>0 0 0.4 0 0 0</pose>
<collision name="c"><geometry><box><size>1 1 0.05</size></box></geometry></collision>
<visual name="v"><geometry><box><size>1 1 0.05</size></box></geometry></visual></link></model>
<model name="ball"><pose>0 0 1 0 0 0</pose><link name="ball">
<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
<visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry></visual></link></model>
</world></sdf>
"""


def wsgen(folder: Path, *arguments: str | bytes) -> subprocess.CompletedProcess[str]:
    return run_wsgen(arguments, cwd=folder, errors="replace")


def write_package(sources: Path, name: str, robot: str, launch: str) -> None:
    folder = sources / name
    for part in ("launch", "urdf"):
        (folder / part).mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(name=name))
    (folder / "CMakeLists.txt").write_text(CMAKE.format(name=name))
    (folder / "launch" / "spawn.launch.py").write_text(launch, encoding="utf-8")
    (folder / "urdf" / "robot.urdf").write_text(robot)


def write_workspace(root: Path) -> list[str | bytes]:
    """Write it, and give what to name to `wsgen validate` there: packages and files."""
    sources = root / "src"
    sources.mkdir(parents=True)
    made = wsgen(
        root, "new", "rover", "--template", "diff_drive", "--maintainer-name", "A",
        "--maintainer-email", "a@b.cd", "-q",
    )  # fmt: skip
    assert made.returncode == 0, made.stderr
    write_package(sources, "crane", top_heavy(), LAUNCH.format(name="crane"))
    broken = LAUNCH.replace("share = ", "undefined_name\n    share = ").format(name="broken")
    write_package(sources, "broken", top_heavy(), broken)
    messages = sources / "messages"
    messages.mkdir()
    (messages / "package.xml").write_text(MANIFEST.format(name="messages"))
    (root / "office.world").write_text(WORLD)
    (root / "swing.urdf").write_text(SWING)
    odd = os.fsencode(root) + b"/caf\xe9 <b>.urdf"
    Path(os.fsdecode(odd)).write_text(top_heavy(EVIL))
    return ["rover", "crane", "broken", "messages", "office.world", "swing.urdf", odd]

"""Measure how `wsgen validate` finds the launch files that spawn robots in a large workspace.

    python -m benchmarks.launch_files [RUNS]

The workspace has ten robots, each with a description, a simulation and a bringup: 30 packages with
60 launch files, ten of which are chosen. CPU time as in `benchmarks`, from the start of Python on,
without the simulation of what is chosen.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from textwrap import dedent

from wsgen.packages.workspace.layout import Workspace
from wsgen.packages.workspace.overlay import source_overlay
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.selection import select_packages

WSGEN = str(Path(sys.executable).with_name("wsgen"))
ROBOTS = 10
SEGMENTS = 30  # links of a robot
LAUNCH_FILES = 60
BOUND = 10.0  # s of CPU time

LINK = """\
  <xacro:macro name="segment" params="number">
    <link name="segment_${number}">
      <visual><geometry><box size="0.1 0.1 ${height}"/></geometry></visual>
      <collision><geometry><box size="0.1 0.1 ${height}"/></geometry></collision>
      <inertial>
        <mass value="1"/>
        <inertia ixx="${height/12}" ixy="0" ixz="0" iyy="${height/12}" iyz="0" izz="${1/600}"/>
      </inertial>
    </link>
  </xacro:macro>
"""
LAUNCH = """\
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def include(package, name, **arguments):
    file = os.path.join(get_package_share_directory(package), 'launch', name)
    return IncludeLaunchDescription(
        PythonLaunchDescriptionSource(file), launch_arguments=arguments.items())


def generate_launch_description():
    return LaunchDescription([
"""


def main() -> None:
    """Write the workspace, build it, measure, and print a row of a table in Markdown."""
    if sys.argv[1:2] == ["--choose"]:
        choose(Path(sys.argv[2]))
        return
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory(prefix="wsgen-benchmark-") as scratch:
        root = Path(scratch, "ws")
        write_workspace(root)
        subprocess.run([WSGEN, "build", "-q"], cwd=root, check=True, capture_output=True)
        measured = [measure(root) for _ in range(runs + 1)][1:]  # the first warms the caches
    cpu, wall = (statistics.median(values) for values in zip(*measured, strict=True))
    print("| | CPU s | at most | wall-clock s |\n|---|---|---|---|")
    print(f"| {LAUNCH_FILES} launch files | {cpu:.1f} | {BOUND:g} | {wall:.1f} |")


def choose(root: Path) -> None:
    """What `wsgen validate` does before it simulates."""
    workspace = Workspace(root=root)
    overlay = source_overlay(workspace, os.environ)
    selection = select_packages(workspace, overlay, ValidateRequest(), None)
    chosen = [package.name for package in selection.packages]
    assert len(chosen) == ROBOTS, chosen  # noqa: S101  a benchmark of something else


def measure(root: Path) -> tuple[float, float]:
    """CPU time and wall-clock time of one choice, s."""
    before = time.perf_counter()
    command = [sys.executable, "-m", "benchmarks.launch_files", "--choose", str(root)]
    child = subprocess.Popen(command)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if status:
        sys.exit("The choice failed.")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - before


def write_workspace(root: Path) -> None:
    """Write 30 packages with 60 launch files, two in each package."""
    for number in range(ROBOTS):
        robot = f"robot_{number}"
        description, simulation, bringup = (
            write_package(root, f"{robot}_{kind}") for kind in ("description", "sim", "bringup")
        )
        joints = "".join(
            f'  <xacro:segment number="{one}"/>\n'
            + (
                f'  <joint name="joint_{one}" type="fixed"><parent link="segment_{one - 1}"/>'
                f'<child link="segment_{one}"/><origin xyz="0 0 ${{height}}"/></joint>\n'
                if one
                else ""
            )
            for one in range(SEGMENTS)
        )
        (description / "urdf").mkdir()
        (description / "urdf" / "robot.urdf.xacro").write_text(
            f'<robot name="{robot}" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
            f'  <xacro:property name="height" value="0.05"/>\n{LINK}{joints}</robot>\n'
        )
        share = f"get_package_share_directory('{robot}_description')"
        model = f"os.path.join({share}, 'urdf', 'robot.urdf.xacro')"
        publisher = (
            "Node(package='robot_state_publisher', executable='robot_state_publisher', parameters=["
            "{'robot_description': ParameterValue("
            f"Command(['xacro ', {model}]), value_type=str)}}])"
        )
        publish = f"include('{robot}_description', 'publish.launch.py')"
        gazebo = "include('gazebo_ros', 'gazebo.launch.py')"
        spawner = (
            "Node(package='gazebo_ros', executable='spawn_entity.py', arguments=["
            f"'-topic', 'robot_description', '-entity', '{robot}', '-z', LaunchConfiguration('z')])"
        )
        height = "DeclareLaunchArgument('z', default_value='0.05')"
        rviz = "Node(package='rviz2', executable='rviz2')"
        teleop = "Node(package='teleop_twist_keyboard', executable='teleop_twist_keyboard')"
        simulate = f"include('{robot}_sim', 'simulation.launch.py', z='0.1')"
        write_launch_file(description, "publish", publisher)
        write_launch_file(description, "display", publish, rviz)
        write_launch_file(simulation, "simulation", height, gazebo, publish, spawner)
        write_launch_file(simulation, "world", gazebo)
        write_launch_file(bringup, "robot", simulate, rviz)
        write_launch_file(bringup, "teleop", teleop)


def write_package(root: Path, name: str) -> Path:
    """Write a package without launch files; return its folder."""
    folder = root / "src" / name
    (folder / "launch").mkdir(parents=True)
    folders = "launch urdf" if name.endswith("description") else "launch"
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.20)\nproject({name} LANGUAGES NONE)\n"
        "find_package(ament_cmake REQUIRED)\n"
        f"install(DIRECTORY {folders} DESTINATION share/${{PROJECT_NAME}})\nament_package()\n"
    )
    manifest = f"""\
        <package format="3">
          <name>{name}</name><version>0.0.0</version><description>A robot</description>
          <maintainer email="a@example.org">A</maintainer><license>MIT</license>
          <buildtool_depend>ament_cmake</buildtool_depend>
          <export><build_type>ament_cmake</build_type></export>
        </package>
        """
    (folder / "package.xml").write_text(dedent(manifest))
    return folder


def write_launch_file(package: Path, name: str, *entities: str) -> None:
    """Write a launch file that starts these entities."""
    lines = "".join(f"        {entity},\n" for entity in entities)
    (package / "launch" / f"{name}.launch.py").write_text(f"{LAUNCH}{lines}    ])\n")


if __name__ == "__main__":
    main()

"""Fixes in whole packages: what `wsgen check` reports is gone after the fix, and nothing is new."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

import wsgen.cli
from wsgen.checks.fixes.plan import plan_fixes, write_fixes
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.reported import Filters, filter_outcome

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

PACKAGE = """<?xml version="1.0"?>
<package format="3">
  <name>my_robot</name>
  <version>0.1.0</version>
  <description>A robot.</description>
  <maintainer email="a@b.cd">A</maintainer>
  <license>MIT</license>

  <buildtool_depend>ament_cmake</buildtool_depend>

  <exec_depend>robot_state_publisher</exec_depend>
  <exec_depend>ros_gz_bridge</exec_depend>
  <exec_depend>ros_gz_sim</exec_depend>
  <exec_depend>xacro</exec_depend>  <!-- expands the robot -->
  <test_depend>ament_lint_auto</test_depend>

  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.8...3.31)
project(my_robot)

find_package(ament_cmake REQUIRED)

# What launch files look up.
install(
  DIRECTORY launch urdf worlds
  DESTINATION share/${PROJECT_NAME}
)

if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
endif()

ament_package()
"""
XACRO = """<?xml version="1.0"?>
<robot name="my_robot" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="1"/>
  <link name="base_link">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.17" ixy="0" ixz="0" iyy="0.17" iyz="0" izz="0.17"/>
    </inertial>
    <visual>
      <geometry><box size="1 1 $(arg length)"/></geometry>
    </visual>
    <collision>
      <geometry><box size="1 1 1"/></geometry>
    </collision>
  </link>
  <gazebo reference="base_link">
    <sensor name="imu" type="imu"><gz_frame_id>base_link</gz_frame_id></sensor>
  </gazebo>
</robot>
"""
WORLD = """<?xml version="1.0"?>
<sdf version="1.9">
  <world name="office">
    <physics name="default" type="ode">
      <max_step_size>0.001</max_step_size>
      <real_time_factor>1</real_time_factor>
      <real_time_update_rate>1000</real_time_update_rate>
    </physics>
    <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>
    <plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>
    <plugin filename="gz-sim-scene-broadcaster-system"
      name="gz::sim::systems::SceneBroadcaster"/>
    <plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/>
    <light name="sun" type="directional">
      <pose>0 0 10 0 0 0</pose>
      <direction>-0.5 0.1 -0.9</direction>
    </light>
    <model name="ground">
      <static>true</static>
      <link name="link">
        <collision name="collision">
          <geometry><plane><normal>0 0 1</normal><size>9 9</size></plane></geometry>
        </collision>
      </link>
    </model>
  </world>
</sdf>
"""
LAUNCH = """import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory('my_robot')
    robot = os.path.join(share, 'urdf', 'my_robot.xacro')
    world = os.path.join(share, 'worlds', 'office.sdf')
    gazebo = os.path.join(get_package_share_directory('ros_gz_sim'), 'launch')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(gazebo, 'gz_sim.launch.py')),
            launch_arguments={'gz_args': ['-r ', world]}.items(),
        ),
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            parameters=[{
                'robot_description': ParameterValue(
                    Command(['xacro ', robot, ' length:=1']), value_type=str
                ),
                'use_sim_time': True,  # as Gazebo counts
            }],
        ),
        Node(
            package='ros_gz_sim',
            executable='create',
            arguments=['-world', 'office', '-topic', 'robot_description', '-z', '0.505'],
        ),
        Node(
            package='ros_gz_bridge',
            executable='parameter_bridge',
            arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock'],
        ),
    ])
"""
SETTINGS = """[validate]
allow = ["massless-root"]  # of older robots
"""
FILES = {
    "package.xml": PACKAGE,
    "wsgen.toml": SETTINGS,
    "CMakeLists.txt": CMAKE,
    "urdf/my_robot.xacro": XACRO,
    "worlds/office.sdf": WORLD,
    "launch/spawn.launch.py": LAUNCH,
}
USER_COMMANDS = (
    '<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>'
)
IMU = '<plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/>'
WITHOUT_IMU = WORLD[WORLD.index("    <plugin") : WORLD.index(f"    {IMU}")]
LAUNCH_FILE = "launch/spawn.launch.py"

# The rule, the file, what is written there, and what takes its place: the mistake. The fix writes
# it back, or what is given as the fifth.
CASES: list[tuple[str, ...]] = [
    # package.xml
    ("undeclared-package", "package.xml", "  <exec_depend>ros_gz_sim</exec_depend>\n", ""),
    ("misspelled-dependency", "package.xml", "state_publisher<", "state_publiser<"),
    (
        "not-for-run-time",
        "package.xml",
        "<exec_depend>xacro</exec_depend>",
        "<build_depend>xacro</build_depend>",
        "<depend>xacro</depend>",
    ),
    (
        "duplicate-dependency",
        "package.xml",
        "  <!-- expands the robot -->\n",
        "  <!-- expands the robot -->\n  <exec_depend>xacro</exec_depend>\n",
    ),
    (
        "missing-buildtool-dependency",
        "package.xml",
        "  <buildtool_depend>ament_cmake</buildtool_depend>\n",
        "",
    ),
    (
        "undeclared-test-dependency",
        "package.xml",
        "  <test_depend>ament_lint_auto</test_depend>\n",
        "",
    ),
    (
        "missing-build-type",
        "package.xml",
        "\n    <build_type>ament_cmake</build_type>\n  ",
        "",
    ),
    ("invalid-manifest", "package.xml", "0.1.0", "0.1", "0.1.0"),
    # wsgen.toml
    ("unknown-rule-allowed", "wsgen.toml", '"massless-root"', '"masless-root"'),
    ("invalid-settings", "wsgen.toml", "[validate]", "[valdiate]"),
    # CMakeLists.txt
    ("missing-installed-path", "CMakeLists.txt", "launch urdf worlds", "launch urdf wrlds worlds"),
    ("missing-installed-path", "CMakeLists.txt", "launch urdf worlds", "launch urdf wolrds"),
    ("repeated-ament-package", "CMakeLists.txt", "# What", "ament_package()\n# What"),
    ("missing-ament-package", "CMakeLists.txt", "ament_package()\n", ""),
    ("old-cmake-minimum", "CMakeLists.txt", "3.8...3.31", "2.8.3"),
    (
        "missing-cmake-minimum",
        "CMakeLists.txt",
        "cmake_minimum_required(VERSION 3.8...3.31)\n",
        "",
    ),
    ("missing-project", "CMakeLists.txt", "\nproject(my_robot)", ""),
    ("different-names", "CMakeLists.txt", "project(my_robot)", "project(my_robots)"),
    ("unknown-command", "CMakeLists.txt", "ament_package()", "ament_pakage()"),
    ("missing-destination", "CMakeLists.txt", "\n  DESTINATION share/${PROJECT_NAME}", ""),
    ("misspelled-keyword", "CMakeLists.txt", "DESTINATION", "DESTNATION"),
    ("misspelled-keyword", "CMakeLists.txt", "REQUIRED", "REQURIED"),
    (
        "command-after-ament-package",
        "CMakeLists.txt",
        "ament_package()\n",
        "ament_package()\nament_export_dependencies(xacro)\n",
        "ament_export_dependencies(xacro)\nament_package()\n",
    ),
    (
        "registered-after-ament-package",
        "CMakeLists.txt",
        "ament_package()\n",
        "ament_package()\nregister_rviz_ogre_media_exports(DIRECTORIES worlds)\n",
        "register_rviz_ogre_media_exports(DIRECTORIES worlds)\nament_package()\n",
    ),
    (
        "folder-not-installed",
        "CMakeLists.txt",
        "launch urdf worlds",
        "launch urdf",
        "launch urdf worlds",
    ),
    (
        "folder-not-installed",
        "CMakeLists.txt",
        "launch urdf worlds",
        "launch worlds",
        "launch worlds urdf",
    ),
    # xacro
    ("xacro-fails", "urdf/my_robot.xacro", "</visual>", "</visaul>"),
    (
        "misspelled-element",
        "urdf/my_robot.xacro",
        '<collision>\n      <geometry><box size="1 1 1"/></geometry>\n    </collision>',
        '<colision>\n      <geometry><box size="1 1 1"/></geometry>\n    </colision>',
    ),
    ("misspelled-attribute", "urdf/my_robot.xacro", "<mass value", "<mass vlaue"),
    ("not-a-number", "urdf/my_robot.xacro", '"1 1 1"', '"1, 1, 1"'),
    ("unused-xacro-argument", LAUNCH_FILE, "length:=", "lenght:="),
    # worlds
    ("no-sdf-version", "worlds/office.sdf", '<sdf version="1.9">', "<sdf>", '<sdf version="1.6">'),
    (
        "missing-system-plugin",
        "worlds/office.sdf",
        f"    {USER_COMMANDS}\n",
        "",
    ),
    ("missing-sensor-system", "worlds/office.sdf", f"    {IMU}\n", ""),
    ("missing-sensor-system", "worlds/office.sdf", WITHOUT_IMU + f"    {IMU}\n", ""),
    # launch files
    ("spawned-in-ground", LAUNCH_FILE, ", '-z', '0.505'", ""),
    ("glued-command", LAUNCH_FILE, "['xacro ', robot", "['xacro', robot"),
    ("glued-arguments", LAUNCH_FILE, "['-r ', world]", "['-r', world]"),
    (
        "description-as-yaml",
        LAUNCH_FILE,
        (
            "ParameterValue(\n"
            "                    Command(['xacro ', robot, ' length:=1']), value_type=str\n"
            "                )"
        ),
        "Command(['xacro ', robot, ' length:=1'])",
        "ParameterValue(Command(['xacro ', robot, ' length:=1']), value_type=str)",
    ),
    (
        "wall-clock-beside-simulator",
        LAUNCH_FILE,
        "                'use_sim_time': True,  # as Gazebo counts\n",
        "",
        "                'use_sim_time': True,\n",
    ),
    ("old-keyword", LAUNCH_FILE, " executable='create'", " node_executable='create'"),
    ("invalid-keyword", LAUNCH_FILE, "arguments=['-world", "argumnets=['-world"),
    ("undefined-name", LAUNCH_FILE, "from launch_ros.actions import Node\n", ""),
    ("undefined-name", LAUNCH_FILE, "join(share, 'urdf'", "join(shrae, 'urdf'"),
    ("other-world-name", LAUNCH_FILE, "'-world', 'office'", "'-world', 'offices'"),
    ("executable-not-found", LAUNCH_FILE, "'create'", "'creat'"),
]


def write(folder: Path) -> None:
    for name, text in FILES.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def diagnostics(folder: Path) -> tuple[Diagnostic, ...]:
    environment = {"PATH": os.environ["PATH"], "ROS_DISTRO": "jazzy"}
    outcome = check(CheckRequest(paths=[folder]), environment=environment)
    return filter_outcome(outcome, Filters()).diagnostics


@pytest.mark.slow
def test_the_package_is_sound(tmp_path: Path) -> None:
    write(tmp_path / "my_robot")
    assert diagnostics(tmp_path / "my_robot") == ()


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=[f"{case[0]}-{case[1]}" for case in CASES])
def test_a_mistake_is_fixed(tmp_path: Path, case: tuple[str, ...]) -> None:
    name, changed, good, bad = case[:4]
    folder = tmp_path / "my_robot"
    write(folder)
    file, text = folder / changed, FILES[changed]
    assert good in text
    file.write_text(text.replace(good, bad, 1), encoding="utf-8")
    found = [one for one in diagnostics(folder) if one.name == name]
    assert found, [(one.code, one.name, one.message) for one in diagnostics(folder)]
    plan = plan_fixes(found, [folder])
    assert not plan.refused, plan.refused
    assert len([*write_fixes(plan)]) == 1
    left = diagnostics(folder)
    assert not left, [(one.code, one.name, one.message, one.hint) for one in left]
    if plan.files[0].file == file:
        fixed = case[4] if len(case) > 4 else good
        assert sorted(file.read_text().split()) == sorted(text.replace(good, fixed, 1).split())
    assert {path.name for path in folder.rglob("*") if path.is_file()} == {
        name.rpartition("/")[2] for name in FILES
    }


@pytest.mark.slow
def test_many_mistakes_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "my_robot"
    write(folder)
    apart = {"xacro-fails", "description-as-yaml", "glued-command", "undeclared-package"}
    texts = dict(FILES)
    for name, changed, good, bad, *_ in CASES:
        if name not in apart and texts[changed].count(good) == 1:
            texts[changed] = texts[changed].replace(good, bad)
    for name, text in texts.items():
        encoding = "utf-8" if name == "wsgen.toml" else "utf-8-sig"  # TOML has no such mark
        (folder / name).write_bytes(text.replace("\n", "\r\n").encode(encoding))
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    assert wsgen.cli.run(["check", str(folder), "-q"]) == 1
    assert wsgen.cli.run(["check", str(folder), "--fix", "--strict", "-v"]) == 0
    assert diagnostics(folder) == ()
    after = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    assert len(after) == len(FILES)
    for file, data in after.items():
        assert data.startswith(b"\xef\xbb\xbf") or file.name == "wsgen.toml"
        assert data.count(b"\n") == data.count(b"\r\n"), file
    assert wsgen.cli.run(["check", str(folder), "--fix", "-v"]) == 0
    assert after == {file: file.read_bytes() for file in after}

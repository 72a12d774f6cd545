"""Which packages the files of a package use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.model.build_facts import BuildFacts, InstalledFile
from wsgen.packages.workspace.package_uses import (
    CONTROLLER,
    DESCRIPTION,
    LAUNCH,
    NODE,
    PLUGIN,
    PackageUse,
    find_files,
    installed_places,
    is_for_code,
    read_uses,
    unmentioned,
)

if TYPE_CHECKING:
    from pathlib import Path

WORKSPACE = frozenset({"my_robot", "arm_tools", "arm"})
IMPORTS = """\
from ament_index_python.packages import get_package_share_directory
from launch.substitutions import Command, FindExecutable
from launch_ros.actions import Node
"""


def uses(folder: Path, name: str, text: str) -> dict[str, tuple[int, str]]:
    """By package, the line and kind of the first use in a file."""
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return {
        use.package: (use.line, use.kind)
        for use in read_uses(find_files(folder), workspace=WORKSPACE)
    }


@pytest.mark.parametrize(
    ("line", "packages"),
    [
        ("get_package_share_directory('slam_toolbox')", {"slam_toolbox"}),
        ("packages.get_package_share_directory('slam_toolbox')", {"slam_toolbox"}),
        ("FindPackageShare(package='slam_toolbox')", {"slam_toolbox"}),
        ("Node(package='rviz2', executable='rviz2')", {"rviz2"}),
        ("Node(package=PACKAGE, executable='x')", {"arm_tools"}),
        ("Node(package=name, executable='x')", set()),
        ("Node(package=LaunchConfiguration('package'), executable='x')", set()),
        ("ComposableNode(package='image_proc', plugin='x')", {"image_proc"}),
        ("MoveItConfigsBuilder('arm', package_name='arm_tools')", {"arm_tools"}),
        ("Command(['xacro ', path])", {"xacro"}),
        ("Command('xacro ' + path)", set()),
        ("Command([FindExecutable(name='xacro'), ' ', path])", {"xacro"}),
        ("Command(['xacrodile ', path])", set()),
        ("import xacro", {"xacro"}),
        ("import numpy, os, yaml", set()),
        ("# Node(package='rviz2')", set()),
        ("if os.environ['ROS_DISTRO'] == 'humble': Node(package='gazebo_ros')", set()),
        ("if use_rviz: Node(package='rviz2')", {"rviz2"}),
    ],
)
def test_launch_files_of_python(line: str, packages: set[str], tmp_path: Path) -> None:
    text = f"{IMPORTS}PACKAGE = 'arm_tools'\nfor name in NAMES: pass\n{line}\n"
    found = uses(tmp_path, "launch/robot.launch.py", text)
    assert found.keys() == packages
    assert set(found.values()) <= {(6, LAUNCH)}


def test_what_is_tried_is_not_needed(tmp_path: Path) -> None:
    text = f"{IMPORTS}try:\n    get_package_share_directory('a_b')\nexcept KeyError:\n    pass\n"
    assert uses(tmp_path, "launch/robot.launch.py", text) == {}


def test_launch_files_of_xml_and_yaml(tmp_path: Path) -> None:
    xml = (
        '<launch>\n<node pkg="rviz2" exec="rviz2"/>\n<!-- <node pkg="no" exec="x"/> -->\n'
        '<include file="$(find-pkg-share nav2_bringup)/launch/a.launch.py"/>\n'
        '<node pkg="$(var package)" exec="x"/>\n'
        '<param name="robot_description" value="$(command \'xacro a.xacro\')"/>\n</launch>'
    )
    assert uses(tmp_path / "a", "a.launch.xml", xml) == {
        "rviz2": (2, LAUNCH),
        "nav2_bringup": (4, LAUNCH),
        "xacro": (6, LAUNCH),
    }
    yaml = "launch:\n- node:\n    pkg: 'joy'\n    exec: joy_node\n"
    assert uses(tmp_path / "b", "b.launch.yaml", yaml) == {"joy": (3, LAUNCH)}


def test_robots_and_worlds(tmp_path: Path) -> None:
    text = (
        "<robot>\n<!-- $(find commented) -->\n"
        '<xacro:include filename="$(find arm_tools)/a.xacro"/>\n'
        '<mesh filename="package://ur_description/meshes/a.stl"/>\n'
        '<mesh filename="package://${name}/meshes/a.stl"/>\n</robot>'
    )
    assert uses(tmp_path, "urdf/robot.urdf.xacro", text) == {
        "arm_tools": (3, DESCRIPTION),
        "ur_description": (4, DESCRIPTION),
    }


@pytest.mark.parametrize(
    ("line", "package"),
    [
        ("import rclpy", "rclpy"),
        ("from geometry_msgs.msg import Twist", "geometry_msgs"),
        ("import arm_tools.kinematics", "arm_tools"),
        ("from tf2_ros import Buffer", "tf2_ros"),
        ("from moveit.planning import MoveItPy", "moveit_py"),
        ("import serial", None),
        ("import apriltag", None),
        ("import my_own_msgs", None),
        ("from . import geometry_msgs", None),
        ("from beside_msgs import words", None),
        ("from arm.geometry import Pose", None),
        ("try:\n    import rclpy\nexcept ImportError:\n    rclpy = None", None),
        ("if TYPE_CHECKING:\n    import rclpy", None),
    ],
)
def test_nodes(line: str, package: str | None, tmp_path: Path) -> None:
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm" / "beside_msgs.py").write_text("")
    found = uses(tmp_path, "arm/driver.py", f"import os\n{line}\n")
    assert found == ({package: (2, NODE)} if package else {})


@pytest.mark.parametrize(
    "name",
    [
        "test/test_node.py",
        "docs/conf.py",
        "setup.py",
        ".hidden/node.py",
        "build/node.py",
        "other/node.py",
        "ignored/node.py",
    ],
)
def test_what_nobody_runs(name: str, tmp_path: Path) -> None:
    for folder, marker in (("other", "package.xml"), ("ignored", "COLCON_IGNORE")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / marker).write_text("")
    assert uses(tmp_path, name, "import rclpy\n") == {}


@pytest.mark.parametrize("text", ["import rclpy\ndef (", "import \0", "\xff import rclpy"])
def test_what_cannot_be_read(text: str, tmp_path: Path) -> None:
    file = tmp_path / "node.py"
    file.write_bytes(text.encode("latin-1"))
    assert read_uses([file, tmp_path / "missing.py"], workspace=WORKSPACE) == ()


def test_only_what_is_installed_counts(tmp_path: Path) -> None:
    for name in ("launch/a.launch.py", "examples/b.launch.py"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(f"{IMPORTS}Node(package='rviz2')\n")
    file = tmp_path / "launch" / "a.launch.py"
    installed = InstalledFile(
        source=file,
        destination="share/my_robot/launch/a.launch.py",
        file=tmp_path / "CMakeLists.txt",
        line=3,
    )
    build = BuildFacts(build_file=tmp_path / "CMakeLists.txt", installed=(installed,))
    places = installed_places(build)
    found = read_uses(find_files(tmp_path), workspace=WORKSPACE, installed=places)
    assert found == (PackageUse("rviz2", file, 4, LAUNCH),)
    assert installed_places(None) is None
    assert installed_places(BuildFacts(build_file=file, is_whole=False)) is None


@pytest.mark.parametrize(
    ("line", "package"),
    [
        ('<plugin filename="libgazebo_ros_diff_drive.so" name="a"/>', "gazebo_plugins"),
        ('<plugin filename="libgazebo_ros_init.so" name="a"/>', "gazebo_ros"),
        ('<plugin filename="libgazebo_ros_control.so" name="a"/>', None),  # of ROS 1
        ('<plugin filename="libgazebo_ros_of_mine.so" name="a"/>', None),
        ('<plugin filename="libgazebo_ros2_control.so" name="a"/>', "gazebo_ros2_control"),
        ('<plugin filename="gz_ros2_control-system" name="a"/>', "gz_ros2_control"),
        ('<plugin filename="libgz_ros2_control-system.so" name="a"/>', "gz_ros2_control"),
        ("<plugin>ign_ros2_control/IgnitionSystem</plugin>", "ign_ros2_control"),
        ('<plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/>', None),
        ('<!-- <plugin filename="libgazebo_ros_diff_drive.so" name="a"/> -->', None),
    ],
)
def test_plugins_of_gazebo(line: str, package: str | None, tmp_path: Path) -> None:
    found = uses(tmp_path, "urdf/robot.urdf", f"<robot>\n{line}\n</robot>")
    assert found == ({package: (2, PLUGIN)} if package else {})


def test_controllers(tmp_path: Path) -> None:
    text = (
        "controller_manager:\n  ros__parameters:\n    a:\n"
        "      type: diff_drive_controller/DiffDriveController\n    b:\n"
        "      type: 'joint_state_broadcaster/JointStateBroadcaster'\n"
        "    # type: effort_controllers/JointGroupEffortController\n"
        "    c:\n      type: nav2_map_server/Other\n"
    )
    assert uses(tmp_path, "config/controllers.yaml", text) == {
        "diff_drive_controller": (4, CONTROLLER),
        "joint_state_broadcaster": (6, CONTROLLER),
    }


def test_what_no_file_mentions(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "node.cpp").write_text('#include "std_msgs/msg/string.hpp"')
    (tmp_path / "package.xml").write_text("<depend>nav_msgs</depend>")
    (tmp_path / "README.md").write_text("nav_msgs")
    assert unmentioned(tmp_path, {"std_msgs", "nav_msgs"}) == {"nav_msgs"}
    (tmp_path / "broken.py").write_bytes(b"\xff")
    assert unmentioned(tmp_path, {"std_msgs", "nav_msgs"}) == frozenset()


@pytest.mark.parametrize(
    ("package", "expected"),
    [
        ("std_msgs", True),
        ("rclpy", True),
        ("my_interfaces", True),
        ("action_msgs", False),
        ("my_hardware_interfaces", False),
        ("xacro", False),
    ],
)
def test_packages_for_code(package: str, expected: bool) -> None:
    assert is_for_code(package) is expected

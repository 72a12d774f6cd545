"""What packages of catkin become: manifests, build files, messages and configurations of RViz."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.model.target import choose_target
from wsgen.packages.workspace.manifest import read_manifest
from wsgen.packages.workspace.package_xml import check_package_xml
from wsgen.porting.existing.catkin import (
    port_build_file,
    port_files,
    port_interface,
    port_manifest,
    port_rviz,
)
from wsgen.porting.existing.launch_port import Source

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from wsgen.porting.ported import Unported


def source_of(folder: Path, files: Mapping[str, str] = {}, *, target: str = "jazzy") -> Source:
    """A package of catkin with these files."""
    for name, text in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return Source(folder, "my_robot", "my_robot", choose_target(target))


def notes(found: Iterable[Unported]) -> list[str]:
    """What is listed, with its lines."""
    return [f"{one.file.name}:{one.line}: {one.what}" for one in found]


CLASSIC_TARGET = choose_target("humble", "classic")
FORMAT_1 = """\
<package>
  <name>my_robot</name>
  <version>1.2.3</version>
  <!-- of the arm -->
  <description>An <b>arm</b></description>
  <maintainer email="ada@example.com">Ada</maintainer>
  <license>BSD</license>
  <url type="website">http://example.com</url>
  <author>Bob</author>
  <buildtool_depend>catkin</buildtool_depend>
  <build_depend>roslaunch</build_depend>
  <run_depend>rviz</run_depend>
  <run_depend>tf</run_depend>
  <run_depend>tf2_ros</run_depend>
  <run_depend>xacro</run_depend>
  <run_depend>nobody_knows</run_depend>
  <run_depend>python-yaml</run_depend>
  <export>
    <metapackage/>
    <nodelet plugin="${prefix}/nodelets.xml"/>
  </export>
</package>
"""
FORMAT_3 = """\
<package format="3">
  <name>my_robot</name>
  <version>1.2.3</version>
  <!-- of the arm -->
  <description>An <b>arm</b></description>
  <maintainer email="ada@example.com">Ada</maintainer>
  <license file="LICENSE">Apache-2.0</license>
  <url type="website">http://example.com</url>
  <author>Bob</author>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <build_depend>ros2launch</build_depend>
  <exec_depend>rviz2</exec_depend>
  <exec_depend>tf2_ros</exec_depend>
  <exec_depend>xacro</exec_depend>
  <exec_depend>python3-yaml</exec_depend>
  <exec_depend>launch_ros</exec_depend>
  <test_depend>ros2test</test_depend>
  <export>
    <gazebo_ros gazebo_model_path="${prefix}/.."/>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""


def test_a_manifest(tmp_path: Path) -> None:
    needs = [("exec_depend", "launch_ros"), ("exec_depend", "xacro"), ("test_depend", "ros2test")]
    ported = port_manifest(source_of(tmp_path, {"package.xml": FORMAT_1}), needs, "Apache-2.0")
    assert ported.text == FORMAT_3
    assert notes(ported.notes) == [
        "package.xml:16: The dependency `nobody_knows` is not released for ROS 2 Jazzy.",
        "package.xml:20: <nodelet> in <export> is read by ROS 1 alone.",
    ]
    file = tmp_path / "package.xml"
    file.write_text(ported.text)
    assert list(check_package_xml(file)) == []


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('<depend condition="$ROS_VERSION == 1">roscpp</depend>', ""),
        ("<depend>roscpp</depend>", "<depend>rclcpp</depend>"),
        ("<depend>gazebo_ros</depend>", "<depend>ros_gz_sim</depend>"),
        ("<build_depend>tf</build_depend>", "<build_depend>tf2_ros</build_depend>"),
        ("<depend>tf</depend>\n  <exec_depend>tf2_ros</exec_depend>", "<depend>tf2_ros</depend>"),
        ("<depend>message_generation</depend>", ""),
        ("<depend>effort_controllers</depend>", "<depend>effort_controllers</depend>"),
    ],
)
def test_dependencies(tmp_path: Path, before: str, after: str) -> None:
    text = '<package format="2">\n  <name>a</name>\n  {}\n</package>\n'
    ported = port_manifest(source_of(tmp_path, {"package.xml": text.format(before)})).text
    lines = [line.strip() for line in ported.splitlines()]
    assert [line for line in lines if "depend" in line and "buildtool" not in line] == (
        [after] if after else []
    )
    assert port_manifest(source_of(tmp_path, {"package.xml": ported})).text == ported


@pytest.mark.parametrize("text", ["", "<package", "<package/>", "<a></a>", "<package></package>"])
def test_what_is_no_manifest(tmp_path: Path, text: str) -> None:
    ported = port_manifest(source_of(tmp_path, {"package.xml": text}))
    assert "<package>" not in ported.text


CMAKE = """\
cmake_minimum_required(VERSION 2.8.3)
project(my_robot)
find_package(catkin REQUIRED COMPONENTS roscpp std_msgs message_generation)
add_message_files(FILES State.msg 1bad.msg)
add_service_files(FILES Get.srv)
generate_messages(DEPENDENCIES std_msgs geometry_msgs)
catkin_package(CATKIN_DEPENDS message_runtime)
add_executable(driver src/driver.cpp)
target_link_libraries(driver ${catkin_LIBRARIES})
catkin_install_python(PROGRAMS scripts/talk scripts/help DESTINATION lib)
install(DIRECTORY launch DESTINATION share)
catkin_add_gtest(test_it test/it.cpp)
"""
FILES = {
    "CMakeLists.txt": CMAKE,
    "package.xml": FORMAT_1,
    "README.md": "x",
    "robot.rviz": "Panels:\n  - Class: rviz/Displays\n",
    "msg/State.msg": "Header header\ntime at\nfloat64[] jointState # of all\nint8 low=1\n",
    "srv/Get.srv": "string name\n---\ngeometry_msgs/Pose pose\n",
    "launch/a.launch": "<launch/>",
    "urdf/r.urdf": "<robot/>",
    "src/driver.cpp": "int main() {}",
    "scripts/talk": "#!/usr/bin/env python\nimport rospy\n",
    "scripts/help": "#!/bin/sh\n",
    "test/it.cpp": "",
}
BASE = """\
cmake_minimum_required(VERSION 3.20)
# The package only installs files, so it needs no compiler. For C++ write LANGUAGES CXX.
project(my_robot LANGUAGES NONE)

find_package(ament_cmake REQUIRED)

install(
  DIRECTORY launch urdf
  DESTINATION share/${PROJECT_NAME}
)

ament_package()
"""
BUILD_FILE = """\
cmake_minimum_required(VERSION 3.20)
project(my_robot)

find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(builtin_interfaces REQUIRED)
find_package(geometry_msgs REQUIRED)
find_package(std_msgs REQUIRED)

install(
  DIRECTORY launch urdf
  DESTINATION share/${PROJECT_NAME}
)

rosidl_generate_interfaces(${PROJECT_NAME}
  "msg/State.msg"
  "srv/Get.srv"
  DEPENDENCIES builtin_interfaces geometry_msgs std_msgs
)

install(
  FILES robot.rviz
  DESTINATION share/${PROJECT_NAME}
)

install(
  PROGRAMS scripts/help
  DESTINATION lib/${PROJECT_NAME}
)

ament_package()
"""


def test_files_and_build_file(tmp_path: Path) -> None:
    source = source_of(tmp_path, FILES)
    ported = port_files(source)
    assert sorted(ported.files) == [
        *("launch/a.launch.py", "msg/State.msg", "robot.rviz", "scripts/help", "srv/Get.srv"),
        "urdf/r.urdf",
    ]
    assert ported.files["urdf/r.urdf"] == tmp_path / "urdf" / "r.urdf"
    assert ported.files["msg/State.msg"] == (
        "std_msgs/Header header\nbuiltin_interfaces/Time at\nfloat64[] joint_state # of all\n"
        "int8 LOW=1\n"
    )
    assert notes(ported.notes) == [
        "talk:1: The program is written for ROS 1 (scripts/talk:2).",
        "State.msg:3: ROS 2 does not take `jointState` as a name; it is `joint_state` now.",
        "State.msg:4: ROS 2 does not take `low` as a name; it is `LOW` now.",
        "CMakeLists.txt:4: `msg/1bad.msg` is not an interface of ROS 2, and is left out.",
        "CMakeLists.txt:8: `add_executable` compiles the program `driver`: that is left out.",
        "CMakeLists.txt:12: `catkin_add_gtest` adds a test of ROS 1, which is left out.",
    ]
    assert port_build_file(source, ported.files, BASE) == BUILD_FILE
    text = port_manifest(source).text
    assert "<member_of_group>rosidl_interface_packages</member_of_group>" in text
    (tmp_path / "package.xml").write_text(text)
    manifest = read_manifest(tmp_path / "package.xml")
    assert {"geometry_msgs", "std_msgs", "builtin_interfaces"} <= {
        one.name for one in getattr(manifest, "dependencies", ())
    }


def test_an_interface_stays(tmp_path: Path) -> None:
    text = 'std_msgs/Header header\nstring NAME="a # b"\n---\n# nothing\nuint8[3] a_b\n'
    assert port_interface(tmp_path, text).text == text


RVIZ = """\
Panels:
  - Class: rviz/Displays
Visualization Manager:
  Displays:
    - Class: rviz/RobotModel
      Robot Description: robot_description
    - Class: rviz/WrenchStamped
    - Class: "rviz/Image"
      Image Topic: /camera
    - Class: moveit_rviz_plugin/MotionPlanning
    - Class: nobody_knows/Thing
"""


def test_a_configuration_of_rviz(tmp_path: Path) -> None:
    file = tmp_path / "a.rviz"
    ported = port_rviz(file, RVIZ, source_of(tmp_path))
    assert ported.text == (
        RVIZ.replace("rviz/Displays", "rviz_common/Displays")
        .replace("rviz/RobotModel", "rviz_default_plugins/RobotModel")
        .replace("rviz/WrenchStamped", "rviz_default_plugins/Wrench")
        .replace("rviz/Image", "rviz_default_plugins/Image")
        .replace("Image Topic", "Topic")
        .replace("Robot Description", "Description Topic")
    )
    assert notes(ported.notes) == [
        "a.rviz:11: RViz shows `nobody_knows/Thing`, which ROS 2 Jazzy does not have."
    ]
    assert port_rviz(file, ported.text, source_of(tmp_path)).text == ported.text


def test_a_program_in_an_older_python_is_left_out(tmp_path: Path) -> None:
    old = "#!/usr/bin/env python\nimport sys\nprint 1\n"
    ported = port_files(source_of(tmp_path, {"scripts/gain": old, "scripts/gain.sh": "#!/bin/sh"}))
    assert [*ported.files] == ["scripts/gain.sh"]
    assert notes(ported.notes) == [
        "gain:1: The program is not written for Python 3 (scripts/gain:3)."
    ]


WORLD = """<sdf version="1.6"><world name="w"><include><uri>model://ground_plane</uri></include>
<model name="m"><link name="l"><visual name="v"><geometry><mesh><uri>{}</uri></mesh></geometry>
</visual></link></model><include><uri>model://camera</uri></include></world></sdf>"""
CAMERA = """<sdf version="1.6"><model name="camera"><link name="l">
<sensor name="s" type="camera"/></link></model></sdf>"""


@pytest.mark.parametrize("is_started", [True, False])
def test_worlds_are_ported(tmp_path: Path, is_started: bool) -> None:
    """One that cannot be loaded is left out if nothing starts it."""
    launch = "<launch><!-- lost.world --></launch>" if is_started else "<launch/>"
    found = {
        "worlds/a.world": WORLD.format("model://my_robot/meshes/a.dae"),
        "worlds/lost.world": WORLD.format("file:///nobody/has/this.dae"),
        "models/camera/model.sdf": CAMERA,
        "models/camera/model.config": "<model><sdf>model.sdf</sdf></model>",
        "launch/a.launch": launch,
    }
    source = source_of(tmp_path, found)._replace(systems=frozenset(["Imu"]))
    ported = port_files(source)
    text = ported.files["worlds/a.world"]
    assert isinstance(text, str)
    for system in ("physics", "sensors", "imu"):
        assert f'"gz-sim-{system}-system"' in text
    assert "model://ground_plane" not in text
    assert "model://my_robot/meshes/a.dae" in text
    assert ("worlds/lost.world" in ported.files) == is_started
    listed = [one for one in notes(ported.notes) if one.startswith("lost.world:1: ")]
    assert bool(listed) != is_started
    assert all("names /nobody/has/this.dae, which does not exist" in one for one in listed)
    classic = source_of(tmp_path, found, target="humble")._replace(target=CLASSIC_TARGET)
    assert port_files(classic).files["worlds/a.world"] == tmp_path / "worlds" / "a.world"


def test_paths_of_another_computer(tmp_path: Path) -> None:
    files = {
        "urdf/a.xacro": '<robot><xacro:include filename="/home/ada/ws/my_robot/urdf/b.xacro"/>'
        '<xacro:include filename="/home/ada/ws/my_robot/urdf/gone.xacro"/></robot>',
        "urdf/b.xacro": "<robot/>",
    }
    ported = port_files(source_of(tmp_path, files)._replace(name="new"))
    text = str(ported.files["urdf/a.xacro"])
    assert 'filename="$(find new)/urdf/b.xacro"' in text
    assert 'filename="/home/ada/ws/my_robot/urdf/gone.xacro"' in text


def test_plugins_of_what_is_kept_of_a_robot(tmp_path: Path) -> None:
    """What a launch file starts of the robot besides has plugins of Gazebo Sim, too."""
    files = {
        "urdf/r.urdf": "<robot name='r'/>",
        "xacro/more.xacro": '<robot><xacro:include filename="$(find my_robot)/urdf/r.urdf"/>'
        '<gazebo><plugin name="joints" filename="libgazebo_ros_control.so"/></gazebo>'
        '<gazebo reference="base"><sensor type="ray" name="laser"><ray/></sensor></gazebo></robot>',
        "launch/a.launch": "<launch><param name='robot_description'"
        " command='xacro $(find my_robot)/xacro/more.xacro'/></launch>",
    }
    ported = port_files(source_of(tmp_path, files)._replace(robot="urdf/r.urdf"))
    text = str(ported.files["xacro/more.xacro"])
    assert "libgazebo_ros_control.so" not in text
    assert 'type="gpu_lidar"' in text
    assert ported.systems == {"Sensors"}
    assert any("ros_control of ROS 1" in one.what for one in ported.notes)

"""What `wsgen check` reads, and which of it is reported."""

import os
from pathlib import Path

import pytest

from wsgen.diagnostics import Diagnostic
from wsgen.errors import NotFoundError, RequestError
from wsgen.pipeline.check import CheckOutcome, CheckRequest, check

MANIFEST = """\
<package format="3">
  <name>@PKG@</name>
  <version>0.0.1</version>
  <description>A cart.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>robot_state_publisher</exec_depend>
  <exec_depend>xacro</exec_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(@PKG@ NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf DESTINATION share/@PKG@)
ament_package()
"""
LAUNCH = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.substitutions import Command
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    path = os.path.join(get_package_share_directory('@PKG@'), 'urdf', 'cart.urdf')
    text = ParameterValue(Command(['xacro ', path]), value_type=str)
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': text}]),
    ])
"""
URDF = """\
<robot name="cart">
  <link name="base">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><geometry><box size="1 1 0.2"/></geometry></visual>
    <collision><geometry><box size="1 1 0.2"/></geometry></collision>
  </link>
</robot>
"""
FILES = {
    "package.xml": MANIFEST,
    "CMakeLists.txt": CMAKE,
    "launch/cart.launch.py": LAUNCH,
    "urdf/cart.urdf": URDF,
}


def write_package(workspace: Path, name: str = "cart", **changes: str) -> Path:
    """A sound package; `changes` are of texts, by a part of the path."""
    package = workspace / "src" / name
    for path, template in FILES.items():
        text = template
        for part, (old, new) in ((part, change.split(" -> ")) for part, change in changes.items()):
            if part in path:
                assert old in text
                text = text.replace(old, new)
        file = package / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace("@PKG@", name))
    return package


def run(*paths: Path, jobs: int = 1) -> CheckOutcome:
    environment = {k: v for k, v in os.environ.items() if k != "AMENT_PREFIX_PATH"}
    return check(CheckRequest(paths=paths, jobs=jobs), environment=environment)


def reported(outcome: CheckOutcome) -> list[tuple[str, str, int | None]]:
    return [(one.name, one.file.name if one.file else "", one.line) for one in outcome.diagnostics]


def test_a_sound_package(tmp_path: Path) -> None:
    outcome = run(write_package(tmp_path))
    assert outcome.diagnostics == ()
    assert outcome.packages == ("cart",)
    assert outcome.passed


def test_a_misspelled_target_is_refused(tmp_path: Path) -> None:
    request = CheckRequest(paths=[write_package(tmp_path)], distro="jazy")
    with pytest.raises(RequestError) as refused:
        check(request, environment={})
    assert "Did you mean `jazzy`?" in (refused.value.hint or "")


def test_the_description_may_come_from_a_launch_file_that_is_not_here(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    (package / "launch" / "spawn.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import IncludeLaunchDescription as Include\n"
        "from launch_ros.actions import Node\n"
        "from launch_ros.substitutions import FindPackageShare\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([\n"
        "        Include([FindPackageShare('ros_gz_sim'), '/launch/gz_sim.launch.py']),\n"
        "        Include([FindPackageShare('robot_state_publisher'), '/launch/x.launch.py']),\n"
        "        Node(package='ros_gz_sim', executable='create',\n"
        "             arguments=['-topic', 'other', '-name', 'cart']),\n"
        "    ])\n"
    )
    found = [one for one in run(package).diagnostics if one.name == "unpublished-description"]
    assert [one.severity.value for one in found] == ["info"]


def test_a_mistake_is_at_the_line_of_the_source(tmp_path: Path) -> None:
    package = write_package(tmp_path, urdf='<mass value="2"/> -> <mass value="-2"/>')
    outcome = run(tmp_path)
    assert reported(outcome) == [("negative-mass", "cart.urdf", 4)]
    assert outcome.diagnostics[0].file == package / "urdf" / "cart.urdf"
    assert not outcome.passed


def test_a_file_of_a_package_is_checked_with_it(tmp_path: Path) -> None:
    package = write_package(
        tmp_path, urdf='<mass value="2"/> -> <mass value="-2"/>', package="Apache -> "
    )
    assert reported(run(package / "urdf" / "cart.urdf")) == [("negative-mass", "cart.urdf", 4)]
    assert reported(run(package / "urdf")) == [("negative-mass", "cart.urdf", 4)]
    assert reported(run(package / "launch" / "cart.launch.py")) == []


def test_of_two_packages_one_is_meant(tmp_path: Path) -> None:
    write_package(tmp_path, "cart", urdf='<mass value="2"/> -> <mass value="-2"/>')
    other = write_package(tmp_path, "other", launch="'@PKG@' -> 'cart'")
    undeclared = ("undeclared-package", "cart.launch.py", 10)
    assert reported(run(other)) == [undeclared]
    assert reported(run(tmp_path, jobs=2)) == [("negative-mass", "cart.urdf", 4), undeclared]


def test_what_an_included_launch_file_is_given_is_not_missing(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    (package / "launch" / "inner.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import DeclareLaunchArgument\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([DeclareLaunchArgument('x')])\n"
    )
    outcome = run(package)
    assert [(one.name, one.severity.value) for one in outcome.diagnostics] == [
        ("argument-without-value", "info")
    ]
    (package / "launch" / "outer.launch.xml").write_text(
        '<launch><include file="$(find-pkg-share cart)/launch/inner.launch.py">'
        '<arg name="x" value="1"/></include></launch>'
    )
    assert run(package).diagnostics == ()


def test_files_without_a_package(tmp_path: Path) -> None:
    file = tmp_path / "robots" / "cart.urdf"
    file.parent.mkdir()
    file.write_text(URDF.replace('value="2"', 'value="x"'))
    for path in (file, file.parent):
        assert reported(run(path)) == [("not-a-number", "cart.urdf", 4)]
    assert run(file).files == (file,)


def test_an_install_space(tmp_path: Path) -> None:
    share = tmp_path / "install" / "cart" / "share"
    write_package(tmp_path, urdf='<mass value="2"/> -> <mass value="-2"/>')
    (share / "ament_index" / "resource_index" / "packages").mkdir(parents=True)
    (share / "ament_index" / "resource_index" / "packages" / "cart").touch()
    (tmp_path / "src" / "cart").rename(share / "cart")
    (tmp_path / "install" / ".colcon_install_layout").write_text("isolated")
    outcome = run(tmp_path / "install")
    assert outcome.packages == ("cart",)
    assert reported(outcome) == [("negative-mass", "cart.urdf", 4)]
    assert outcome.diagnostics[0].file == share / "cart" / "urdf" / "cart.urdf"


def test_what_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match="does not exist"):
        run(tmp_path / "nothing")
    with pytest.raises(NotFoundError, match="no ROS package"):
        run(tmp_path)


def test_a_folder_that_is_not_installed(tmp_path: Path) -> None:
    package = write_package(tmp_path, CMake="launch urdf DESTINATION -> launch DESTINATION")
    outcome = run(tmp_path)
    assert ("file-not-installed", "cart.launch.py", 11) in reported(outcome)
    (found,) = (one for one in outcome.diagnostics if one.name == "file-not-installed")
    assert found.file == package / "launch" / "cart.launch.py"
    assert "'share/cart/urdf/cart.urdf' does not exist" in found.message
    # Where the package is built, that is a path of the user's.
    for prefix in ("install", "install/cart"):  # merged or not
        (tmp_path / prefix / "share" / "cart").mkdir(parents=True)
        (found,) = (one for one in run(tmp_path).diagnostics if one.name == "file-not-installed")
        assert f"{tmp_path}/{prefix}/share/cart/urdf/cart.urdf" in found.message


@pytest.mark.parametrize(
    "text",
    [
        "install(CODE [[file(COPY urdf DESTINATION share/cart)]])",
        "install(DIRECTORY ${MORE} DESTINATION share/cart)",
        "if(SOMETHING)\n install(DIRECTORY urdf DESTINATION share/cart)\nendif()",
        (
            "configure_file(urdf/in cart.urdf)\n"
            "install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cart.urdf DESTINATION share/cart/urdf)"
        ),
    ],
)
def test_what_the_build_may_install_is_not_reported(tmp_path: Path, text: str) -> None:
    write_package(tmp_path, CMake="launch urdf DESTINATION -> launch DESTINATION")
    file = tmp_path / "src" / "cart" / "CMakeLists.txt"
    file.write_text(file.read_text().replace("ament_package()", f"{text}\nament_package()"))
    assert [one for one in reported(run(tmp_path)) if one[0] != "folder-not-installed"] == []


def test_programs_and_modules_of_a_package(tmp_path: Path) -> None:
    package = write_package(
        tmp_path,
        CMake="ament_package() -> install(PROGRAMS go.py DESTINATION lib/@PKG@)\n"
        "ament_python_install_package(cart_tools)\nament_package()",
        launch="return LaunchDescription([ -> from cart_tools.names import GO\n"
        "    return LaunchDescription([Node(package='@PKG@', executable=GO),",
    )
    (package / "go.py").write_text("#!/usr/bin/env python3\n")
    (package / "go.py").chmod(0o755)
    (package / "cart_tools").mkdir()
    (package / "cart_tools" / "__init__.py").touch()
    (package / "cart_tools" / "names.py").write_text("GO = 'go.py'\n")
    assert reported(run(tmp_path)) == []
    (package / "cart_tools" / "names.py").write_text("GO = 'gone.py'\n")
    assert [name for name, _, _ in reported(run(tmp_path))] == ["executable-not-found"]


def test_what_no_engine_simulates_is_an_information(tmp_path: Path) -> None:
    (tmp_path / "gears.sdf").write_text(
        '<sdf version="1.6"><model name="m">'
        '<link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="one" type="fixed"><parent>a</parent><child>b</child></joint>'
        '<joint name="two" type="fixed"><parent>b</parent><child>c</child></joint>'
        '<joint name="three" type="fixed"><parent>a</parent><child>c</child></joint>'
        "</model></sdf>"
    )
    outcome = run(tmp_path / "gears.sdf")
    assert {one.severity.value for one in outcome.diagnostics if one.name == "closed-chain"} == {
        "info"
    }


def test_a_file_that_another_program_writes_is_not_missing(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    (package / "launch" / "made.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "def generate_launch_description():\n"
        "    with open('/var/lib/somewhere/robot.yaml') as stream:\n"
        "        stream.read()\n"
        "    return LaunchDescription([])\n"
    )
    found = [one for one in run(package).diagnostics if one.name == "file-not-installed"]
    assert [(one.severity.value, one.line) for one in found] == [("warning", 3)]


def test_a_mistake_in_xacro_is_reported_once(tmp_path: Path) -> None:
    package = write_package(tmp_path, launch="cart.urdf -> cart.urdf.xacro")
    (package / "urdf" / "cart.urdf").rename(package / "urdf" / "cart.urdf.xacro")
    file = package / "urdf" / "cart.urdf.xacro"
    text = file.read_text().replace('name="cart"', 'name="cart" xmlns:xacro="http://ros.org/xacro"')
    file.write_text(text.replace('value="2"', 'value="${mass"'))
    assert [(name, line) for name, _, line in reported(run(package))] == [("xacro-fails", 4)]


@pytest.mark.slow
def test_launch_files_see_the_target_as_the_sourced_distribution(tmp_path: Path) -> None:
    share = "get_package_share_directory('ros_gz_sim') + '/launch/none.launch.py'"
    package = write_package(
        tmp_path,
        launch=f"    text = -> {' ' * 4}open({share})\n    text = ",
        xml="xacro< -> ros_gz_sim<",
    )
    environment = {"PATH": os.environ["PATH"]}
    for distro in ("jazzy", "kilted"):
        request = CheckRequest(paths=[package], distro=distro)
        found = check(request, environment=environment).diagnostics
        assert any(f"/opt/ros/{distro}/share/ros_gz_sim" in one.message for one in found), found


@pytest.mark.parametrize(
    ("text", "name", "hint"),
    [
        ('<launch>\n  <node pkg="a" type="b"/>\n</launch>\n', "ros-1-launch-file", "Rewrite it"),
        ('<launch>\n  <node pkg="a" exec="b"/>\n</launch>\n', "unusable-file", "a.launch.xml"),
        ("<robots/>", "unusable-file", "Give a URDF"),
    ],
)
def test_a_file_with_the_ending_of_ros_1(tmp_path: Path, text: str, name: str, hint: str) -> None:
    file = tmp_path / "a.launch"
    file.write_text(text)
    (found,) = check(CheckRequest(paths=[file]), environment={}).diagnostics
    assert found.name == name
    assert hint in (found.hint or "")


MODEL = """<sdf version="1.9"><model name="shelf">
  <link name="board"><inertial><mass>1</mass>
    <inertia><ixx>1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
</model></sdf>
"""
STORE = """<sdf version="1.9"><world name="store">
  <include><uri>model://shelf</uri><name>left</name></include>
  <include><uri>model://shelf</uri><name>right</name></include>
</world></sdf>
"""


def test_what_is_in_a_model_is_reported_once(tmp_path: Path) -> None:
    """The worlds that include it have it, too."""
    (tmp_path / "shelf").mkdir()
    (tmp_path / "shelf" / "model.sdf").write_text(MODEL)
    (tmp_path / "shelf" / "model.config").write_text(
        '<model><name>shelf</name><sdf version="1.9">model.sdf</sdf></model>'
    )
    (tmp_path / "store.world").write_text(STORE)
    found = [
        (one.file, one.message)
        for one in check_paths(tmp_path / "store.world", tmp_path / "shelf" / "model.sdf")
        if one.name == "impossible-inertia"
    ]
    assert [file for file, _ in found] == [tmp_path / "shelf" / "model.sdf"]
    assert "`board`" in found[0][1]


def check_paths(*paths: Path) -> tuple[Diagnostic, ...]:
    environment = {"PATH": os.environ["PATH"]}
    return check(CheckRequest(paths=paths), environment=environment).diagnostics


ATTACHED = """\
import os
from launch import LaunchDescription


def generate_launch_description():
    if not os.path.exists('/dev/ttyUSB_of_nobody'):
        raise RuntimeError('/dev/ttyUSB_of_nobody is missing')
    return LaunchDescription([])
"""


def test_a_device_that_is_not_attached_is_no_mistake(tmp_path: Path) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(ATTACHED)
    (found,) = check_paths(file)
    assert (found.name, found.severity.value) == ("launch-raises", "info")
    file.write_text(ATTACHED.replace("/dev/", "/no_dev/"))
    assert [one.severity.value for one in check_paths(file)] == ["error"]

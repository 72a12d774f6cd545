"""What `wsgen check` reads, and which of it is reported."""

import os
import shutil
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_mistake_is_at_the_line_of_the_source(tmp_path: Path) -> None:
    package = write_package(tmp_path, urdf='<mass value="2"/> -> <mass value="-2"/>')
    outcome = run(tmp_path)
    assert reported(outcome) == [("negative-mass", "cart.urdf", 4)]
    assert outcome.diagnostics[0].file == package / "urdf" / "cart.urdf"
    assert not outcome.passed


@pytest.mark.slow
def test_a_file_of_a_package_is_checked_with_it(tmp_path: Path) -> None:
    package = write_package(
        tmp_path, urdf='<mass value="2"/> -> <mass value="-2"/>', package="Apache -> "
    )
    assert reported(run(package / "urdf" / "cart.urdf")) == [("negative-mass", "cart.urdf", 4)]
    assert reported(run(package / "urdf")) == [("negative-mass", "cart.urdf", 4)]
    assert reported(run(package / "launch" / "cart.launch.py")) == []


@pytest.mark.slow
def test_of_two_packages_one_is_meant(tmp_path: Path) -> None:
    write_package(tmp_path, "cart", urdf='<mass value="2"/> -> <mass value="-2"/>')
    other = write_package(tmp_path, "other", launch="'@PKG@' -> 'cart'")
    undeclared = ("undeclared-package", "cart.launch.py", 10)
    assert reported(run(other)) == [undeclared]
    assert reported(run(tmp_path, jobs=2)) == [("negative-mass", "cart.urdf", 4), undeclared]


@pytest.mark.slow
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
    outer = package / "launch" / "outer.launch.xml"
    outer.write_text(
        '<launch><include file="$(find-pkg-share cart)/launch/inner.launch.py">'
        '<arg name="x" value="1"/></include></launch>'
    )
    assert run(package).diagnostics == ()
    (package / "launch" / "inner.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import OpaqueFunction\n"
        "from launch.substitutions import LaunchConfiguration\n"
        "def start(context):\n"
        "    return [] if LaunchConfiguration('x', default='').perform(context) else [{}['x']]\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([OpaqueFunction(function=start)])\n"
    )
    assert run(package).diagnostics == ()
    outer.unlink()
    assert only(package, "launch-raises") == [("launch-raises", "error")]


@pytest.mark.slow
@pytest.mark.parametrize(("argument", "severity"), [("speed", "info"), ("slow", "warning")])
def test_what_a_command_may_give_is_not_surely_missing(
    tmp_path: Path, argument: str, severity: str
) -> None:
    package = write_package(tmp_path)
    (package / "launch" / "inner.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import LogInfo\n"
        "from launch.substitutions import LaunchConfiguration\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([LogInfo(msg=LaunchConfiguration('speed'))])\n"
    )
    (package / "launch" / "outer.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess, RegisterEventHandler\n"
        "from launch.event_handlers import OnProcessExit\n"
        "def generate_launch_description():\n"
        "    run = ExecuteProcess(cmd=['ros2', 'launch', 'cart', 'inner.launch.py',\n"
        f"                              '{argument}:=1'])\n"
        "    first = ExecuteProcess(cmd=['sleep', '1'])\n"
        "    return LaunchDescription([first, RegisterEventHandler(OnProcessExit(\n"
        "        target_action=first, on_exit=lambda event, _: [run] if event.returncode else []\n"
        "    ))])\n"
    )
    (found,) = run(package).diagnostics
    assert found.name == "undefined-configuration"
    # It is started where the process fails, which is not evaluated.
    assert found.severity.value == severity


@pytest.mark.slow
def test_a_world_that_is_missing_is_an_error(tmp_path: Path) -> None:
    text = (
        "from launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([\n"
        "        ExecuteProcess(cmd=['gz', 'sim', '/no/such/w.sdf'])])\n"
    )
    package = write_package(tmp_path / "ws")
    for file in (tmp_path / "w.launch.py", package / "launch" / "w.launch.py"):
        file.write_text(text)
        missing = [one for one in run(file).diagnostics if one.name == "missing-world"]
        assert [(one.file, one.line) for one in missing] == [(file, 5)]


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


@pytest.mark.parametrize("marker", ["COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"])
@pytest.mark.parametrize("place", [".", "old", "old/demo"])
def test_packages_that_colcon_ignores_are_named(tmp_path: Path, marker: str, place: str) -> None:
    package = tmp_path / "old" / "demo"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package format='3'><name>demo</name><version>0.0.0</version></package>"
    )
    (tmp_path / place / marker).touch()
    with pytest.raises(NotFoundError, match=rf"old/demo, because .*{marker} exists") as found:
        check(CheckRequest(paths=(tmp_path,)), environment={})
    assert (
        found.value.hint == f"Remove {tmp_path / place / marker}, or give the package: wsgen "
        f"check {package}"
    )


@pytest.mark.parametrize("mark", ["install/.colcon_install_layout", "build/.built_by"])
def test_what_colcon_has_made_is_not_what_it_ignores(tmp_path: Path, mark: str) -> None:
    """It keeps itself from building it again by the same marker."""
    place = (tmp_path / mark).parent
    (place / "demo" / "share").mkdir(parents=True)
    for file in (tmp_path / mark, place / "COLCON_IGNORE", place / "demo" / "share/package.xml"):
        file.touch()
    with pytest.raises(NotFoundError, match="does not contain a ROS package") as found:
        check(CheckRequest(paths=(tmp_path,)), environment={})
    assert "ignores" not in f"{found.value.message}{found.value.hint}"


def test_what_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match="does not exist"):
        run(tmp_path / "nothing")
    with pytest.raises(NotFoundError, match="not contain a ROS package"):
        run(tmp_path)


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_mistake_in_xacro_is_reported_once(tmp_path: Path) -> None:
    package = write_package(tmp_path, launch="cart.urdf -> cart.urdf.xacro")
    (package / "urdf" / "cart.urdf").rename(package / "urdf" / "cart.urdf.xacro")
    file = package / "urdf" / "cart.urdf.xacro"
    text = file.read_text().replace('name="cart"', 'name="cart" xmlns:xacro="http://ros.org/xacro"')
    file.write_text(text.replace('value="2"', 'value="${mass"'))
    assert [(name, line) for name, _, line in reported(run(package))] == [("xacro-fails", 4)]


@pytest.mark.slow
def test_launch_files_see_the_target_as_the_sourced_distribution(tmp_path: Path) -> None:
    named = "'/none/' + __import__('os').environ['ROS_DISTRO']"
    package = write_package(tmp_path, launch=f"    text = -> {' ' * 4}open({named})\n    text = ")
    environment = {"PATH": os.environ["PATH"]}
    for distro in ("jazzy", "kilted"):
        request = CheckRequest(paths=[package], distro=distro)
        found = check(request, environment=environment).diagnostics
        assert any(f"/none/{distro}" in one.message for one in found), found


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


@pytest.mark.slow
def test_a_device_that_is_not_attached_is_no_mistake(tmp_path: Path) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(ATTACHED)
    (found,) = check_paths(file)
    assert (found.name, found.severity.value) == ("launch-raises", "info")
    file.write_text(ATTACHED.replace("/dev/", "/no_dev/"))
    assert [one.severity.value for one in check_paths(file)] == ["error"]


def severities(outcome: CheckOutcome) -> list[tuple[str, str]]:
    return [(one.name, one.severity.value) for one in outcome.diagnostics]


def only(path: Path, *rules: str) -> list[tuple[str, str]]:
    return [found for found in severities(run(path)) if found[0] in rules]


@pytest.mark.slow
def test_modules_that_others_install(tmp_path: Path) -> None:
    launch = {"launch": "import os\n -> import os\nimport rs_camera_launch\n"}
    package = write_package(tmp_path, **launch)
    assert only(package, "launch-import") == [("launch-import", "info")]
    (package / "launch" / "rs_camera_launch.py").write_text("")  # which Python does not find there
    assert only(package, "launch-import") == [("launch-import", "error")]
    other = write_package(tmp_path / "b", launch="import os\n -> import os\nimport lanuch\n")
    assert only(other, "launch-import") == [("launch-import", "error")]
    capital = write_package(tmp_path / "c", launch="from launch import -> from Launch import")
    assert only(capital, "launch-import") == [("launch-import", "error")]
    imports = "import os\n -> import os\nfrom xmacro.urdf import Robot\n"  # which is no xacro
    other = write_package(tmp_path / "c", launch=imports)
    assert only(other, "launch-import") == [("launch-import", "info")]
    other = write_package(tmp_path / "d", launch=imports.replace("xmacro.urdf", "lanuch.actions"))
    assert only(other, "launch-import") == [("launch-import", "error")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "severity"),
    [
        ("launch_ros.actions import Node -> launch_ros.action import Node", "error"),
        ("launch.substitutions import -> launch.substitution import", "error"),
        ("import Command -> import Comand", "error"),
        ("launch import LaunchDescription -> launch import launchDescription", "error"),
        ("ament_index_python.packages -> ament_index_python.package", "error"),
        ("import Command -> import Command, OfAnotherDistribution", "info"),
        ("from launch_ros.actions -> from launch.actions", "error"),
        ("from launch_ros.actions -> from launch.some_substitutions_type", "info"),
    ],
)
def test_names_of_the_launch_api_that_are_misspelled(
    tmp_path: Path, change: str, severity: str
) -> None:
    package = write_package(tmp_path, launch=change)
    assert only(package, "unsupported-launch-api") == [("unsupported-launch-api", severity)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "severity"), [("crat", "error"), ("customer_arm", "warning")])
def test_the_package_of_a_mesh_that_is_misspelled(tmp_path: Path, name: str, severity: str) -> None:
    box, mesh = '<box size="1 1 0.2"/>', f'<mesh filename="package://{name}/meshes/a.stl"/>'
    package = write_package(tmp_path, **{"cart.urdf": f"{box} -> {mesh}"})
    outcome = run(package)
    assert severities(outcome) == [
        ("missing-collision-mesh", severity),
        ("missing-visual-mesh", "warning"),
    ]
    asks = [(one.hint or "").startswith("Did you mean `cart`?") for one in outcome.diagnostics]
    assert asks == [severity == "error"] * 2


EMPTY_ARGUMENT = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    text = ParameterValue(Command(['xacro ', @FILE@]), value_type=str)
    return LaunchDescription([
        DeclareLaunchArgument('file', default_value='@DEFAULT@'),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': text}]),
    ])
"""


@pytest.mark.slow
def test_what_is_refused_because_an_argument_is_empty(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    file = package / "launch" / "cart.launch.py"
    for name, default, severity in (
        ("LaunchConfiguration('file')", "", "info"),
        ("''", "some.urdf", "error"),
    ):
        file.write_text(EMPTY_ARGUMENT.replace("@FILE@", name).replace("@DEFAULT@", default))
        assert only(package, "refused-by-launch") == [("refused-by-launch", severity)]


XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="{}">\n{}\n</robot>\n'


@pytest.mark.slow
def test_a_xacro_file_whose_arguments_somebody_gives(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    include = '<xacro:include filename="$(find cart)/urdf/$(arg model)_arm.xacro"/>'
    for default, severity in (("", "info"), ("long", "error")):
        argument = f'<xacro:arg name="model" default="{default}"/>'
        (package / "urdf" / "any.urdf.xacro").write_text(XACRO.format("any", argument + include))
        assert only(package, "xacro-file-fails") == [("xacro-file-fails", severity)]


@pytest.mark.slow
def test_a_part_of_a_robot_names_links_of_the_file_that_includes_it(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    joint = (
        '<link name="{0}"/>\n<joint name="{0}_joint" type="fixed">\n'
        '  <parent link="{1}"/><child link="{0}"/>\n</joint>'
    )
    part = package / "urdf" / "tool.xacro"
    part.write_text(XACRO.format("tool", joint.format("tool", "wrist")))
    assert only(package, "unknown-link") == [("unknown-link", "info")]
    arm = URDF.partition("\n")[2].rpartition("</robot>")[0] + joint.format("wrist", "base")
    (package / "urdf" / "arm.xacro").write_text(XACRO.format("arm", arm))
    assert only(package, "unknown-link") == [("unknown-link", "info")]
    including = [f'<xacro:include filename="{name}.xacro"/>' for name in ("arm", "tool")]
    whole = package / "urdf" / "all.xacro"
    whole.write_text(XACRO.format("all", "".join(including)))
    assert only(package, "unknown-link") == []
    whole.unlink()
    part.write_text(XACRO.format("tool", joint.format("tool", "wrist") + '<link name="wirst"/>'))
    assert ("unknown-link", "error") in only(package, "unknown-link")


@pytest.mark.slow
def test_of_two_packages_with_one_name_each_finds_its_own_files(tmp_path: Path) -> None:
    first, second = (write_package(tmp_path / name) for name in ("a", "b"))
    include = '<xacro:include filename="$(find cart)/urdf/{}.xacro"/>'
    for package, name in ((first, "left"), (second, "right")):
        (package / "urdf" / f"{name}.xacro").write_text(XACRO.format("x", ""))
        whole = package / "urdf" / "whole.urdf.xacro"
        whole.write_text(XACRO.format("whole", include.format(name) + '<link name="base"/>'))
    assert only(tmp_path, "xacro-file-fails") == []
    (second / "urdf" / "right.xacro").unlink()
    assert only(tmp_path, "xacro-file-fails") == [("xacro-file-fails", "error")]


@pytest.mark.slow
def test_a_part_of_a_robot_uses_what_the_file_that_includes_it_defines(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    part = package / "urdf" / "tool.xacro"
    link = '<link name="tool"/><xacro:{} mass="1"/>'
    for text, severity in (
        (link.format("inertia_of_box"), "info"),
        ('<link name="tool_${side}"/>', "info"),
        ('<xacro:macro name="weight" params="mass"/>' + link.format("wieght"), "error"),
        ('<xacro:include filename="other.xacro"/>' + link.format("inertia_of_box"), "error"),
    ):
        (package / "urdf" / "other.xacro").write_text(XACRO.format("other", ""))
        part.write_text(XACRO.format("tool", text))
        assert only(package, "xacro-file-fails") == [("xacro-file-fails", severity)], text


@pytest.mark.slow
def test_what_is_no_robot_or_world_of_this_gazebo(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    webots = '<robot name="cart"><webots><plugin type="driver.Driver"/></webots></robot>'
    (package / "urdf" / "webots.urdf").write_text(webots)
    assert only(package, "no-link") == [("no-link", "info")]
    (package / "urdf" / "webots.urdf").write_text('<robot name="cart"/>')
    assert only(package, "no-link") == [("no-link", "error")]
    models = package / "models" / "can"
    models.mkdir(parents=True)
    (models / "model-1_2.sdf").write_text('<gazebo version="1.2"><model name="can"/></gazebo>')
    assert only(package, "no-world") == [("no-world", "info")]
    (models / "model-1_2.sdf").write_text('<sdf version="1.5"/>')
    assert only(package, "no-world") == [("no-world", "error")]
    (models / "model-1_2.sdf").write_text('<sdf version="1.5"><light name="a" type="point"/></sdf>')
    assert only(package, "no-world") == [("no-world", "info")]
    (models / "model-1_2.sdf").write_text('<sdf version="1.6"><actor name="a"/></sdf>')
    assert only(package, "no-world") == [("no-world", "info")]


@pytest.mark.slow
def test_what_worlds_have_elsewhere_or_download(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    mesh = "<link name='a'><collision name='c'><geometry><mesh><uri>{}</uri></mesh></geometry>"
    meshes = (
        "model://others_can/can.stl",
        "https://fuel.gazebosim.org/1.0/o/models/can/1/files/can.stl",
    )
    models = [
        f"<model name='m{i}'>{mesh.format(uri)}</collision></link></model>"
        for i, uri in enumerate(meshes)
    ]
    include = "<include><uri>https://fuel.gazebosim.org/1.0/o/models/can</uri></include>"
    models += [f"<model name='n'>{include}</model>", include, "<actor name='walker'/>"]
    (package / "worlds").mkdir()
    lines = "\n".join(models)  # a diagnostic each
    world = f"<sdf version='1.6'><world name='w'>\n{lines}</world></sdf>"
    file = package / "worlds" / "w.world"
    file.write_text(world)
    found = only(package, "missing-collision-mesh", "model-left-out", "model-from-network")
    assert sorted(found) == [
        ("missing-collision-mesh", "warning"),
        *[("model-from-network", "info")] * 2,  # the meshes, and the includes
        *[("model-left-out", "info")] * 3,
    ]
    file.write_text(world.replace("model://others_can/", "meshes/"))
    assert ("missing-collision-mesh", "error") in only(package, "missing-collision-mesh")
    file.write_text(world.replace("https://fuel.gazebosim.org/1.0/o/models/can<", "model://can2<"))
    found = only(package, "model-left-out")
    assert sorted({severity for _, severity in found}) == ["info", "warning"]


@pytest.mark.slow
def test_a_launch_file_that_another_package_includes(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    spawn = package / "launch" / "spawn.launch.py"
    spawn.write_text(
        "from launch import LaunchDescription\nfrom launch.actions import ExecuteProcess\n"
        "from launch_ros.actions import Node\n\n\n"
        "def generate_launch_description():\n    return LaunchDescription([\n"
        "        ExecuteProcess(cmd=['gazebo', '-s', 'libgazebo_ros_factory.so']),\n"
        "        Node(package='gazebo_ros', executable='spawn_entity.py',\n"
        "             arguments=['-topic', 'my_robot', '-entity', 'cart'])])\n"
    )
    (package / "launch" / "cart.launch.py").unlink()
    assert only(package, "unpublished-description") == [("unpublished-description", "error")]
    other = write_package(tmp_path, "bringup")
    file = other / "launch" / "cart.launch.py"
    file.write_text(file.read_text() + "# includes spawn.launch.py of the package cart\n")
    assert only(package, "unpublished-description") == [("unpublished-description", "info")]


@pytest.mark.slow
def test_a_package_of_catkin_finds_its_source(tmp_path: Path) -> None:
    package = write_package(tmp_path, **{"package.xml": "ament_cmake</build -> catkin</build"})
    (package / "xacro").mkdir()
    (package / "xacro" / "wheel.xacro").write_text(XACRO.format("wheel", ""))
    include = '<xacro:include filename="$(find cart)/xacro/wheel.xacro"/>'
    (package / "xacro" / "cart.urdf.xacro").write_text(
        XACRO.format("cart", include + '<link name="base"/>')
    )
    assert only(package, "xacro-file-fails") == []
    of_ros_1 = '<launch><rosparam command="load" file="$(find cart)/a.yaml"/></launch>'
    (package / "launch" / "load.launch.xml").write_text(of_ros_1)
    assert only(package, "refused-by-launch", "ros-1-launch-file") == []


@pytest.mark.slow
def test_hardware_that_depends_on_an_argument(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    body = URDF.partition("\n")[2].rpartition("</robot>")[0]
    control = (
        '<xacro:arg name="sim" default="false"/>\n{}\n'
        '<link name="tip"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" '
        'ixy="0" ixz="0" iyz="0"/></inertial></link>\n'
        '<joint name="turn" type="continuous"><parent link="base"/><child link="tip"/></joint>\n'
        '<ros2_control name="arm" type="system"><hardware>{}</hardware>\n'
        '<joint name="turn"><command_interface name="velocity"/></joint></ros2_control>'
    )
    plugin = (
        '<xacro:if value="$(arg sim)"><plugin>gz_ros2_control/GazeboSimSystem</plugin></xacro:if>'
    )
    file = package / "urdf" / "arm.urdf.xacro"
    for hardware, severity in ((plugin, "info"), ("", "warning")):
        file.write_text(XACRO.format("arm", control.format(body, hardware)))
        assert only(package, "incomplete-ros2-control") == [("incomplete-ros2-control", severity)]


@pytest.mark.slow
def test_a_launch_file_that_fails_without_a_package_of_others(tmp_path: Path) -> None:
    path = "    path = os.path.join("
    raises = "    for _ in None:\n        pass\n"
    other = "    get_package_share_directory('moveit_config_of_others')\n"
    package = write_package(tmp_path, launch=f"{path} -> {raises}{path}")
    assert only(package, "launch-raises") == [("launch-raises", "error")]
    package = write_package(tmp_path / "b", launch=f"{path} -> {other}{raises}{path}")
    assert only(package, "launch-raises") == [("launch-raises", "info")]


@pytest.mark.slow
def test_what_a_package_beside_declares(tmp_path: Path) -> None:
    launch = "directory('@PKG@'), 'urdf', 'cart.urdf') -> directory('customer_arm'), 'arm.urdf')"
    package = write_package(tmp_path, launch=launch)
    assert only(package, "package-not-found") == [("package-not-found", "warning")]
    write_package(tmp_path, "driver", **{
        "package.xml": "<exec_depend>xacro -> <exec_depend>customer_arm</exec_depend>"
        "<exec_depend>xacro"
    })  # fmt: skip
    assert only(package, "package-not-found") == [("package-not-found", "info")]


@pytest.mark.slow
def test_a_robot_that_is_for_rviz_alone(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    for file in package.rglob("*"):
        if file.is_file() and b"gazebo" in file.read_bytes():
            file.unlink()
    robot = package / "urdf" / "r.urdf"
    robot.write_text(
        '<robot name="r"><link name="a"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/>'
        "</joint></robot>"
    )
    assert only(package, "dropped-link") == [("dropped-link", "warning")]
    manifest = package / "package.xml"
    comment = "<!-- <exec_depend>gazebo_ros_control</exec_depend> -->"
    manifest.write_text(manifest.read_text().replace("</package>", f"{comment}</package>"))
    assert only(package, "dropped-link") == [("dropped-link", "warning")]
    launch = package / "launch" / "start.launch.py"
    launch.write_text("def generate_launch_description(): ...  # starts ros_gz_sim\n")
    assert only(package, "dropped-link") == [("dropped-link", "error")]
    # Gazebo is given the SDF of the robot, if that has all its links.
    model = package / "models" / "r" / "model.sdf"
    model.parent.mkdir(parents=True)
    model.write_text('<sdf version="1.6"><model name="r"><link name="a"/></model></sdf>')
    assert only(package, "dropped-link") == [("dropped-link", "error")]
    model.write_text(
        '<sdf version="1.6"><model name="r"><link name="a"/><link name="b"/></model></sdf>'
    )
    assert only(package, "dropped-link") == [("dropped-link", "warning")]


@pytest.mark.slow
def test_two_packages_of_one_name(tmp_path: Path) -> None:
    """colcon builds nothing then."""
    package = write_package(tmp_path)
    shutil.copytree(package, tmp_path / "src" / "copy")
    found = [one for one in run(tmp_path).diagnostics if one.name == "duplicate-package"]
    assert [one.severity.value for one in found] == ["error"]
    assert "src/cart" in found[0].message
    assert "src/copy" in found[0].message
    (tmp_path / "src" / "copy" / "COLCON_IGNORE").touch()
    assert not [one for one in run(tmp_path).diagnostics if one.name == "duplicate-package"]

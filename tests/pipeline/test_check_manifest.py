"""package.xml in `wsgen check`, with what the files of the package use."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.workspace.layout import read_package
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.check_sources import check_package_manifest

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

MANIFEST = """\
<package format="3">
  <name>demo</name>
  <version>0.0.1</version>
  <description>A demo.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>rclpy</exec_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(demo NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})
install(PROGRAMS scripts/driver.py DESTINATION lib/${PROJECT_NAME})
ament_package()
"""
LAUNCH = """\
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    package = ''.join(['jo', 'y'])
    return LaunchDescription([
        Node(package='rviz2', executable='rviz2'),
        Node(package=package, executable='joy_node'),
    ])
"""
NODE = "#!/usr/bin/env python3\nimport rclpy\n"


def codes(folder: Path, **changes: tuple[str, str]) -> dict[str, tuple[str, int | None]]:
    """By code, the file and line of what is reported of a package with changes by file."""
    package = folder / "src" / "demo"
    files = {
        "package.xml": MANIFEST,
        "CMakeLists.txt": CMAKE,
        "launch/demo.launch.py": LAUNCH,
        "scripts/driver.py": NODE,
    }
    for name, text in files.items():
        old, new = changes.get(name.rpartition("/")[2].partition(".")[0], ("", ""))
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace(old, new, 1))
        file.chmod(0o755)
    outcome = check(CheckRequest(paths=(package,)), environment={})
    return {one.code: (one.file.name if one.file else "", one.line) for one in outcome.diagnostics}


DECLARED = (
    "<exec_depend>rclpy</exec_depend>",
    (
        "<exec_depend>rclpy</exec_depend><exec_depend>rviz2</exec_depend><exec_depend>joy"
        "</exec_depend>"
    ),
)


def test_a_sound_package(tmp_path: Path) -> None:
    assert codes(tmp_path, package=DECLARED).keys() <= {"LCH046"}


@pytest.mark.slow
def test_what_launch_files_look_up_is_reported_once(tmp_path: Path) -> None:
    found = codes(tmp_path)
    assert found["LCH045"] == ("demo.launch.py", 8)
    outcome = check(CheckRequest(paths=(tmp_path / "src" / "demo",)), environment={})
    (one,) = [one for one in outcome.diagnostics if one.code == "LCH045"]
    assert one.hint == (
        "Add to package.xml: <exec_depend>joy</exec_depend> <exec_depend>rviz2</exec_depend>"
    )


@pytest.mark.parametrize(
    ("file", "change", "code", "place"),
    [
        ("driver", ("rclpy", "nav_msgs.msg"), "PKG085", ("driver.py", 2)),
        (
            "CMakeLists",
            ("REQUIRED)", "REQUIRED)\nfind_package(rclcpp REQUIRED)"),
            "PKG087",
            ("CMakeLists.txt", 4),
        ),
        ("package", (">rclpy<", ">rclpyy<"), "PKG068", ("package.xml", 8)),
        (
            "package",
            ("<export><build_type>ament_cmake</build_type></export>", ""),
            "PKG009",
            ("package.xml", None),
        ),
        (
            "package",
            ("ament_cmake</build_type>", "ament_cmke</build_type>"),
            "PKG008",
            ("package.xml", 9),
        ),
        (
            "package",
            ("<buildtool_depend>ament_cmake</buildtool_depend>", ""),
            "PKG078",
            ("package.xml", 9),
        ),
        (
            "package",
            ("exec_depend>rclpy</exec", "build_depend>rclpy</build"),
            "PKG084",
            ("package.xml", 8),
        ),
    ],
)
def test_mistakes(
    file: str, change: tuple[str, str], code: str, place: tuple[str, int | None], tmp_path: Path
) -> None:
    assert codes(tmp_path, **{file: change})[code] == place


GOLDEN = Path(__file__).parents[1] / "golden"
# What brings them: ros2 launch, gz_ros2_control, ros2_controllers, joint_state_publisher_gui,
# sensor_msgs.
BROUGHT = {"launch", "launch_ros", "ros2launch", "controller_manager", "joint_state_publisher"} | {
    "geometry_msgs"
}
INSTEAD = {"ros2_controllers": "joint_trajectory_controller"}


def check_text(package: Path, folder: Path, text: str) -> list[Diagnostic]:
    """What is reported of a package with another package.xml, without evaluating launch files."""
    copy = folder / "copy" / package.name
    shutil.copytree(package, copy)
    (copy / "package.xml").write_text(text)
    read = read_package(copy)
    assert read is not None
    build, _ = read_build_facts(copy, read.name, read.build_type)
    found = check_package_manifest(
        read, build=build, plans=(), packages={read.name: read}, distro=None
    )
    reported = [*found]
    shutil.rmtree(copy)
    return reported


@pytest.mark.slow
@pytest.mark.parametrize(
    "golden",
    ["simple-iron-classic", "simple-jazzy-gz", "wanderer-jazzy-gz", "arm-jazzy-gz"],
)
def test_each_dependency_of_a_generated_package(golden: str, tmp_path: Path) -> None:
    (file,) = (GOLDEN / golden).rglob("package.xml")
    text = file.read_text()
    assert check_text(file.parent, tmp_path, text) == []
    for element in re.finditer(r"\n *<exec_depend>([\w-]+)</exec_depend>", text):
        name = element[1]
        missing = check_text(file.parent, tmp_path, text.replace(element[0], ""))
        hints = " ".join(one.hint or "" for one in missing)
        assert name in BROUGHT or f"<exec_depend>{INSTEAD.get(name, name)}</exec" in hints, name
        letters = [*name]
        letters[-2:-4:-1] = letters[-3:-1]  # two letters swapped
        misspelled = "".join(letters) if letters != [*name] else f"{name[:-1]}"
        line = text.count("\n", 0, element.end()) + 1
        found = check_text(file.parent, tmp_path, text.replace(f">{name}<", f">{misspelled}<", 1))
        assert [one for one in found if one.line == line and one.code in {"PKG068", "PKG069"}]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "severity"), [("demo_mission", "warning"), ("demo_visoin", "error")]
)
def test_a_package_of_another_workspace_is_none_that_is_misspelled(
    name: str, severity: str, tmp_path: Path
) -> None:
    change = ("package='rviz2', executable='rviz2'", f"package='{name}', executable='x'")
    other = tmp_path / "src" / "demo_vision"
    other.mkdir(parents=True)
    (other / "package.xml").write_text(MANIFEST.replace(">demo<", ">demo_vision<"))
    (other / "CMakeLists.txt").write_text(CMAKE.replace("(demo", "(demo_vision"))
    assert "LCH007" in codes(tmp_path, demo=change)
    outcome = check(CheckRequest(paths=(tmp_path / "src" / "demo",)), environment={})
    (found,) = [one for one in outcome.diagnostics if one.code == "LCH007"]
    assert found.severity.value == severity


@pytest.mark.slow
@pytest.mark.parametrize(("name", "severity"), [("arm", "warning"), ("wrold", "error")])
def test_a_configuration_that_who_includes_the_launch_file_may_set(
    name: str, severity: str, tmp_path: Path
) -> None:
    change = (
        "        Node(package='rviz2', executable='rviz2'),\n",
        (
            "        DeclareLaunchArgument('world', default_value='x'),\n"
            f"        LogInfo(msg=LaunchConfiguration('{name}')),\n"
        ),
    )
    codes(tmp_path, demo=change)
    file = tmp_path / "src" / "demo" / "launch" / "demo.launch.py"
    file.write_text(
        "from launch.actions import DeclareLaunchArgument, LogInfo\n"
        f"from launch.substitutions import LaunchConfiguration\n{file.read_text()}"
    )
    outcome = check(CheckRequest(paths=(tmp_path / "src" / "demo",)), environment={})
    (found,) = [one for one in outcome.diagnostics if one.code == "LCH009"]
    assert found.severity.value == severity


INNER = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('robots', default_value='x'),
        LogInfo(msg=LaunchConfiguration('robot')),
    ])
"""
OUTER = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess, IncludeLaunchDescription, SetLaunchConfiguration
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    return LaunchDescription([ACTIONS])
"""
INCLUDE = (
    "IncludeLaunchDescription(PythonLaunchDescriptionSource("
    "[FindPackageShare('demo'), '/launch/inner.launch.py']){given})"
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("actions", "severities"),
    [
        ("", ["error"]),
        ("ExecuteProcess(cmd=['ros2', 'launch', 'demo', 'inner.launch.py', 'robot:=a'])", []),
        ("ExecuteProcess(cmd=['ros2 launch demo inner.launch.py robot:=a'], shell=True)", []),
        ("ExecuteProcess(cmd=['ros2', 'launch', 'demo', 'inner.launch.py'])", ["error"]),
        (
            "ExecuteProcess(cmd=['ros2', 'launch', 'other', 'inner.launch.py', 'robot:=a'])",
            ["error"],
        ),
        (INCLUDE.format(given=", launch_arguments={'robot': 'a'}.items()"), []),
        (INCLUDE.format(given=""), ["error"]),
        ("SetLaunchConfiguration('robot', 'a'), " + INCLUDE.format(given=""), []),
    ],
)
def test_a_configuration_that_who_starts_the_launch_file_gives(
    actions: str, severities: list[str], tmp_path: Path
) -> None:
    codes(tmp_path)
    launch = tmp_path / "src" / "demo" / "launch"
    (launch / "inner.launch.py").write_text(INNER)
    (launch / "outer.launch.py").write_text(OUTER.replace("ACTIONS", actions))
    outcome = check(CheckRequest(paths=(tmp_path / "src" / "demo",)), environment={})
    found = [one for one in outcome.diagnostics if one.code == "LCH009"]
    assert [one.severity.value for one in found] == severities


@pytest.mark.slow
def test_a_configuration_that_a_launch_file_of_another_package_gives(tmp_path: Path) -> None:
    codes(tmp_path)
    source = tmp_path / "src"
    (source / "demo" / "launch" / "inner.launch.py").write_text(INNER)
    other = source / "other" / "launch"
    other.mkdir(parents=True)
    (other.parent / "package.xml").write_text(MANIFEST.replace(">demo<", ">other<"))
    (other.parent / "CMakeLists.txt").write_text(CMAKE.replace("(demo", "(other"))
    command = "ExecuteProcess(cmd=['ros2', 'launch', 'demo', 'inner.launch.py', 'robot:=a'])"
    (other / "outer.launch.py").write_text(OUTER.replace("ACTIONS", command))
    outcome = check(CheckRequest(paths=(source,)), environment={})
    (found,) = [one for one in outcome.diagnostics if one.code == "LCH009"]
    assert found.severity.value == "info"


@pytest.mark.slow
def test_a_configuration_that_is_declared_too_late(tmp_path: Path) -> None:
    codes(tmp_path)
    first, use, end = INNER.partition("        LogInfo(msg=LaunchConfiguration('robot')),\n")
    declared = "        DeclareLaunchArgument('robot', default_value='y'),\n"
    file = tmp_path / "src" / "demo" / "launch" / "inner.launch.py"
    file.write_text(first + use + declared + end)
    outcome = check(CheckRequest(paths=(tmp_path / "src" / "demo",)), environment={})
    (found,) = [one for one in outcome.diagnostics if one.code == "LCH009"]
    assert found.severity.value == "error"
    assert "Declare it before" in (found.hint or "")
    assert "Did you mean" not in (found.hint or "")


@pytest.mark.slow
def test_a_circle_of_packages_is_reported_once(tmp_path: Path) -> None:
    codes(tmp_path)
    source = tmp_path / "src"
    for name, needed in (("demo", "other"), ("other", "demo")):
        (source / name).mkdir(exist_ok=True)
        text = MANIFEST.replace(">demo<", f">{name}<")
        needs = f"<exec_depend>{needed}</exec_depend>\n  <export>"
        (source / name / "package.xml").write_text(text.replace("<export>", needs))
        (source / name / "CMakeLists.txt").write_text(CMAKE.replace("(demo", f"({name}"))
    for paths in ((source,), (source / "demo",)):
        outcome = check(CheckRequest(paths=paths), environment={})
        (found,) = [one for one in outcome.diagnostics if one.code == "PKG090"]
        assert found.file == source / "demo" / "package.xml"
        assert "demo → other → demo" in found.message

"""Whole packages, from Gazebo Classic to Gazebo Sim."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from golden_support import golden_package
from wsgen.cli import run
from wsgen.diagnostics import Severity
from wsgen.model.target import SIM, Target
from wsgen.pipeline.check import CheckRequest, check, find_targets
from wsgen.porting.plan import PortPlan, plan_port
from wsgen.porting.write import write_port

if TYPE_CHECKING:
    from pathlib import Path

JAZZY = Target(distro="jazzy", simulator=SIM)
OF_CLASSIC = re.compile(
    r"gazebo_ros(?! gazebo_model_path)|gazebo_plugins|libgazebo|spawn_entity|gzserver|GAZEBO_"
)


def make(folder: Path, case: str) -> Path:
    """A workspace with the package of a golden."""
    package = folder / "src" / "gazebo_test"
    shutil.copytree(golden_package(case), package)
    return package


def plan(*folders: Path) -> PortPlan:
    return plan_port(find_targets(folders), JAZZY, os.environ)


@pytest.mark.slow
@pytest.mark.parametrize("template", ["simple", "diff_drive", "arm", "wanderer"])
def test_a_template_for_classic_becomes_one_for_sim(tmp_path: Path, template: str) -> None:
    package = make(tmp_path, f"{template}-humble-classic")
    written = [*write_port(plan(package))]
    assert package / "package.xml" in written
    for file in package.rglob("*"):
        if file.is_file() and file.suffix in {".py", ".xml", ".txt", ".xacro", ".sdf", ".world"}:
            assert not OF_CLASSIC.search(file.read_text(encoding="utf-8")), file
    outcome = check(CheckRequest(paths=[package], distro="jazzy"), environment=os.environ)
    notes = [one for one in outcome.diagnostics if one.severity is Severity.INFO]
    assert [one for one in outcome.diagnostics if one not in notes] == []


@pytest.mark.slow
@pytest.mark.parametrize("template", ["diff_drive", "arm"])
def test_ported_twice_is_ported_once(tmp_path: Path, template: str) -> None:
    package = make(tmp_path, f"{template}-humble-classic")
    list(write_port(plan(package)))
    again = plan(package)
    assert again.files == ()
    assert again.created == ()
    assert again.unported == ()


@pytest.mark.slow
@pytest.mark.parametrize("case", ["diff_drive-jazzy-gz", "arm-humble-gz"])
def test_a_package_for_sim_stays_as_it_is(tmp_path: Path, case: str) -> None:
    package = make(tmp_path, case)
    settings = package / "wsgen.toml"
    settings.unlink()
    planned = plan(package)
    assert (planned.files, planned.created, planned.unported) == ((), (), ())


@pytest.mark.slow
def test_the_default_world_is_written_where_it_is_given(tmp_path: Path) -> None:
    """In what includes the launch file that starts Gazebo, and what includes that."""
    package = make(tmp_path, "diff_drive-humble-classic")
    for name, inner in (("a", "top"), ("top", "world"), ("world", "")):
        given = f"world_{inner}" if inner else "world"
        started = f"join(share, 'launch', '{inner}.launch.py')"
        if not inner:
            started = "join(get_package_share_directory('gazebo_ros'), 'launch/gzserver.launch.py')"
        (package / f"launch/{name}.launch.py").write_text(f"""\
from os.path import join
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import LaunchConfiguration

def generate_launch_description():
    share = get_package_share_directory('gazebo_test')
    return LaunchDescription([
        DeclareLaunchArgument('world_{name}', default_value=''),
        IncludeLaunchDescription(
            {started},
            launch_arguments={{'{given}': LaunchConfiguration('world_{name}')}}.items(),
        ),
    ])
""")
    list(write_port(plan(package)))
    for name in ("a", "top", "world"):
        text = (package / f"launch/{name}.launch.py").read_text(encoding="utf-8")
        assert f"'world_{name}', default_value=PathJoinSubstitution([FindPackage" in text
        assert text.count("import PathJoinSubstitution") == 1
    (package / "launch/a.launch.py").unlink()  # nobody includes it
    assert (plan(package).files, plan(package).created) == ((), ())


@pytest.mark.slow
def test_launch_files_of_one_name_in_two_packages(tmp_path: Path) -> None:
    """Each starts Gazebo with a world of its own, and includes, or names, the other."""
    packages = []
    for name, default in (("one", ""), ("two", "city.world")):
        package = tmp_path / "src" / name
        shutil.copytree(golden_package("diff_drive-humble-classic"), package)
        manifest = package / "package.xml"
        text = manifest.read_text(encoding="utf-8").replace("gazebo_test", name)
        manifest.write_text(text, encoding="utf-8")
        (package / "launch/sim.launch.py").write_text(f"""\
# ros2 launch {name} sim.launch.py
from os.path import join
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import LaunchConfiguration

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('world_{name}', default_value='{default}'),
        IncludeLaunchDescription(
            join(get_package_share_directory('gazebo_ros'), 'launch/gzserver.launch.py'),
            launch_arguments={{'world': LaunchConfiguration('world_{name}')}}.items(),
        ),
    ])
""")
        packages.append(package)
    (packages[0] / "launch/all.launch.py").write_text("""\
from os.path import join
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription

def generate_launch_description():
    return LaunchDescription([
        IncludeLaunchDescription(
            join(get_package_share_directory('two'), 'launch', 'sim.launch.py'),
            launch_arguments={'world_two': ''}.items(),
        ),
    ])
""")
    list(write_port(plan(*packages)))
    text = (packages[0] / "launch/all.launch.py").read_text(encoding="utf-8")
    assert "'world_two': PathJoinSubstitution([FindPackageShare('two'), " in text


@pytest.mark.slow
def test_a_world_is_one_whatever_its_name_ends_with(tmp_path: Path) -> None:
    package = make(tmp_path, "diff_drive-humble-classic")
    (package / "model/hall.model").write_text("<sdf version='1.6'><world name='hall'/></sdf>")
    assert {one.file.name for one in plan(package).files} >= {"hall.model"}


@pytest.mark.slow
def test_a_check_lists_what_a_port_would_change(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    package = make(tmp_path, "diff_drive-humble-classic")
    monkeypatch.chdir(tmp_path)
    before = (package / "package.xml").read_text(encoding="utf-8")
    assert run(["check", str(package), "--to", "jazzy"]) == 0
    shown = capsys.readouterr().out
    assert "src/gazebo_test/package.xml" in shown
    assert "src/gazebo_test/model/robot.gazebo: lines" in shown
    assert "wsgen port src/gazebo_test --to jazzy --diff" in shown
    assert (package / "package.xml").read_text(encoding="utf-8") == before


@pytest.mark.slow
def test_a_package_of_ros_1_is_left_to_its_author(tmp_path: Path) -> None:
    package = make(tmp_path, "simple-humble-classic")
    manifest = package / "package.xml"
    text = manifest.read_text(encoding="utf-8").replace("ament_cmake", "catkin")
    manifest.write_text(text, encoding="utf-8")
    planned = plan(package)
    assert planned.files == ()
    assert ["is of ROS 1" in one.what for one in planned.unported] == [True]


@pytest.mark.slow
def test_files_that_git_does_not_have_are_not_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    package = make(tmp_path, "simple-humble-classic")
    before = (package / "package.xml").read_text(encoding="utf-8")
    assert run(["port", str(package), "--to", "jazzy"]) == 2
    assert "is not in a git repository" in capsys.readouterr().err
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    assert run(["port", str(package), "--to", "jazzy"]) == 2
    assert "changes that are not committed" in capsys.readouterr().err
    assert run(["port", str(package), "--to", "jazzy", "--diff", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["written"] is False
    assert {"path": str(package / "package.xml"), "new": False} in document["files"]
    assert run(["port", str(package), "--to", "jazzy", "--diff"]) == 0
    diff = capsys.readouterr().out
    assert "-  <exec_depend>gazebo_ros</exec_depend>" in diff
    assert "+  <exec_depend>ros_gz_sim</exec_depend>" in diff
    assert (package / "package.xml").read_text(encoding="utf-8") == before
    assert run(["port", str(package), "--to", "jazzy", "--force"]) == 0
    assert "ros_gz_sim" in (package / "package.xml").read_text(encoding="utf-8")
    capsys.readouterr()
    assert run(["port", str(package), "--to", "jazzy"]) == 0  # what is not committed is the port
    assert "Nothing to port" in capsys.readouterr().out


@pytest.mark.slow
def test_a_robot_that_nothing_simulates_stays_as_it_is(tmp_path: Path) -> None:
    """Gazebo need not find its meshes."""
    package = make(tmp_path, "simple-humble-classic")
    shutil.rmtree(package / "launch")
    manifest = package / "package.xml"
    text = re.sub(r" *<\w+>gazebo_ros\w*</\w+>\n", "", manifest.read_text(encoding="utf-8"))
    manifest.write_text(text, encoding="utf-8")
    (package / "model" / "robot.xacro").write_text(
        '<robot name="r"><link name="l"><visual><geometry>'
        '<mesh filename="package://gazebo_test/meshes/a.stl"/>'
        "</geometry></visual></link></robot>\n"
    )
    for world in package.rglob("*.world"):
        world.unlink()
    assert [one.file.name for one in plan(package).files if one.file == manifest] == []


DRIVE_ELSEWHERE = {
    "package.xml": """<package format="3">
  <name>split</name>
  <version>0.0.1</version>
  <description>A robot in several files.</description>
  <maintainer email="a@example.com">A</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
""",
    "urdf/robot.xacro": """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="here" value="split"/>
  <xacro:include filename="$(find ${here})/urdf/body.xacro"/>
  <xacro:include filename="drive.gazebo"/>
</robot>
""",
    "urdf/body.xacro": """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="wheel" params="side">
    <joint name="${side}_wheel_joint" type="continuous">
      <limit effort="3" velocity="1.0"/>
    </joint>
  </xacro:macro>
  <xacro:wheel side="left"/>
  <joint name="right_wheel_joint" type="continuous">
    <axis xyz="0 1 0"/>
  </joint>
</robot>
""",
    "urdf/drive.gazebo": """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <left_joint>left_wheel_joint</left_joint>
      <right_joint>right_wheel_joint</right_joint>
      <wheel_separation>0.5</wheel_separation>
      <wheel_diameter>0.2</wheel_diameter>
      <max_wheel_torque>20</max_wheel_torque>
    </plugin>
  </gazebo>
</robot>
""",
    "urdf/other.xacro": """<robot name="other">
  <joint name="left_wheel_joint" type="continuous"/>
  <joint name="right_wheel_joint" type="continuous"/>
</robot>
""",
}


def _written(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", ["right_wheel_joint", "${prefix}right_wheel_joint"])
def test_wheels_are_as_strong_wherever_they_are(tmp_path: Path, name: str) -> None:
    body = DRIVE_ELSEWHERE["urdf/body.xacro"].replace('"right_wheel_joint"', f'"{name}"')
    package = _written(tmp_path / "split", {**DRIVE_ELSEWHERE, "urdf/body.xacro": body})
    planned = plan(package)
    assert planned.unported == ()
    after = {one.file.name: one.after for one in planned.files}
    # Motors of Gazebo Classic are not as slow as that.
    assert after["body.xacro"].count('<limit effort="20" velocity="1000"/>') == 2
    assert re.search(
        r'<axis xyz="0 1 0"/>\s*<limit effort="20" velocity="\d+"/>', after["body.xacro"]
    )
    assert "max_wheel_torque" not in after["drive.gazebo"]
    assert "other.xacro" not in after  # another robot
    list(write_port(planned))
    assert plan(package).files == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<xacro:wheel side="left"/>', '<xacro:wheel side="left"/><xacro:wheel side="front"/>'),
        ('<joint name="right_wheel_joint"', '<joint name="right_wheel"'),
        ('<joint name="right_wheel_joint"', '<joint name="${side}_wheel_joint"'),
        (">20<", ">${strong}<"),
    ],
    ids=["of a macro for others, too", "not there", "computed", "computed elsewhere"],
)
def test_wheels_that_are_not_sure_are_left_to_the_author(
    tmp_path: Path, old: str, new: str
) -> None:
    files = {name: text.replace(old, new) for name, text in DRIVE_ELSEWHERE.items()}
    planned = plan(_written(tmp_path / "split", files))
    (left,) = planned.unported
    assert left.file.name == "drive.gazebo"
    assert left.what == "Its <max_wheel_torque> does not exist in Gazebo Sim."
    assert "body.xacro" not in {one.file.name for one in planned.files}


@pytest.mark.slow
def test_inertias_of_robots_that_nothing_spawns(tmp_path: Path) -> None:
    """They are the same whether a launch file spawns the robot before the port or after it."""
    link = (
        '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" '
        'iyz="0" izz="5"/></inertial></link>'
    )
    joint = '<joint name="j" type="{}"><parent link="a"/><child link="b"/></joint>'
    robot = f"<robot name='r'>{link.format('a')}{link.format('b')}{{}}</robot>"
    files = {
        "urdf/loose.urdf": robot.format(joint.format("continuous")),
        # Of links that are fixed together, only the sum counts.
        "urdf/sum.urdf": robot.format(joint.format("fixed")).replace('="1"', '="5"', 3),
    }
    planned = plan(_written(tmp_path / "split", DRIVE_ELSEWHERE | files))
    after = {one.file.name: one.after for one in planned.files}
    assert after["loose.urdf"].count('ixx="2.5000025"') == 2
    assert "sum.urdf" not in after


@pytest.mark.slow
def test_programs_are_told_what_takes_the_place_of_their_messages(tmp_path: Path) -> None:
    program = "from gazebo_msgs.srv import ApplyLinkWrench, GetEntityState\n"
    package = _written(tmp_path / "split", DRIVE_ELSEWHERE | {"scripts/push.py": program})
    left = next(one for one in plan(package).unported if one.file.name == "push.py")
    assert left.what == "The program uses Gazebo Classic: `GetEntityState`, `ApplyLinkWrench`."
    assert "/world/NAME/wrench" in left.advice
    assert "/world/NAME/dynamic_pose/info" in left.advice


IN_A_WORLD = {
    "package.xml": """<package format="3">
  <name>in_world</name>
  <version>0.0.1</version>
  <description>A robot in a world.</description>
  <maintainer email="a@example.com">A</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>gazebo_ros</exec_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
""",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.20)
project(in_world)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch models worlds DESTINATION share/${PROJECT_NAME})
ament_package()
""",
    "launch/world.launch.py": """import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource


def generate_launch_description():
    share = get_package_share_directory('in_world')
    gazebo = get_package_share_directory('gazebo_ros')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(gazebo, 'launch', 'gazebo.launch.py')),
            launch_arguments={'world': os.path.join(share, 'worlds', 'w.world')}.items(),
        ),
    ])
""",
    "worlds/w.world": """<sdf version="1.6">
  <world name="default">
    <include><uri>model://bot</uri></include>
  </world>
</sdf>
""",
    "models/bot/model.sdf": """<sdf version="1.6">
  <model name="bot">
    <link name="body">
      <sensor name="lidar" type="ray">
        <ray><range><min>0.1</min><max>5</max></range></ray>
        <plugin name="laser" filename="libgazebo_ros_ray_sensor.so">
          <ros><remapping>~/out:=scan</remapping></ros>
          <output_type>sensor_msgs/LaserScan</output_type>
        </plugin>
      </sensor>
    </link>
  </model>
</sdf>
""",
}


@pytest.mark.slow
@pytest.mark.parametrize("world", ["os.path.join(share, 'worlds', 'w.world')", "'/home/a/w.world'"])
def test_the_topics_of_a_robot_in_the_world_are_bridged(tmp_path: Path, world: str) -> None:
    """Also where the launch file says where its author has the world."""
    package = tmp_path / "src" / "in_world"
    for name, text in IN_A_WORLD.items():
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        moved = text.replace("os.path.join(share, 'worlds', 'w.world')", world)
        file.write_text(moved, encoding="utf-8")
    list(write_port(plan(package)))
    launch_file = (package / "launch" / "world.launch.py").read_text(encoding="utf-8")
    assert "'/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan'" in launch_file
    text = (package / "worlds" / "w.world").read_text(encoding="utf-8")
    assert "gz::sim::systems::Sensors" in text


def _car() -> str:
    """A model with wheels 1 m apart on axles at x = 0 and 2 m, of which the front ones steer."""
    parts = []
    for name, x, y in (("fl", 2, 0.5), ("fr", 2, -0.5), ("rl", 0, 0.5), ("rr", 0, -0.5)):
        parts.append(
            f"<link name='{name}'><pose>{x} {y} 0.3 0 0 0</pose><collision name='c'>"
            "<geometry><sphere><radius>0.3</radius></sphere></geometry></collision></link>"
        )
        second = "<axis2><xyz>0 0 1</xyz></axis2>" if x else ""
        parts.append(
            f"<joint name='{name}_joint' type='{'universal' if x else 'revolute'}'>"
            f"<parent>body</parent><child>{name}</child><axis><xyz>0 1 0</xyz></axis>{second}"
            "</joint>"
        )
    tags = {
        "front_left_joint": "fl_joint",
        "front_right_joint": "fr_joint",
        "rear_left_joint": "rl_joint",
        "rear_right_joint": "rr_joint",
        "left_steering_joint": "fl_joint",
        "right_steering_joint": "fr_joint",
    }
    said = "".join(f"<{tag}>{joint}</{tag}>" for tag, joint in tags.items())
    filename = "libgazebo_ros_ackermann_drive.so"
    plugin = f"<plugin name='drive' filename='{filename}'>{said}</plugin>"
    return f"<model name='car'><link name='body'/>{''.join(parts)}{plugin}</model>"


@pytest.mark.slow
def test_a_car_is_given_the_sizes_that_classic_finds(tmp_path: Path) -> None:
    package = tmp_path / "src" / "in_world"
    for name, text in IN_A_WORLD.items():
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace("<include><uri>model://bot</uri></include>", _car()))
    planned = plan(package)
    list(write_port(planned))
    world = (package / "worlds" / "w.world").read_text(encoding="utf-8")
    sizes = {"wheel_separation": 1, "kingpin_width": 1, "wheel_base": 2, "wheel_radius": 0.3}
    for tag, size in sizes.items():
        assert f"<{tag}>{size}</{tag}>" in world
    assert not [one for one in planned.unported if "sizes of the car" in one.what]


@pytest.mark.slow
def test_the_service_that_a_program_calls_is_bridged(tmp_path: Path) -> None:
    program = """from gazebo_msgs.srv import SpawnEntity

client = node.create_client(SpawnEntity, "/spawn_entity")
request = SpawnEntity.Request()
request.name = "box"
"""
    package = _written(tmp_path / "in_world", {**IN_A_WORLD, "scripts/spawn.py": program})
    manifest = package / "package.xml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("gazebo_ros<", "gazebo_msgs<"), encoding="utf-8")
    list(write_port(plan(package)))
    launch = (package / "launch" / "world.launch.py").read_text(encoding="utf-8")
    assert "'/world/default/create@ros_gz_interfaces/srv/SpawnEntity'," in launch
    assert "('/world/default/create', '/spawn_entity')," in launch
    changed = (package / "scripts" / "spawn.py").read_text(encoding="utf-8")
    assert 'request.entity_factory.name = "box"' in changed
    assert "gazebo_msgs" not in manifest.read_text(encoding="utf-8")
    assert "<exec_depend>ros_gz_interfaces</exec_depend>" in manifest.read_text(encoding="utf-8")
    again = plan(package)
    assert (again.files, again.unported) == ((), ())


@pytest.mark.slow
def test_a_file_is_not_ported_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    package = make(tmp_path, "simple-humble-classic")
    robot = package / "model" / "robot.xacro"
    alone = tmp_path / "alone.urdf"
    shutil.copy(robot, alone)
    for command in (["port"], ["check"]):
        assert run([*command, str(robot), "--to", "jazzy"]) == 2
        assert f"Give its package: {package}" in capsys.readouterr().err
        assert run([*command, str(package), str(alone), "--to", "jazzy"]) == 2
        assert f"{alone} is not a package" in capsys.readouterr().err
        assert run([*command, str(alone), "--to", "jazzy"]) == 2
        assert "Give the folder of a package" in capsys.readouterr().err


CHOSEN = {
    **IN_A_WORLD,
    "launch/world.launch.py": """import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('in_world')
    robot = os.environ['MY_ROBOT'] + '.urdf'
    settings = os.path.join(share, 'config', 'gazebo.yaml')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(
                get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')),
            launch_arguments={
                'extra_gazebo_args': '--ros-args --params-file ' + settings,
            }.items(),
        ),
        Node(
            package='gazebo_ros',
            executable='spawn_entity.py',
            arguments=['-entity', 'r', '-file', os.path.join(share, 'models', robot)],
        ),
    ])
""",
    "config/gazebo.yaml": "gazebo: # the node\n  ros__parameters:\n    publish_rate: 400.0",
}


def _lidar(topic: str) -> str:
    return f"""<?xml version="1.0"?>
<robot name="r">
  <link name="base"/>
  <gazebo reference="base">
    <sensor name="{topic}" type="ray">
      <plugin name="{topic}" filename="libgazebo_ros_ray_sensor.so">
        <ros><remapping>~/out:={topic}</remapping></ros>
        <output_type>sensor_msgs/LaserScan</output_type>
      </plugin>
    </sensor>
  </gazebo>
</robot>
"""


@pytest.mark.slow
@pytest.mark.parametrize("is_set", [True, False])
def test_a_robot_that_a_variable_names_is_bridged_whichever_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, is_set: bool
) -> None:
    models = {f"models/{name}.urdf": _lidar(f"scan_{name}") for name in ("a", "b")}
    package = _written(tmp_path / "in_world", {**CHOSEN, **models})
    monkeypatch.delenv("MY_ROBOT", raising=False)
    if is_set:
        monkeypatch.setenv("MY_ROBOT", "a")
    planned = plan(package)
    list(write_port(planned))
    launch = (package / "launch" / "world.launch.py").read_text(encoding="utf-8")
    for name in ("a", "b"):
        assert launch.count(f"/scan_{name}@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan") == 1
    assert planned.unported == ()
    assert "--params-file" not in launch


@pytest.mark.slow
def test_what_gazebo_classic_was_given_besides_its_clock_is_listed(tmp_path: Path) -> None:
    more = CHOSEN["config/gazebo.yaml"] + "\n    other: 1\n"
    package = _written(tmp_path / "in_world", {**CHOSEN, "config/gazebo.yaml": more})
    assert "not a node of ROS" in plan(package).unported[0].what


@pytest.mark.slow
@pytest.mark.parametrize(
    ("include", "is_note"),
    [
        ('<!-- <xacro:include filename="part.xacro"/> -->', True),
        ('<xacro:include filename="part.xacro"/>', False),
        ('<xacro:arg name="part" default=""/><xacro:include filename="$(arg part)"/>', False),
    ],
)
def test_a_part_that_no_robot_includes_needs_no_edit(
    tmp_path: Path, include: str, *, is_note: bool
) -> None:
    robot = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    part = '<robot><gazebo><plugin name="p" filename="libgazebo_ros_vacuum_gripper.so"/></gazebo>'
    files = {
        "package.xml": IN_A_WORLD["package.xml"],
        "urdf/r.urdf.xacro": f"{robot}{include}<link name='base'/></robot>",
        "urdf/part.xacro": f"{part}</robot>",
    }
    planned = plan(_written(tmp_path / "in_world", files))
    assert [one.is_note for one in planned.unported] == [is_note]


@pytest.mark.slow
def test_launch_files_that_start_nothing_are_not_evaluated(tmp_path: Path) -> None:
    """Those of others that start a simulator are, whatever computes the begin of their names."""
    failing = "import os\n\nopen(os.environ['TRIED'], 'a').write('{name} ')\n{text}\n"
    include = "f = name + '_sim.launch.py'\n\n\ndef generate_launch_description():\n    return f()"
    launches = {
        "launch/world_sim.launch.py": IN_A_WORLD["launch/world.launch.py"],
        "launch/all.launch.py": failing.format(name="all", text=include),
        "launch/view.launch.py": failing.format(name="view", text="import rviz_view"),
    }
    tried = tmp_path / "tried"
    package = _written(tmp_path / "in_world", {**IN_A_WORLD, **launches})
    plan_port(find_targets([package]), JAZZY, {**os.environ, "TRIED": str(tried)})
    assert {*tried.read_text(encoding="utf-8").split()} == {"all"}


@pytest.mark.slow
@pytest.mark.parametrize("is_called", [True, False])
def test_services_of_a_world_that_no_program_calls_need_no_edit(
    tmp_path: Path, *, is_called: bool
) -> None:
    state = '<world name="default"><plugin name="s" filename="libgazebo_ros_state.so"/>'
    files = {
        **IN_A_WORLD,
        "worlds/w.world": IN_A_WORLD["worlds/w.world"].replace('<world name="default">', state),
    }
    if is_called:
        files["scripts/where.py"] = "topic = '/gazebo/model_states'\n"
    found = plan(_written(tmp_path / "in_world", files)).unported
    notes = [one.is_note for one in found if "libgazebo_ros_state" in one.what]
    assert notes == [not is_called]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spaces", "expected"), [(["a"], "a"), (["a", "b"], None), ([""], ""), ([], "")]
)
def test_a_controller_manager_has_the_namespace_of_its_spawner(
    tmp_path: Path, spaces: list[str], expected: str | None
) -> None:
    control = """<robot name="r">
  <link name="base"/>
  <ros2_control name="s" type="system">
    <hardware><plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>
  </ros2_control>
  <gazebo>
    <plugin name="c" filename="libgazebo_ros2_control.so">
      <parameters>$(find in_world)/config/a.yaml</parameters>
    </plugin>
  </gazebo>
</robot>
"""
    share = "get_package_share_directory('in_world')"
    text = "xacro.process_file(os.path.join(share, 'urdf', 'r.urdf.xacro')).toxml()"
    nodes = "".join(
        f"        Node(package='gazebo_ros', executable='spawn_entity.py', arguments=["
        f"'-entity', 'r{n}', '-topic', 'r{n}', '-robot_namespace', '{space}']),\n"
        f"        Node(package='robot_state_publisher', executable='robot_state_publisher', "
        f"parameters=[{{'robot_description': {text}}}], "
        f"remappings=[('robot_description', 'r{n}')]),\n"
        for n, space in enumerate(spaces)
    )
    launch = CHOSEN["launch/world.launch.py"].partition("def generate")[0] + (
        f"import xacro\n\n\ndef generate_launch_description():\n    share = {share}\n"
        f"    return LaunchDescription([\n{nodes}    ])\n"
    )
    files = {
        "package.xml": IN_A_WORLD["package.xml"],
        "config/a.yaml": "controller_manager:\n  ros__parameters: {}\n",
        "urdf/r.urdf.xacro": control.replace(
            '"r"', '"r" xmlns:xacro="http://www.ros.org/wiki/xacro"', 1
        ),
        "launch/all.launch.py": launch,
    }
    package = _written(tmp_path / "in_world", files)
    planned = plan(package)
    list(write_port(planned))
    after = (package / "urdf" / "r.urdf.xacro").read_text(encoding="utf-8")
    assert re.findall(r"<namespace>(.*)</namespace>", after) == ([expected] if expected else [])
    listed = [one for one in planned.unported if "controller manager, too: a, b." in one.what]
    assert len(listed) == (expected is None)
    assert plan(package).files == ()

"""What a launch file needs and this machine lacks ends one branch, and nothing else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.launching.package_lookup import LEFT_OUT
from wsgen.packages.source_shares import serve_sources

if TYPE_CHECKING:
    from pathlib import Path

    from install_space import InstallSpace
    from wsgen.model.plan import LaunchPlan


MANIFEST = "<package><name>my_robot</name>{}</package>"
READ = "OpaqueFunction(function=lambda _: open(get_package_share_directory('{}') + '/a'))"
INCLUDE = "IncludeLaunchDescription([FindPackageShare('{}'), '/launch/a.launch.py'])"
XACRO = "Command(['xacro ', FindPackageShare('my_robot'), '/a.urdf'])"
KNOWN = "ExecuteProcess(cmd=['known'])"


def codes(plan: LaunchPlan) -> list[str]:
    return [found.code for found in plan.diagnostics]


def assert_goes_on(plan: LaunchPlan, *expected: str) -> None:
    assert codes(plan) == [*expected], plan.diagnostics
    assert plan.is_complete
    assert plan.processes[-1].command == ("known",)


@pytest.mark.slow
def test_released_packages_need_not_be_installed(space: InstallSpace) -> None:
    plan = space.play(
        "Node(package='rplidar_ros', executable='rplidar_node', parameters=["
        "os.path.join(share, 'config', 'a.yaml')]), "
        f"{INCLUDE.format('realsense2_camera')}, {KNOWN}",
        before="share = get_package_share_directory('rplidar_ros')",
    )
    assert_goes_on(plan, "LCH046")
    assert "a.launch.py of realsense2_camera (line " in plan.diagnostics[0].message
    assert [process.executable for process in plan.processes] == ["rplidar_node", None]
    assert [include.evaluated for include in plan.includes] == [False]


@pytest.mark.slow
def test_undeclared_packages_are_one_warning(space: InstallSpace) -> None:
    space.add(
        "other",
        {
            "launch/a.launch.py": "from launch import LaunchDescription\n"
            "from launch_ros.actions import Node\n"
            "def generate_launch_description():\n    return LaunchDescription("
            "[Node(package='foxglove_bridge', executable='x')])\n"
        },
    )
    space.add(
        "my_robot",
        {
            "package.xml": MANIFEST.format(
                "<depend>gazebo_ros_pkgs</depend><!-- <exec_depend>rviz2</exec_depend> -->"
            )
        },
    )
    plan = space.play(
        "Node(package='rviz2', executable='rviz2'), Node(package='rplidar_ros', executable='x'), "
        "Node(package='gazebo_ros', executable='spawn_entity.py'), "
        f"{INCLUDE.format('other')}, {KNOWN}",
        before="get_package_share_directory('my_robot')",
    )
    assert_goes_on(plan, "LCH045")
    hint = plan.diagnostics[0].hint or ""
    lines = "".join(
        f" <exec_depend>{name}</exec_depend>" for name in ("other", "rplidar_ros", "rviz2")
    )
    assert hint.endswith(f"package.xml:{lines}")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "entity"),
    [
        ("import xacro", KNOWN),
        ("from xacro import process_file", KNOWN),
        ("from sensor_msgs.msg import Image; import xacro", KNOWN),
        ("", f"ExecuteProcess(cmd=['echo', {XACRO}]), {KNOWN}"),
    ],
)
def test_what_is_imported_or_run_must_be_declared(
    space: InstallSpace, before: str, entity: str
) -> None:
    manifest = MANIFEST.format("<depend>sensor_msgs</depend>")
    space.add("my_robot", {"package.xml": manifest, "a.urdf": "<robot name='a'/>"})
    plan = space.play(entity, before=before)
    found = [one for one in plan.diagnostics if one.code == "LCH045"]
    assert [one.message for one in found] == [
        "package.xml does not declare xacro, which the launch file uses."
    ]


@pytest.mark.slow
def test_an_import_that_may_fail_need_not_be_declared(space: InstallSpace) -> None:
    space.add("my_robot", {"package.xml": MANIFEST.format("")})
    before = """
        try:
            import xacro
        except ImportError:
            xacro = None
        """
    assert_goes_on(space.play(KNOWN, before=before))


@pytest.mark.slow
@pytest.mark.parametrize(
    "entity",
    [
        "Node(package='slam_tolbox', executable='x')",
        INCLUDE.format("slam_tolbox"),
        "Node(package='rviz2', executable='rviz2', arguments=[FindPackageShare('slam_tolbox')])",
        READ.format("slam_tolbox"),
    ],
)
def test_a_package_that_nobody_knows_is_reported_once(space: InstallSpace, entity: str) -> None:
    plan = space.play(f"\n{entity}, {INCLUDE.format('slam_tolbox')}, {KNOWN}")
    assert_goes_on(plan, "LCH007")
    assert "`slam_toolbox`" in (plan.diagnostics[0].hint or "")
    assert plan.diagnostics[0].element == "slam_tolbox"


@pytest.mark.slow
def test_a_package_that_the_launch_file_can_do_without(space: InstallSpace) -> None:
    before = """
        try:
            share = get_package_share_directory('no_such_robot')
        except PackageNotFoundError:
            share = None
        """
    assert_goes_on(space.play(f"ExecuteProcess(cmd=[str(share)]), {KNOWN}", before=before))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entity", "code"),
    [
        (INCLUDE.format("other"), "LCH017"),
        (INCLUDE.format("asking"), "LCH011"),
        (INCLUDE.format("importing"), "LCH002"),
        ("IncludeLaunchDescription([FindPackageShare('other'), '/launch/no.launch.py'])", "LCH005"),
        ("OpaqueFunction(function=lambda _: os.environ['NOT_SET'])", "LCH020"),
        ("SetEnvironmentVariable('X', EnvironmentVariable('NOT_SET'))", "LCH020"),
        ("OpaqueFunction(function=lambda _: open(str(rclpy.file)))", "LCH024"),
        ("OpaqueFunction(function=lambda _: subprocess.run(['no_such_program']))", "LCH024"),
        (READ.format("rplidar_ros"), "LCH007"),
    ],
)
def test_what_ends_one_branch(space: InstallSpace, entity: str, code: str) -> None:
    space.add("other", {"launch/a.launch.py": "from launch.actions import NoSuchAction\n"})
    space.add("asking", {"launch/a.launch.py": "input('which? ')\n"})
    space.add("importing", {"launch/a.launch.py": "import no_such_module\n"})
    plan = space.play(f"{entity}, {KNOWN}", before="import rclpy, subprocess")
    assert_goes_on(plan, code)


@pytest.mark.slow
def test_what_waits_for_a_node_that_is_left_out(space: InstallSpace) -> None:
    plan = space.play(
        f"node, RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[{KNOWN}]))",
        before="node = ExecuteProcess(cmd=[EnvironmentVariable('NOT_SET')])",
    )
    assert_goes_on(plan, "LCH020")


@pytest.mark.slow
def test_an_argument_whose_default_is_not_there(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('a', default_value=EnvironmentVariable('NOT_SET')), "
        f"SetLaunchConfiguration('b', EnvironmentVariable('NOT_SET')), "
        f"ExecuteProcess(cmd=[LaunchConfiguration('a'), LaunchConfiguration('b')]), {KNOWN}"
    )
    assert_goes_on(plan, "LCH020")
    assert plan.processes[0].command == ("$(var a)", "$(var b)")


@pytest.mark.slow
def test_a_mistake_ends_the_launch(space: InstallSpace) -> None:
    plan = space.play(f"LogInfo(msg=LaunchConfiguration('no')), {KNOWN}")
    assert codes(plan) == ["LCH009"]
    assert not plan.is_complete


@pytest.mark.slow
@pytest.mark.parametrize("declared", ["rclcpp", "no_such_library"])
def test_a_program_that_is_not_compiled_here(space: InstallSpace, declared: str) -> None:
    manifest = MANIFEST.format(f"<depend>{declared}</depend>")
    space.add("my_robot", {"package.xml": manifest})
    space.add_program("my_robot", "talker.py")
    plan = space.play(
        "Node(package='my_robot', executable='driver'), "
        f"Node(package='my_robot', executable='talkerr.py'), {KNOWN}"
    )
    found = codes(plan)
    assert found == (["LCH021", "LCH046"] if declared == "rclcpp" else ["LCH021", "LCH021"])
    if declared == "rclcpp":
        assert "driver of my_robot (line " in plan.diagnostics[-1].message
    assert [process.executable for process in plan.processes] == ["driver", "talkerr.py", None]


@pytest.mark.slow
def test_a_program_that_a_build_left_out(space: InstallSpace) -> None:
    space.add("my_robot")
    space.add_program("my_robot", "noisy_driver.py")
    folder = space.prefix.parent / "build" / "my_robot"
    folder.mkdir(parents=True)
    (folder / LEFT_OUT).write_text("missing rclcpp\ntarget noisy_driver\n")
    plan = space.play("Node(package='my_robot', executable='noisy_driver')")
    assert codes(plan) == ["LCH046"]
    assert plan.diagnostics[0].message.startswith("Not compiled, and left out: noisy_driver of")
    assert "`wsgen build` compiles them" in (plan.diagnostics[0].hint or "")
    assert codes(space.play("Node(package='my_robot', executable='noisy_drive')")) == ["LCH021"]


@pytest.mark.slow
def test_undeclared_packages_of_an_included_file_of_a_source_folder(
    space: InstallSpace, tmp_path: Path
) -> None:
    included = (
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([Node(package='rplidar_ros', executable='x')])\n"
    )
    source = space.add(
        "my_robot", {"package.xml": MANIFEST.format(""), "launch/a.launch.py": included}
    )
    plan = space.play(
        f"{INCLUDE.format('my_robot')}, {KNOWN}",
        environment=serve_sources({"my_robot": source}, tmp_path / "prefixes", {}),
    )
    assert_goes_on(plan, "LCH045")
    assert "<exec_depend>rplidar_ros</exec_depend>" in (plan.diagnostics[0].hint or "")


@pytest.mark.slow
def test_a_program_of_a_package_that_is_not_built(space: InstallSpace, tmp_path: Path) -> None:
    source, folder = tmp_path / "talkers", tmp_path / "prefixes"
    source.mkdir()
    environment = serve_sources({"talkers": source}, folder, {})
    path = f"{space.prefix}{os.pathsep}{environment.pop('AMENT_PREFIX_PATH')}"
    plan = space.play(
        f"Node(package='talkers', executable='talker'), {KNOWN}",
        environment={**environment, "AMENT_PREFIX_PATH": path},
    )
    assert_goes_on(plan)


@pytest.mark.slow
def test_a_module_of_a_package_that_is_not_built(space: InstallSpace, tmp_path: Path) -> None:
    source, folder = tmp_path / "talkers", tmp_path / "prefixes"
    (source / "talkers").mkdir(parents=True)
    (source / "talkers" / "__init__.py").write_text("from talkers.words import WORD\n")
    (source / "talkers" / "words.py").write_text("WORD = 'known'\n")
    environment = serve_sources({"talkers": source}, folder, {})
    path = f"{space.prefix}{os.pathsep}{environment.pop('AMENT_PREFIX_PATH')}"
    plan = space.play(
        "ExecuteProcess(cmd=[WORD])",
        before="from talkers import WORD",
        environment={**environment, "AMENT_PREFIX_PATH": path},
    )
    assert_goes_on(plan)
    assert not [*source.rglob("*.pyc")]  # the sources are the user's


@pytest.mark.slow
def test_a_xacro_file_of_a_package_that_is_not_installed(space: InstallSpace) -> None:
    text = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
    <xacro:include filename="$(find realsense2_description)/urdf/_d435.urdf.xacro"/></robot>"""
    share = space.add("my_robot", {"r.xacro": text})
    command = f"Command(['xacro ', '{share}/r.xacro'])"
    plan = space.play(f"Node(package='rviz2', executable='rviz2', arguments=[{command}]), {KNOWN}")
    assert_goes_on(plan, "LCH007")
    (found,) = plan.diagnostics
    assert found.element == "realsense2_description"
    assert (found.file, found.line) == (share / "r.xacro", 2)


@pytest.mark.slow
def test_modules_of_released_packages_are_unknown(space: InstallSpace) -> None:
    plan = space.play(
        f"ExecuteProcess(cmd=[str(cv_bridge.CvBridge())]), {KNOWN}", before="import cv_bridge"
    )
    assert_goes_on(plan)
    assert plan.processes[0].command == ("$(cv_bridge.CvBridge())",)


@pytest.mark.slow
def test_modules_that_rosdep_installs_are_unknown(space: InstallSpace) -> None:
    plan = space.play(f"ExecuteProcess(cmd=[str(smbus.SMBus())]), {KNOWN}", before="import smbus")
    assert_goes_on(plan)
    assert plan.processes[0].command == ("$(smbus.SMBus())",)

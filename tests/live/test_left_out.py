"""What cannot run here is named, and what stands in the place of the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.launching.known_packages import prefix
from wsgen.live.replacements import BuiltIn, LeftOut, find_component, find_replacement
from wsgen.packages.source_shares import VARIABLE

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from live_launch import Launch

RVIZ = """
        rviz = Node(package='rviz2', executable='rviz2')
        return LaunchDescription([
            rviz, Node(package='rviz2', executable='rviz2'),
            RegisterEventHandler(OnProcessStart(target_action=rviz,
                                                on_start=[LogInfo(msg='and on')])),
            ExecuteProcess(cmd=['gzclient']),
            python("print('there')", name='node'),
        ])
        """


@pytest.mark.slow
def test_what_cannot_run_is_named_once_and_left_out(launch: Callable[..., Launch]) -> None:
    run = launch(RVIZ)
    assert run.wait() == 0
    assert run.output.count("rviz2 of rviz2 is left out: it draws with libraries that PyPI") == 1
    assert run.output.count("[WARNING]") == 1
    assert "gzclient is left out" in run.output
    assert "[INFO] [launch.user]: and on" in run.lines
    assert "[node-4] there" in run.lines


@pytest.mark.slow
def test_a_launch_of_which_all_is_left_out_has_failed(launch: Callable[..., Launch]) -> None:
    run = launch("return LaunchDescription([Node(package='rviz2', executable='rviz2')])")
    assert run.wait() == 4
    assert "[ERROR] [launch]: nothing has run: all that the launch file starts" in run.output


@pytest.mark.slow
def test_windows_of_gazebo_are_not_missed(launch: Callable[..., Launch]) -> None:
    run = launch("return LaunchDescription([ExecuteProcess(cmd=['gzclient'])])")
    assert run.wait() == 0
    assert "[ERROR]" not in run.output


@pytest.mark.slow
def test_an_own_program_that_is_not_built_ends_the_launch_as_in_ros(
    launch: Callable[..., Launch], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "prefix/share/ament_index/resource_index/packages").mkdir(parents=True)
    (tmp_path / "prefix/share/ament_index/resource_index/packages/rover").touch()
    (tmp_path / "prefix/share/rover").mkdir()
    monkeypatch.setenv(VARIABLE, str(tmp_path))  # a source folder serves as the share folder
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'prefix'}:{prefix()}")
    run = launch(
        """
        return LaunchDescription([
            python("import time; time.sleep(60)"), Node(package='rover', executable='drive.py'),
        ])
        """
    )
    assert run.wait() == 1
    assert (
        "drive.py of rover cannot be started: rover is not built; run `wsgen build`" in run.output
    )


def test_a_window_of_sliders_is_the_plain_publisher_and_told() -> None:
    name = "joint_state_publisher_gui"
    found = find_replacement(name, name, (), is_sourced=False)
    assert found is not None
    assert isinstance(found.replacement, BuiltIn)
    assert found.replacement.module == "wsgen.live.nodes.joint_state_publisher"
    assert "without a window of sliders" in found.replacement.note
    assert find_replacement(name, name, (), is_sourced=True) is None


@pytest.mark.slow
def test_strict_makes_it_an_error(launch: Callable[..., Launch]) -> None:
    run = launch(RVIZ, is_strict=True)
    assert run.wait() == 1
    assert "[ERROR] [launch]: rviz2 of rviz2 cannot run: " in run.output


@pytest.mark.slow
def test_a_program_that_does_not_exist_ends_nothing_else(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        return LaunchDescription([
            ExecuteProcess(cmd=['/no/such/program', 'word']), python("print('there')"),
            Node(package='no_such_prefix', executable='teleop', prefix='no_such_terminal -e')
            if False else LogInfo(msg='x'),
            ExecuteProcess(cmd=['true'], prefix='no_such_terminal -e', name='key'),
        ])
        """
    )
    assert run.wait() == 0
    said = "[ERROR] [program-1]: exception occurred while executing process: /no/such/program word"
    assert f"{said}: No such file or directory" in run.lines
    assert "true is left out: no_such_terminal, which is to run it, is not installed" in run.output
    assert "[node-2] there" in run.lines


@pytest.mark.parametrize(
    ("package", "program", "arguments", "module", "given"),
    [
        ("gazebo_ros", "spawn_entity.py", ("-entity", "a"), "create", ("-entity", "a")),
        (None, "gz", ("sim", "-r", "a.sdf"), "simulator", ("sim", "-r", "a.sdf")),
        (None, "ign", ("gazebo", "-r a.sdf"), "simulator", ("gazebo", "-r a.sdf")),
        (None, "gzserver", (), "simulator", ()),
        (
            None,
            "ros2",
            ("control", "load_controller", "--set-state", "active", "arm"),
            "controller_spawner",
            ("arm",),
        ),
        (
            None,
            "ros2",
            ("control", "load_controller", "--set-state=inactive", "arm"),
            "controller_spawner",
            ("arm", "--inactive"),
        ),
    ],
)
def test_programs_that_wsgen_has(
    package: str | None,
    program: str,
    arguments: tuple[str, ...],
    module: str,
    given: tuple[str, ...],
) -> None:
    found = find_replacement(package, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.replacement, BuiltIn)
    assert found.replacement.module == f"wsgen.live.nodes.{module}"
    assert found.arguments == given


@pytest.mark.parametrize(
    ("program", "arguments", "reported"),
    [
        ("gz", ("sim", "-r -v 4", "a.sdf"), ()),
        ("gz", ("sim", "-v 4", "a.sdf"), ("--waits-for-play",)),
        ("gzserver", ("a.world",), ()),
        ("gzserver", ("a.world", "--pause"), ("--paused",)),
        ("gzserver", ("-u", "a.world"), ("--paused",)),
    ],
)
def test_how_a_simulation_begins(
    program: str, arguments: tuple[str, ...], reported: tuple[str, ...]
) -> None:
    found = find_replacement(None, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.replacement, BuiltIn)
    assert found.replacement.arguments == reported


@pytest.mark.parametrize(
    ("package", "program", "arguments"),
    [
        ("rviz2", "rviz2", ()),
        (None, "gz", ("topic", "-l")),
        (None, "gz", ("sim", "-g")),
        (None, "ros2", ("bag", "record")),
    ],
)
def test_programs_that_are_left_out(
    package: str | None, program: str, arguments: tuple[str, ...]
) -> None:
    found = find_replacement(package, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.replacement, LeftOut)


def test_of_a_sourced_ros_only_gazebo_is_replaced() -> None:
    for package, program in (("rviz2", "rviz2"), ("robot_state_publisher",) * 2, (None, "ros2")):
        assert find_replacement(package, program, ("topic",), is_sourced=True) is None
    for package, program in (("ros_gz_sim", "create"), (None, "gzserver"), (None, "gzclient")):
        assert find_replacement(package, program, (), is_sourced=True) is not None


def test_other_programs_run_themselves() -> None:
    assert find_replacement("my_robot", "driver.py", (), is_sourced=False) is None
    assert find_replacement(None, "bash", (), is_sourced=False) is None


@pytest.mark.slow
@pytest.mark.parametrize("is_strict", [False, True])
def test_nodes_for_containers_are_named_and_the_container_is_not(
    launch: Callable[..., Launch], is_strict: bool
) -> None:
    run = launch(
        """
        from launch_ros.descriptions import ComposableNode
        node = ComposableNode(package='camera', plugin='camera::Proc', name='proc')
        return LaunchDescription([
            ComposableNodeContainer(package='rclcpp_components', name='box', namespace='',
                                    executable='component_container',
                                    composable_node_descriptions=[node]),
            LoadComposableNodes(target_container='box', composable_node_descriptions=[node]),
            python("print('there')"),
        ])
        """,
        is_strict=is_strict,
    )
    assert run.wait() == (1 if is_strict else 0)
    said = "camera::Proc of camera cannot run: " if is_strict else "camera::Proc of camera is left"
    assert run.output.count(said) == 1
    assert "[INFO] [launch]: component_container of rclcpp_components is left out" in run.output
    assert is_strict or "[node-2] there" in run.lines


def test_containers_of_a_sourced_ros_load_all_but_what_asks_for_gazebo() -> None:
    assert find_component("camera::Proc", is_sourced=True) is None
    publisher = "robot_state_publisher::RobotStatePublisher"
    assert find_component(publisher, is_sourced=True) is None
    assert find_component(publisher, is_sourced=False) == (
        "robot_state_publisher",
        "robot_state_publisher",
    )
    for is_sourced in (True, False):
        bridge = find_component("ros_gz_bridge::RosGzBridge", is_sourced=is_sourced)
        assert bridge == ("ros_gz_bridge", "bridge_node")


@pytest.mark.slow
def test_what_ros2_launch_starts_of_packages_that_are_not_installed(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        return LaunchDescription([
            ExecuteProcess(cmd=['ros2', 'launch', 'gazebo_ros', 'gzclient.launch.py']),
            ExecuteProcess(cmd=['ros2', 'launch', 'slam_toolbox', 'online_async_launch.py']),
            python("print('there')", name='node'),
        ])
        """
    )
    assert run.wait() == 0
    assert "gzclient is left out: wsgen simulates in the place of Gazebo" in run.output
    assert "online_async_launch.py of slam_toolbox is left out: it is not installed" in run.output
    assert run.output.count("left out") == 2

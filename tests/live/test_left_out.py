"""What cannot run here is named, and what stands in the place of the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.live.programs import LeftOut, Ours, find_stand

if TYPE_CHECKING:
    from collections.abc import Callable

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


def test_what_cannot_run_is_named_once_and_left_out(launch: Callable[..., Launch]) -> None:
    run = launch(RVIZ)
    assert run.wait() == 0
    assert run.output.count("rviz2 of rviz2 is left out: it draws with libraries that PyPI") == 1
    assert run.output.count("[WARNING]") == 1
    assert "gzclient is left out" in run.output
    assert "[INFO] [launch.user]: and on" in run.lines
    assert "[node-4] there" in run.lines


def test_strict_makes_it_an_error(launch: Callable[..., Launch]) -> None:
    run = launch(RVIZ, is_strict=True)
    assert run.wait() == 1
    assert "[ERROR] [launch]: rviz2 of rviz2 cannot run: " in run.output


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
    found = find_stand(package, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.stand, Ours)
    assert found.stand.module == f"wsgen.ros_nodes.{module}"
    assert found.arguments == given


@pytest.mark.parametrize(
    ("program", "arguments", "told"),
    [
        ("gz", ("sim", "-r -v 4", "a.sdf"), ()),
        ("gz", ("sim", "-v 4", "a.sdf"), ("--waits-for-play",)),
        ("gzserver", ("a.world",), ()),
        ("gzserver", ("a.world", "--pause"), ("--paused",)),
        ("gzserver", ("-u", "a.world"), ("--paused",)),
    ],
)
def test_how_a_simulation_begins(
    program: str, arguments: tuple[str, ...], told: tuple[str, ...]
) -> None:
    found = find_stand(None, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.stand, Ours)
    assert found.stand.arguments == told


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
    found = find_stand(package, program, arguments, is_sourced=False)
    assert found is not None
    assert isinstance(found.stand, LeftOut)


def test_of_a_sourced_ros_only_gazebo_is_replaced() -> None:
    for package, program in (("rviz2", "rviz2"), ("robot_state_publisher",) * 2, (None, "ros2")):
        assert find_stand(package, program, ("topic",), is_sourced=True) is None
    for package, program in (("ros_gz_sim", "create"), (None, "gzserver"), (None, "gzclient")):
        assert find_stand(package, program, (), is_sourced=True) is not None


def test_other_programs_run_themselves() -> None:
    assert find_stand("my_robot", "driver.py", (), is_sourced=False) is None
    assert find_stand(None, "bash", (), is_sourced=False) is None

"""What is prepared of a launch file before it runs."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.building.last_build import FAILED_BUILD
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotFoundError
from wsgen.launching.launch_warnings import UNUSED_ARGUMENT
from wsgen.live.plan_checks import ABSENT_LAUNCH_MODULE, STARTS_NOTHING
from wsgen.live.prepare import BrokenRunError, Prepared, RunRequest, prepare
from wsgen.live.request import ServiceRequest
from wsgen.live.resolve import Resolver
from wsgen.model.plan import LaunchRequest
from wsgen.pipeline.plan_launch import select_launch_file
from wsgen.pipeline.requests import ValidateRequest
from wsgen.ros.environment import RosEnvironment

if TYPE_CHECKING:
    from collections.abc import Callable

HEAD = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess, SetEnvironmentVariable
from launch_ros.actions import Node

def generate_launch_description():
    # SPAWNER
    return LaunchDescription([
"""
SIMULATOR = "ExecuteProcess(cmd=['gz', 'sim', '-r', 'empty.sdf']),"
DOMAIN = "SetEnvironmentVariable('ROS_DOMAIN_ID', '30'),"
SPAWNER = "spawner = Node(package='gazebo_ros', executable='spawn_entity.py')"
NODE = "ExecuteProcess(cmd=['python3', 'spawns_later.py']),"


@pytest.fixture
def shown() -> list[Diagnostic]:
    """What is reported."""
    return []


@pytest.fixture
def prepared(tmp_path: Path, shown: list[Diagnostic]) -> Callable[..., Prepared]:
    """Prepares a launch file with some actions."""

    def run(
        *actions: str,
        before: str = "",
        is_stepped: bool = False,
        is_strict: bool = False,
        folder: Path = tmp_path,
        **arguments: str,
    ) -> Prepared:
        file = folder / "a.launch.py"
        text = HEAD.replace("# SPAWNER", before) + "\n".join(actions) + "])"
        file.write_text(text, encoding="utf-8")
        ros = RosEnvironment(
            distro="jazzy", is_sourced=True, python=Path(sys.executable), variables={}
        )
        with select_launch_file([str(file)], None) as selected:
            return prepare(
                selected,
                RunRequest(
                    prepared_as=ValidateRequest(
                        is_live=True, engines=("bullet",), launch_arguments=arguments
                    ),
                    is_stepped=is_stepped,
                    is_strict=is_strict,
                ),
                tmp_path,
                tmp_path,
                open_ros=lambda _messages: ros,
                expect=lambda _ros: None,
                show=shown.extend,
            )

    return run


def _no_robot(shown: list[Diagnostic]) -> Diagnostic:
    (found,) = [one for one in shown if one.name == "no-robot"]
    return found


@pytest.mark.slow
def test_robots_may_be_spawned_at_run_time(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    found = prepared(SIMULATOR, NODE, is_strict=True)
    assert (found.has_simulator, found.has_spawner) == (True, False)
    assert _no_robot(shown).severity is Severity.INFO


@pytest.mark.slow
def test_a_spawner_that_is_forgotten_is_an_error(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    with pytest.raises(BrokenRunError):
        prepared(SIMULATOR, before=SPAWNER, is_strict=True)
    assert _no_robot(shown).severity is Severity.ERROR


@pytest.mark.slow
def test_an_argument_without_effect_is_reported(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    prepared(SIMULATOR, is_stepped=True, wrold="b.sdf")
    (found,) = [one for one in shown if one.code == UNUSED_ARGUMENT.code]
    assert (found.element, found.line) == ("wrold", None)


@pytest.mark.slow
@pytest.mark.parametrize("result", ["0", "1"])
def test_a_build_that_failed_is_reported(
    prepared: Callable[..., Prepared], shown: list[Diagnostic], tmp_path: Path, result: str
) -> None:
    package = tmp_path / "src" / "crane"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package format='3'><name>crane</name><version>0.0.1</version></package>"
    )
    (tmp_path / "build" / "crane").mkdir(parents=True)
    (tmp_path / "build" / "crane" / "colcon_build.rc").write_text(f"{result}\n")
    prepared(NODE, folder=package)
    codes = [one.code for one in shown if one.code == FAILED_BUILD.code]
    assert codes == [FAILED_BUILD.code] * int(result)


MOVEIT = "from moveit_configs_utils.launches import generate_demo_launch"


@pytest.mark.slow
@pytest.mark.parametrize("is_strict", [False, True])
def test_a_launch_file_that_starts_nothing_without_a_module(
    prepared: Callable[..., Prepared], *, is_strict: bool
) -> None:
    with pytest.raises(NotFoundError) as raised:
        prepared("generate_demo_launch()", before=MOVEIT, is_strict=is_strict)
    assert "a.launch.py starts nothing without the Python module moveit_configs_utils" in str(
        raised.value
    )
    assert "line 7 of a.launch.py imports it.\nmoveit_configs_utils is" in str(raised.value)


@pytest.mark.slow
def test_what_comes_from_an_absent_module_is_left_out(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    prepared("generate_demo_launch(),", NODE, before=MOVEIT)
    (found,) = [one for one in shown if one.code == ABSENT_LAUNCH_MODULE.code]
    assert (found.severity, found.line, found.element) == (
        Severity.WARNING,
        7,
        "moveit_configs_utils",
    )
    assert "launches.generate_demo_launch() starts is left out." in found.message
    with pytest.raises(BrokenRunError):
        prepared("generate_demo_launch(),", NODE, before=MOVEIT, is_strict=True)


@pytest.mark.slow
def test_an_absent_module_of_which_nothing_is_needed(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    before = "import rclpy.logging\n    rclpy.logging.get_logger('launch').info('begins')"
    prepared(NODE, before=before, is_strict=True)
    assert not [one for one in shown if one.code == ABSENT_LAUNCH_MODULE.code]


@pytest.mark.slow
def test_a_launch_file_that_starts_nothing(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    prepared(DOMAIN, is_strict=True)
    assert [one.code for one in shown] == [STARTS_NOTHING.code]
    shown.clear()
    prepared(NODE)
    assert not shown


@pytest.mark.slow
def test_the_domain_of_the_launch_file_is_not_that_of_a_session(
    prepared: Callable[..., Prepared],
) -> None:
    assert prepared(SIMULATOR, DOMAIN).set_by_launch == {"ROS_DOMAIN_ID": "30"}
    assert not prepared(SIMULATOR, DOMAIN, is_stepped=True).set_by_launch


def test_processes_of_a_session_are_in_its_domain(tmp_path: Path) -> None:
    environment = {"ROS_DOMAIN_ID": "7"}
    request = ServiceRequest(
        launch=LaunchRequest(launch_file=tmp_path / "a.launch.py", package=None, arguments={}),
        folder=tmp_path,
        python=Path(sys.executable),
        environment=environment,
        variables={"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"},
    )
    set_by_launch = {
        "ROS_DOMAIN_ID": "30",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "ROS_STATIC_PEERS": "10.0.0.1",
    }
    names = (*set_by_launch, "ROS_LOCALHOST_ONLY")
    for is_watched, expected in (
        (False, set_by_launch),
        (True, {**environment, **request.variables}),
    ):
        of_run = replace(request, is_watched=is_watched)
        resolver = Resolver(of_run, log_folder=None, simulator_folder=tmp_path)
        found = resolver.environment_of({**environment, **set_by_launch})
        assert {name: found[name] for name in names if name in found} == expected

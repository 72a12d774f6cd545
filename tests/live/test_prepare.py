"""What is prepared of a launch file before it runs."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launch.launch_warnings import UNUSED_ARGUMENT
from wsgen.live.prepare import BrokenRunError, Prepared, RunRequest, prepare
from wsgen.live.request import ServiceRequest
from wsgen.live.resolve import Resolver
from wsgen.model.plan import LaunchRequest
from wsgen.pipeline.plan_launch import select_launch_file
from wsgen.pipeline.requests import ValidateRequest
from wsgen.ros_environment import RosEnvironment

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
        **arguments: str,
    ) -> Prepared:
        file = tmp_path / "a.launch.py"
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


def test_robots_may_be_spawned_at_run_time(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    found = prepared(SIMULATOR, NODE, is_strict=True)
    assert (found.has_simulator, found.has_spawner) == (True, False)
    assert _no_robot(shown).severity is Severity.INFO


def test_a_spawner_that_is_forgotten_is_an_error(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    with pytest.raises(BrokenRunError):
        prepared(SIMULATOR, before=SPAWNER, is_strict=True)
    assert _no_robot(shown).severity is Severity.ERROR


def test_an_argument_without_effect_is_reported(
    prepared: Callable[..., Prepared], shown: list[Diagnostic]
) -> None:
    prepared(SIMULATOR, is_stepped=True, wrold="b.sdf")
    (found,) = [one for one in shown if one.code == UNUSED_ARGUMENT.code]
    assert (found.element, found.line) == ("wrold", None)


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

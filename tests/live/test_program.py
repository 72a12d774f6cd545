"""Programs that `wsgen run` starts, and the live run that they find."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from wsgen.errors import NotFoundError
from wsgen.isolation.parent import PREFIX, held
from wsgen.live.nodes.unanswered import Run
from wsgen.live.replacements import find_command
from wsgen.live.resolve import write_ros2
from wsgen.live.run import note_end, note_start
from wsgen.ros.environment import RosEnvironment
from wsgen.simulation.live_runs import (
    FOLDER_VARIABLE,
    REQUEST_FILE,
    STARTING_FILE,
    distro_of_run,
    find_live_folder,
    find_runs,
    find_simulator,
    launched_in,
    short_name,
    socket_path,
)

PYTHON = Path("/python")


def found_runs() -> list[tuple[str, str, str]]:
    """The runs, without when they have begun."""
    return [run[:3] for run in find_runs()]


def _ros(*, is_sourced: bool = False) -> RosEnvironment:
    return RosEnvironment(distro="kilted", is_sourced=is_sourced, python=PYTHON, variables={})


@pytest.fixture
def prefix(tmp_path: Path) -> Path:
    """An installed package with a node, a script of a shell, and a file that is no program."""
    folder = tmp_path / "lib" / "my_robot"
    folder.mkdir(parents=True)
    (folder / "driver").write_text("#!/usr/bin/env python3\n")
    (folder / "setup.sh").write_text("#!/bin/sh\n")
    (folder / "notes.txt").write_text("none\n")
    for name in ("driver", "setup.sh"):
        (folder / name).chmod(0o755)
    return tmp_path


def test_programs_run_with_the_interpreter_of_ros(prefix: Path) -> None:
    variables = {"AMENT_PREFIX_PATH": f"/nothing:{prefix}"}
    driver = str(prefix / "lib/my_robot/driver")

    def found(package: str, name: str, *words: str, is_sourced: bool = False) -> tuple[str, ...]:
        ros = _ros(is_sourced=is_sourced)
        return find_command(package, name, words, ros=ros, variables=variables)

    assert found("my_robot", "driver", "--ros-args") == ("/python", driver, "--ros-args")
    assert found("my_robot", "driver", is_sourced=True) == (driver,)
    assert found("my_robot", "setup.sh") == (str(prefix / "lib/my_robot/setup.sh"),)
    spawner = found("gazebo_ros", "spawn_entity.py", "-entity", "a")
    assert spawner[0] == "/python"
    assert spawner[-5:] == ("wsgen.live.nodes.create", "--as", "spawn_entity.py", "-entity", "a")


def test_what_no_package_has_is_named(prefix: Path) -> None:
    def problem(package: str, name: str) -> tuple[str, str]:
        with pytest.raises(NotFoundError) as caught:
            find_command(
                package, name, (), ros=_ros(), variables={"AMENT_PREFIX_PATH": str(prefix)}
            )
        return caught.value.message, caught.value.hint or ""

    message, hint = problem("my_robot", "drivr")
    assert message == "The package my_robot has no program `drivr`."
    assert "`driver`" in hint
    assert "Known: driver, setup.sh" in problem("my_robot", "notes.txt")[1]
    assert "`my_robot`" in problem("my_robt", "driver")[1]
    assert "PyPI does not have" in problem("rviz2", "rviz2")[0]


def test_a_live_run_of_the_same_domain_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    folder = tmp_path / f"{PREFIX}x" / "live"
    folder.mkdir(parents=True)
    launch = {"package": "rover", "launch_file": "/ws/share/run.launch.py"}
    request = {"environment": {}, "variables": {"ROS_DOMAIN_ID": "7"}, "launch": launch}
    (folder / REQUEST_FILE).write_text(json.dumps(request))
    assert find_live_folder({"ROS_DOMAIN_ID": "7"}) is None  # its simulator does not listen
    with socket.socket(socket.AF_UNIX) as listening:
        with short_name(socket_path(folder)) as name:
            listening.bind(name)
        listening.listen()
        assert find_live_folder({"ROS_DOMAIN_ID": "7"}) == folder
        assert launched_in(folder) == "rover run.launch.py"
        assert find_live_folder({}) is None
        own = tmp_path / f"{PREFIX}y" / "live"  # of a launch without a simulator
        own.mkdir(parents=True)
        mine = {"ROS_DOMAIN_ID": "7", FOLDER_VARIABLE: str(own)}
        for awaits, expected in ((False, folder), (True, own)):
            (own / REQUEST_FILE).write_text(json.dumps({**request, "awaits_simulator": awaits}))
            assert find_simulator(mine) == expected
        assert find_simulator({"ROS_DOMAIN_ID": "7"}) == folder
        assert find_simulator({"ROS_DOMAIN_ID": "8"}) is None
        with monkeypatch.context() as patch:
            patch.setattr("os.getuid", lambda: folder.stat().st_uid + 1)
            assert find_live_folder({"ROS_DOMAIN_ID": "7"}) is None  # another user's
            assert distro_of_run(folder) is None
        for text in ("{", "[]", "{}", '{"environment": {}}', '{"environment": 1, "variables": 2}'):
            (folder / REQUEST_FILE).write_text(text)
            assert find_live_folder({"ROS_DOMAIN_ID": "7"}) is None
            assert distro_of_run(folder) is None


def test_live_runs_are_known_as_long_as_they_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    launches: list[tuple[dict[str, str], dict[str, str | None]]] = [
        ({"ROS_DOMAIN_ID": "7"}, {"package": "rover", "launch_file": "/ws/share/run.launch.py"}),
        ({}, {"package": None, "launch_file": "/elsewhere/alone.launch.py"}),
    ]
    with ExitStack() as stack:
        for number, (variables, launch) in enumerate(launches):
            folder = tmp_path / f"{PREFIX}{number}" / "live"
            folder.mkdir(parents=True)
            request = {"environment": variables, "variables": {}, "launch": launch}
            (folder / REQUEST_FILE).write_text(json.dumps(request))
            assert len(find_runs()) == number  # nobody holds its folder
            stack.enter_context(held(str(folder.parent)))
        alone = ("0", "/elsewhere/alone.launch.py", "")
        assert found_runs() == [alone, ("7", "rover run.launch.py", "")]
        assert all(time.time() - 600 < run[3] < time.time() + 60 for run in find_runs())
        ended = tmp_path / f"{PREFIX}0" / "live"
        asked = [Run(*one) for one in find_runs()]
        assert not any(one.has_ended() for one in asked)
        note_end(ended, None)
        assert [one.has_ended() for one in asked] == [False, True]
        assert found_runs() == [alone]
        note_end(ended, Path("videos/x.gif"))
        assert found_runs() == [alone, ("7", "rover run.launch.py", "x.gif")]
    assert find_runs() == []


def test_a_run_that_is_prepared_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    live_folder = tmp_path / f"{PREFIX}1" / "live"
    live_folder.mkdir(parents=True)
    selected: Any = SimpleNamespace(package="rover", file=Path("/share/rover/run.launch.py"))
    note_start(live_folder, selected, {"ROS_DOMAIN_ID": "7"})
    assert find_runs() == []
    with held(str(live_folder.parent)):
        os.utime(live_folder / STARTING_FILE, (0, 0))
        (run,) = find_runs()
        assert run[3] > time.time() - 600  # its nodes are to come, however long that takes
        assert found_runs() == [("7", "rover run.launch.py", "")]
        (live_folder / STARTING_FILE).write_text("{")
        assert found_runs() == []
        selected.package = None
        note_start(live_folder, selected, {})
        assert found_runs() == [("0", "/share/rover/run.launch.py", "")]


@pytest.mark.slow
def test_scripts_find_a_ros2(tmp_path: Path) -> None:
    program = write_ros2(tmp_path, Path(sys.executable)) / "ros2"
    helped = subprocess.run([program, "run", "--help"], capture_output=True, text=True, check=True)
    assert "Run a program of a package" in helped.stdout
    refused = subprocess.run([program, "bag"], capture_output=True, text=True, check=False)
    assert refused.returncode == 4
    assert "ros2 bag is not installed" in refused.stderr

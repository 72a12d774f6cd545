"""What a process of a launch file becomes, and which of them is the user's."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from wsgen.live.journal import OTHER, SIMULATOR, SPAWNER, STANDARD
from wsgen.live.resolve import Resolved, Resolver


@pytest.mark.parametrize(
    ("package", "executable", "role"),
    [
        ("ros_gz_sim", "gzserver", SIMULATOR),
        ("ros_gz_sim", "create", SPAWNER),
        ("ros_gz_bridge", "parameter_bridge", STANDARD),
        ("robot_state_publisher", "robot_state_publisher", STANDARD),
        ("rover", "driver", OTHER),
    ],
)
@pytest.mark.parametrize("is_sourced", [False, True])
def test_programs_of_ros_are_distinguished_from_those_of_the_user(
    package: str, executable: str, role: str, *, is_sourced: bool, tmp_path: Path
) -> None:
    """Where ROS is sourced, its own robot_state_publisher runs, which is not the user's either."""
    path = tmp_path / executable
    path.write_text("#!/bin/sh\n", encoding="utf-8")
    process = SimpleNamespace(
        command=None, package=package, executable=executable, arguments=(), parameters={}
    )
    start = SimpleNamespace(
        process=process,
        package=package,
        executable=executable,
        path=str(path),
        prefix=(),
        words=(),
        is_shell=False,
    )
    request = SimpleNamespace(is_sourced=is_sourced, python=Path("python3"))
    resolver = Resolver(
        cast("Any", request), log_folder=None, simulator_folder=tmp_path / "simulator"
    )
    found = resolver.resolve(cast("Any", start))
    assert isinstance(found, Resolved)
    assert found.role == role

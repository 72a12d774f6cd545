"""What the launch files of Gazebo's packages start, which are not installed."""

from __future__ import annotations

import sys
import types
from pathlib import Path
from typing import Any

import pytest

from wsgen.errors import RequestError
from wsgen.live.resolve import entities_of
from wsgen.model.plan import Include


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"world": "a.world"}, ["a.world"]),
        (
            {"extra_gazebo_args": "--ros-args --params-file 'my rates.yaml'"},
            ["", "--ros-args", "--params-file", "my rates.yaml"],
        ),
        (
            {"params_file": "a.yaml", "extra_gazebo_args": "--verbose", "pause": "true"},
            ["", "--pause", "--ros-args", "--params-file", "a.yaml", "--", "--verbose"],
        ),
        ({"extra_gazebo_args": "it's"}, ["", "it's"]),
    ],
)
def test_parameters_reach_gazebo(
    arguments: dict[str, str], words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As gazebo_ros_pkgs, gazebo_ros/launch/gzserver.launch.py, passes them on."""
    actions: Any = types.ModuleType("launch.actions")
    actions.ExecuteProcess = actions.Shutdown = types.SimpleNamespace
    monkeypatch.setitem(sys.modules, "launch", types.ModuleType("launch"))
    monkeypatch.setitem(sys.modules, "launch.actions", actions)
    for file, count in (("gzserver.launch.py", 1), ("gazebo.launch.py", 2)):
        include = Include(package="gazebo_ros", file=Path(file), arguments=arguments)
        found = entities_of(include)
        assert found is not None
        assert len(found) == count  # the second one is the client's
        assert found[0].cmd == ["gzserver", *words]


@pytest.mark.parametrize(
    ("file", "arguments", "problem"),
    [
        (
            "gz_sim.launch.py",
            {"gz_args": "-r 'empty.sdf"},
            "gz_args has a quotation mark without its other one: -r 'empty.sdf",
        ),
        ("gz_sim.launch.py", {"ign_args": '"'}, "ign_args has a quotation mark without"),
        ("gz_spawn_model.launch.py", {"R": "up"}, "R is `up`, which is not a number."),
    ],
)
def test_arguments_that_make_no_sense_are_named(
    file: str, arguments: dict[str, str], problem: str
) -> None:
    with pytest.raises(RequestError) as caught:
        entities_of(Include(package="ros_gz_sim", file=Path(file), arguments=arguments))
    assert caught.value.message.startswith(problem)

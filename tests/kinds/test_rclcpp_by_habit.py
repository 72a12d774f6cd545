"""A package of models that asks CMake for libraries of ROS, and compiles nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_rclcpp_by_habit(tmp_path: Path) -> None:
    workspace = copy_workspace("rclcpp_by_habit", tmp_path)
    built = workspace.wsgen("build", "--strict", "--format", "json")
    assert built.code == 0, built.output
    assert {one["code"] for one in built.document["diagnostics"]} == {"BLD001", "BLD030"}
    share = workspace.root / "install" / "snail_gazebo" / "share" / "snail_gazebo"
    installed = {entry.name for entry in share.iterdir() if entry.is_dir()}
    assert {"launch", "models", "worlds"} <= installed
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.output
    (package,) = answer.document["packages"]
    assert [robot["entity"] for robot in package["robots"]] == ["snail"]

"""Mapping, teleoperation, RViz and Nav2 are not installed: the robot is simulated all the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_missing_helpers(tmp_path: Path) -> None:
    workspace = copy_workspace("missing_helpers", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert answer.code == 0, answer.output
    assert [robot["entity"] for robot in package["robots"]] == ["rover"]
    found = {one["code"]: one for one in package["diagnostics"]}
    assert found.keys() == {"LCH045", "LCH046"}
    assert "<exec_depend>slam_toolbox</exec_depend>" in found["LCH045"]["hint"]
    assert "navigation_launch.py of nav2_bringup" in found["LCH046"]["message"]

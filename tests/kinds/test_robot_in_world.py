"""Robots that are models of the world are simulated like spawned ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_robots_of_the_world(tmp_path: Path) -> None:
    workspace = copy_workspace("robot_in_world", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.errors
    (package,) = answer.document["packages"]
    assert [robot["entity"] for robot in package["robots"]] == ["cart", "turntable"]
    assert all(robot["rest"] for robot in package["robots"])
    assert not package["diagnostics"]

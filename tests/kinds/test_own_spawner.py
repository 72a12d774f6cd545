"""What a spawner of somebody's own spawns is assumed, and said to be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_own_spawner(tmp_path: Path) -> None:
    workspace = copy_workspace("own_spawner", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.errors
    (package,) = answer.document["packages"]
    (robot,) = package["robots"]
    assert robot["entity"] == "own_cart"
    assert robot["rest"]
    (found,) = package["diagnostics"]
    assert (found["code"], found["severity"]) == ("SPN092", "info")


@pytest.mark.slow
def test_own_spawner_of_another_name_without_a_simulator(tmp_path: Path) -> None:
    workspace = copy_workspace("own_spawner", tmp_path)
    launch_file = workspace.root / "src/own_cart/launch/cart.launch.py"
    text = launch_file.read_text()
    include = "        IncludeLaunchDescription(PythonLaunchDescriptionSource(gazebo)),\n"
    assert include in text
    launch_file.write_text(text.replace(include, ""))
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert [robot["entity"] for robot in package["robots"]] == ["own_cart"]

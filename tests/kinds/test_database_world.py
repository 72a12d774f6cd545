"""A world of models that Gazebo Classic downloads, and the empty world of gazebo_ros."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


def test_it_stands_in_both(tmp_path: Path) -> None:
    workspace = copy_workspace("database_world", tmp_path)
    assert workspace.wsgen("build").code == 0
    cafe = workspace.root / "src/waiter_gazebo/worlds/cafe.world"
    for world, more in ((), []), (("--arg", f"world:={cafe}"), [("WLD062", "info")]):
        answer = workspace.wsgen("validate", "--format", "json", *world)
        assert answer.code == 0, answer
        (package,) = answer.document["packages"]
        (waiter,) = package["robots"]
        assert waiter["rest"]["xyz"][2] == pytest.approx(0.0, abs=0.001)
        found = [(one["code"], one["severity"]) for one in package["diagnostics"]]
        assert sorted(found) == [("ROB037", "warning"), ("ROB051", "info"), *more]

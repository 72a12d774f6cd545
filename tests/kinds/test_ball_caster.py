"""A robot on two wheels and a ball joint, spawned into a terrace of its world."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace
from wsgen.simulation.run import missing_engines

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("engine", ["bullet", "dart"])
def test_it_stays_upright(engine: str, tmp_path: Path) -> None:
    if missing_engines([engine]):
        pytest.skip(f"{engine} is not installed")
    workspace = copy_workspace("ball_caster", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json", "--engine", engine)
    (package,) = answer.document["packages"]
    (scout,) = package["robots"]
    assert scout["simulated"]["movable_joints"] == 3
    assert [found["code"] for found in package["diagnostics"]] == ["SPN063"]
    rest = scout["rest"]
    assert rest["rpy"] == pytest.approx((0.0, 0.0, 0.0), abs=0.01)
    assert 0.24 < rest["xyz"][2] < 0.301  # where it was spawned, and on the terrace

"""World and robot are expanded into files when the launch starts; at its end, one is removed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_files_that_xacro_writes(tmp_path: Path) -> None:
    workspace = copy_workspace("xacro_to_file", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert answer.code == 0, answer.output
    assert not package["diagnostics"]
    assert package["world"]["name"] == "depot"
    assert package["world"]["file"].endswith("depot_bot/worlds/depot.sdf.xacro")
    (robot,) = package["robots"]
    assert robot["simulated"]["mass"] == pytest.approx(2.5)
    assert robot["rest"]["xyz"][2] == pytest.approx(0.3, abs=0.001)  # on the floor of the world
    assert not (workspace.root / "bot.urdf").exists()

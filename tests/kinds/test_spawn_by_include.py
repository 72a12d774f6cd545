"""A bringup package that includes the simulation of another one."""

from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_the_outer_launch_file_is_simulated(tmp_path: Path) -> None:
    workspace = copy_workspace("spawn_by_include", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.errors
    (row,) = answer.document["packages"]
    assert row["package"] == "crane_bringup"
    (robot,) = row["robots"]
    assert robot["rest"]["xyz"][0] == pytest.approx(0.5, abs=0.01)
    assert {one["package"]: one["reason"] for one in answer.document["not_validated"]} == {
        "crane_description": "robot spawned by crane_bringup",
        "crane_sim": "included by crane_bringup crane.launch.xml",
    }
    files = {found["file"] for found in row["diagnostics"] if found["file"]}
    assert all(file.startswith(str(workspace.root / "src")) for file in files)
    # What the simulated launch file uses must be built, too.
    urdf = workspace.root / "src" / "crane_description" / "urdf" / "crane.urdf.xacro"
    urdf.write_text(urdf.read_text().replace('mass="4"', 'mass="5"'))
    (row,) = workspace.wsgen("validate", "--format", "json").document["packages"]
    changed = [found["file"] for found in row["diagnostics"] if found["code"] == "PKG052"]
    assert changed == [str(urdf)]
    # By itself it lacks an argument.
    alone = workspace.wsgen("validate", "crane_sim", "--format", "json")
    assert alone.code == 1
    (row,) = alone.document["packages"]
    (error,) = (found for found in row["diagnostics"] if found["severity"] == "error")
    assert (error["code"], error["element"]) == ("LCH006", "x")
    assert workspace.wsgen("validate", "crane_sim", "--arg", "x:=1").code == 0

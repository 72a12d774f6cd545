"""Descriptions in packages of their own: one that bringup spawns, one that nothing spawns."""

from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_a_description_is_found_through_what_spawns_it(tmp_path: Path) -> None:
    workspace = copy_workspace("split_description", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.errors
    (row,) = answer.document["packages"]
    assert (row["package"], row["passed"]) == ("picker_bringup", True)
    left = {one["package"]: one for one in answer.document["not_validated"]}
    assert left["picker_description"]["reason"] == "robot spawned by picker_bringup"
    assert left["camera_mast_description"]["reason"] == "spawns no robot"
    file = "src/camera_mast_description/urdf/camera_mast.urdf.xacro"
    assert left["camera_mast_description"]["robot_files"] == [str(workspace.root / file)]
    assert f"try: wsgen validate {file}" in workspace.wsgen("validate", "-q").output

"""A package of the MoveIt setup assistant beside the arm that it is for."""

from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_settings_are_no_failure(tmp_path: Path) -> None:
    workspace = copy_workspace("moveit_settings", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.errors
    assert [row["package"] for row in answer.document["packages"]] == ["welder_sim"]
    alone = workspace.wsgen("validate", "welder_moveit_config", "--format", "json")
    assert (alone.code, alone.document["packages"]) == (0, [])
    for document in (answer.document, alone.document):
        (left,) = document["not_validated"]
        assert (left["package"], left["reason"]) == ("welder_moveit_config", "spawns no robot")

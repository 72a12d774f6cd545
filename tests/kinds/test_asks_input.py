"""A launch file asks on standard input which of two robots to spawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_answers(tmp_path: Path) -> None:
    workspace = copy_workspace("asks_input", tmp_path)
    assert workspace.wsgen("build").code == 0
    options = ("validate", "--format", "json")
    (unanswered,) = workspace.wsgen(*options).document["packages"]
    (found,) = unanswered["diagnostics"]
    assert found["code"] == "LCH011"
    asked = "`Which arm? (1) the small one (2) the large one Please select:`"
    assert asked in found["message"]
    assert "--answer TEXT" in found["hint"]
    for arguments, given in (((), "2\n1\n"), (("--answer", "2", "--answer", "1"), None)):
        answer = workspace.wsgen(*options, *arguments, given=given)
        assert answer.code == 0, answer.output
        (robot,) = answer.document["packages"][0]["robots"]
        assert robot["entity"] == "arm2_gripper"
    too_few = workspace.wsgen(*options, "--answer", "2").document["packages"][0]["diagnostics"]
    assert "`Has it got a gripper? (1) yes (2) no" in too_few[0]["message"]
    planned = workspace.wsgen("launch", "choosy_arm", "arm.launch.py", given="1\n2\n")
    assert "-name arm1\n" in planned.output

"""The description, the simulator and the spawner are started from three terminals."""

from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_the_description_is_that_of_another_launch_file(tmp_path: Path) -> None:
    workspace = copy_workspace("three_terminals", tmp_path)
    answer = workspace.wsgen("validate", "--format", "json", "--seconds", "0.5")
    assert answer.code == 0, answer.output
    (row,) = answer.document["packages"]
    assert Path(row["launch_file"]).name == "spawn.launch.py"
    assert [robot["entity"] for robot in row["robots"]] == ["crate"]
    (reported,) = [one for one in row["diagnostics"] if one["code"] == "LCH066"]
    assert "crate_bot rsp.launch.py publishes the robot description" in reported["message"]
    assert "SPN008" not in {one["code"] for one in row["diagnostics"]}


def test_two_descriptions_or_none(tmp_path: Path) -> None:
    workspace = copy_workspace("three_terminals", tmp_path)
    launch = workspace.root / "src" / "crate_bot" / "launch"
    publisher = launch / "rsp.launch.py"
    text = publisher.read_text()
    other = text.replace("file.read()", "file.read().replace('4.0', '5.0')")
    (launch / "heavy.launch.py").write_text(other)
    for _ in range(2):
        answer = workspace.wsgen("validate", "--format", "json")
        assert answer.code == 1
        (row,) = answer.document["packages"]
        assert not row["robots"]
        errors = [one["code"] for one in row["diagnostics"] if one["severity"] == "error"]
        assert errors == ["SPN008"]
        publisher.unlink(missing_ok=True)
        (launch / "heavy.launch.py").unlink(missing_ok=True)


def test_the_publisher_cannot_be_evaluated(tmp_path: Path) -> None:
    workspace = copy_workspace("three_terminals", tmp_path)
    publisher = workspace.root / "src" / "crate_bot" / "launch" / "rsp.launch.py"
    text = publisher.read_text()
    publisher.write_text(
        text.replace("def generate", "open('/nowhere/crate.urdf')\n\n\ndef generate")
    )
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 1
    (reported,) = [
        one
        for row in answer.document["packages"]
        for one in row["diagnostics"]
        if one["code"] == "SPN008"
    ]
    assert "rsp.launch.py, which may publish it, cannot be evaluated." in reported["message"]
    assert reported["hint"] == "Correct the errors of rsp.launch.py first."

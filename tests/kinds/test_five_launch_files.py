"""One package with five launch files, two of which spawn its robot."""

from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_each_launch_file_that_spawns_is_simulated(tmp_path: Path) -> None:
    workspace = copy_workspace("five_launch_files", tmp_path)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json", "--picture", "pictures")
    assert answer.code == 0, answer.errors
    rows = answer.document["packages"]
    assert [Path(row["launch_file"]).name for row in rows] == [
        "gazebo.launch.py",
        "store.launch.py",
    ]
    assert [row["world"]["name"] for row in rows] == ["yard", "store"]
    assert all(robot["rest"] for row in rows for robot in row["robots"])
    pictures = {row["picture"] for row in rows} | {row["world_picture"] for row in rows}
    assert {"rover_sim-gazebo.png", "rover_sim-store.png"} <= {
        Path(picture).name for picture in pictures if picture
    }
    assert answer.document["not_validated"] == []
    assert "evaluate launch files  5" in answer.errors

    text = workspace.wsgen("validate", "rover_sim").output
    assert text.count("massless-root") == 1
    assert "and 1 diagnostic as above" in text
    one = workspace.wsgen("validate", "--launch", "store.launch.py", "--format", "json").document
    assert [row["world"]["name"] for row in one["packages"]] == ["store"]


def test_the_same_simulation_is_run_once(tmp_path: Path) -> None:
    workspace = copy_workspace("five_launch_files", tmp_path)
    launch = workspace.root / "src" / "rover_sim" / "launch"
    for name in ("again", "with_rviz"):
        text = (launch / "store.launch.py").read_text()
        (launch / f"{name}.launch.py").write_text(text)
    assert workspace.wsgen("build").code == 0
    document = workspace.wsgen("validate", "--format", "json").document
    assert [Path(row["launch_file"]).name for row in document["packages"]] == [
        "again.launch.py",
        "gazebo.launch.py",
    ]
    assert {
        Path(one["launch_file"]).name: one["reason"] for one in document["not_validated"]
    } == dict.fromkeys(
        ("store.launch.py", "with_rviz.launch.py"), "the same simulation as again.launch.py"
    )
    same = "rover_sim store.launch.py, with_rviz.launch.py: the same simulation as again.launch.py"
    assert same in workspace.wsgen("validate", "--seconds", "0.1").output


def test_a_mistake_in_a_launch_file_that_spawns_nothing_is_seen(tmp_path: Path) -> None:
    workspace = copy_workspace("five_launch_files", tmp_path)
    launch = workspace.root / "src" / "rover_sim" / "launch"
    (launch / "teleop.launch.py").write_text("def generate_launch_description(:\n")
    display = launch / "display.launch.py"
    display.write_text(display.read_text().replace("'rover.rviz'", "os.environ['RVIZ_FILE']"))
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 1
    rows = {Path(row["launch_file"]).name: row for row in answer.document["packages"]}
    assert {name for name, row in rows.items() if not row["passed"]} == {"teleop.launch.py"}
    # What only the machine of its author has is no mistake of a launch file that spawns nothing.
    (left,) = answer.document["not_validated"]
    assert Path(left["launch_file"]).name == "display.launch.py"
    assert "RVIZ_FILE" in left["reason"]

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

    text = workspace.wsgen("validate", "rover_sim", "-v").output
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


def test_mistakes_in_launch_files_that_spawn_nothing(tmp_path: Path) -> None:
    workspace = copy_workspace("five_launch_files", tmp_path)
    package = workspace.root / "src" / "rover_sim"
    launch = package / "launch"
    (launch / "teleop.launch.py").write_text("def generate_launch_description(:\n")
    display = launch / "display.launch.py"
    display.write_text(display.read_text().replace("'rover.rviz'", "os.environ['RVIZ_FILE']"))
    gazebo = (launch / "gazebo.launch.py").read_text()
    test = "import launch_testing\n\ndef generate_test_description():\n    return None\n"
    for name, text in {
        "launch/test_rover_launch.py": test,
        "test/test_spawn.launch.py": gazebo,
        "old/rover_sim/launch/old.launch.py": gazebo,  # not where anybody would install it from
    }.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    assert workspace.wsgen("build").code == 0
    answer = workspace.wsgen("validate", "--format", "json", "--seconds", "0.1")
    assert answer.code == 0
    assert [Path(row["launch_file"]).name for row in answer.document["packages"]] == [
        "gazebo.launch.py",
        "store.launch.py",
    ]
    reasons = {
        Path(one["launch_file"]).name: one["reason"] for one in answer.document["not_validated"]
    }
    assert reasons.keys() == {"display.launch.py", "teleop.launch.py"}
    assert "RVIZ_FILE" in reasons["display.launch.py"]
    assert reasons["teleop.launch.py"].endswith("(LCH001, teleop.launch.py:1)")
    assert workspace.wsgen("validate", "--launch", "teleop.launch.py").code == 1

"""A workspace that was cloned and never built: source folders serve as share folders."""

from pathlib import Path

import pytest

from kind_workspaces import KindOfWorkspace, copy_workspace

pytestmark = pytest.mark.slow


@pytest.fixture
def workspace(tmp_path: Path) -> KindOfWorkspace:
    return copy_workspace("never_built", tmp_path)


def test_the_robot_is_simulated(workspace: KindOfWorkspace) -> None:
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert (answer.code, package["package"]) == (0, "trolley_bringup")
    assert package["share"].endswith("src/trolley_bringup")
    (found,) = package["diagnostics"]
    assert (found["code"], found["severity"]) == ("PKG065", "info")
    assert "trolley_bringup, trolley_description" in found["message"]
    (robot,) = package["robots"]
    assert robot["rest"]["xyz"][2] == pytest.approx(0.1, abs=0.005)
    assert package["world"]["name"] == "yard"
    assert "wsgen-" not in answer.output  # the folder of the links
    named = workspace.wsgen("validate", "trolley_bringup", folder=workspace.root / "src")
    assert named.code == 0
    assert "Next: wsgen validate trolley_bringup --picture .\n      wsgen build" in named.errors


def test_the_plan_names_the_source(workspace: KindOfWorkspace) -> None:
    launch_file = "src/trolley_bringup/launch/trolley.launch.py"
    for words in (["trolley_bringup", "trolley.launch.py"], [launch_file]):
        answer = workspace.wsgen("launch", *words)
        assert answer.code == 0, answer.errors
        assert "world:=src/trolley_description/worlds/yard.world" in answer.output
        assert "from src/trolley_description/urdf/trolley.urdf.xacro" in answer.output
        assert "info[PKG065]" in answer.output
        assert "wsgen-" not in answer.output
    assert workspace.wsgen("launch", launch_file, "--play").code == 0


def test_a_file_that_the_source_does_not_have(workspace: KindOfWorkspace) -> None:
    source = workspace.root / "src" / "trolley_description"
    (source / "urdf" / "trolley.urdf.xacro").unlink()
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    (error,) = [one for one in package["diagnostics"] if one["severity"] == "error"]
    assert (answer.code, error["code"]) == (1, "LCH005")
    assert f"'{source}/urdf/trolley.urdf.xacro'" in error["message"]
    assert "install(" not in error["hint"]


def test_what_is_installed_wins(workspace: KindOfWorkspace) -> None:
    """A file that the source has and that is not installed is an error, as for `ros2 launch`."""
    assert workspace.wsgen("build", "trolley_description").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert answer.code == 0
    assert [one["message"] for one in package["diagnostics"]] == [
        "Not built: trolley_bringup. Source folders are used as share folders."
    ]
    installed = workspace.root / "install/trolley_description/share/trolley_description"
    (installed / "urdf" / "trolley.urdf.xacro").unlink()
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 1
    errors = [one for one in answer.document["packages"][0]["diagnostics"] if one["hint"]]
    assert "is not in the install space of trolley_description" in errors[0]["message"]


def test_a_file_with_the_packages_around_it(workspace: KindOfWorkspace, tmp_path: Path) -> None:
    file = workspace.root / "src" / "trolley_description" / "urdf" / "trolley.urdf.xacro"
    for folder in (workspace.root, tmp_path, file.parent):
        answer = workspace.wsgen(
            "validate", str(file), "--arg", "mass:=3", "--format", "json", folder=folder
        )
        (package,) = answer.document["packages"]
        assert (answer.code, package["diagnostics"]) == (0, [])
        assert package["robots"][0]["mass"] == 3.0

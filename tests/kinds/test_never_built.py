"""A workspace that was cloned and never built: source folders serve as share folders."""

import os
from pathlib import Path

import pytest

from kind_workspaces import KindOfWorkspace, copy_workspace
from wsgen.descriptions.xacro.reader import expand_file
from wsgen.packages.workspace.layout import Workspace
from wsgen.packages.workspace.overlay import open_overlay

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


def test_what_nobody_looks_up_is_not_named(workspace: KindOfWorkspace) -> None:
    """Of the packages that are not built, those that the launch files and the robot use."""
    other = workspace.root / "src" / "trolley_docs"
    other.mkdir()
    (other / "package.xml").write_text(
        "<package format='3'><name>trolley_docs</name><version>0.0.0</version>"
        "<description>Pictures.</description><maintainer email='a@b.cd'>A</maintainer>"
        "<license>MIT</license></package>",
        encoding="utf-8",
    )
    both = "Not built: trolley_bringup, trolley_description. Source folders are used"
    for words in (["validate"], ["validate", "trolley_bringup"]):
        answer = workspace.wsgen(*words, "--format", "json")
        (package,) = answer.document["packages"]
        (found,) = [one for one in package["diagnostics"] if one["code"] == "PKG065"]
        assert found["message"].startswith(both)
    assert both in workspace.wsgen("launch", "trolley_bringup", "trolley.launch.py").output
    # With a xacro file that finds it.
    robot = workspace.root / "src" / "trolley_description" / "urdf" / "trolley.urdf.xacro"
    text = robot.read_text(encoding="utf-8")
    robot.write_text(
        text.replace("</robot>", "<gazebo><docs>${'$(find trolley_docs)'}</docs></gazebo></robot>"),
        encoding="utf-8",
    )
    answer = workspace.wsgen("validate", "trolley_bringup", "--format", "json")
    messages = [one["message"] for one in answer.document["packages"][0]["diagnostics"]]
    assert any("trolley_description, trolley_docs" in message for message in messages)
    # The same where xacro is not run by a launch file.
    with open_overlay([Workspace(root=workspace.root)], os.environ) as overlay:
        assert overlay.not_built() == ()
        urdf, found = expand_file(robot, {"mass": "3"}, environment=overlay.environment)
        assert (found, "src/trolley_docs</docs>" in str(urdf)) == ((), True)
        (found_later,) = overlay.not_built()
    assert found_later.message.startswith("Not built: trolley_description, trolley_docs.")


def test_what_is_built_and_not_registered(workspace: KindOfWorkspace) -> None:
    file = workspace.root / "src" / "trolley_description" / "CMakeLists.txt"
    file.write_text(file.read_text(encoding="utf-8").replace("ament_package()", ""))
    assert workspace.wsgen("build").code == 1  # missing-ament-package
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    (found,) = [one for one in package["diagnostics"] if one["code"] == "PKG065"]
    assert (answer.code, found["severity"]) == (1, "error")
    assert found["message"] == (
        "Built, but not registered in the ament index, where ROS looks: trolley_description. "
        "Its source folder is used as share folder."
    )
    assert "ament_package()" in found["hint"]
    # A later build that fails is another cause.
    (workspace.root / "build" / "trolley_description" / "colcon_build.rc").write_text("1\n")
    with open_overlay([Workspace(root=workspace.root)], os.environ) as overlay:
        overlay.look_up("trolley_description")
        (later,) = overlay.not_built()
    assert later.message.startswith("Not built: trolley_description.")


def test_what_is_installed_wins(workspace: KindOfWorkspace) -> None:
    """A file that the source has and that is not installed is an error, as for `ros2 launch`."""
    assert workspace.wsgen("build", "trolley_description").code == 0
    answer = workspace.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert answer.code == 0
    assert [one["message"] for one in package["diagnostics"]] == [
        "Not built: trolley_bringup. Its source folder is used as share folder."
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

"""Controllers that launch files start, from plans, descriptions and parameters alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.controllers import (
    find_configured,
    former_spawners,
    parameter_files,
    unknown_controllers,
    unknown_types,
)
from wsgen.descriptions.sdf.source import read_document
from wsgen.diagnostics import Severity
from wsgen.model.plan import LaunchPlan, Process, Unresolved
from wsgen.text import yamlfile

FILE = Path("controllers.yaml")
TEXT = """\
controller_manager:
  ros__parameters:
    update_rate: 100
    diff_cont:
      type: diff_drive_controller/DiffDriveController
    joint_broad.type: joint_state_broadcaster/JointStateBroadcaster
diff_cont:
  ros__parameters:
    type: not/one
"""


def spawner(*arguments: str, executable: str = "spawner") -> Process:
    return Process(package="controller_manager", executable=executable, arguments=arguments, line=3)


def plan(*processes: Process, unresolved: tuple[Unresolved, ...] = ()) -> LaunchPlan:
    return LaunchPlan(
        package="p",
        launch_file=Path("a.launch.py"),
        processes=processes,
        unresolved=unresolved,
    )


def read(text: str) -> yamlfile.Value:
    found = yamlfile.parse(text)
    assert isinstance(found, yamlfile.Value)
    return found


def check(launch: LaunchPlan, text: str | None = TEXT) -> list[str | None]:
    files = {FILE: None if text is None else read(text)}
    found = unknown_controllers(launch, find_configured(launch, files))
    return [one.element for one in found]


def test_controllers_that_are_not_configured() -> None:
    assert check(plan(spawner("diff_controller"))) == ["diff_controller"]
    both = spawner("diff_cont", "joint_broad", "arm", "--controller-manager", "/cm")
    assert check(plan(both)) == ["arm"]
    words = ("ros2", "control", "load_controller", "--set-state", "active", "arm")
    command = Process(package=None, executable=None, command=words)
    assert check(plan(command)) == ["arm"]


@pytest.mark.parametrize(
    "words",
    [
        ("diff_cont", "joint_broad", "-c", "/controller_manager"),
        ("--controller-manager=/cm", "diff_cont"),
        ("arm", "-p", "arm.yaml"),
        ("arm", "--some-new-option"),
        ("diff_cont", "--ros-args", "--log-level", "debug"),
        ("diff_cont", "--inactive"),
    ],
)
def test_controllers_that_are_configured(words: tuple[str, ...]) -> None:
    assert check(plan(spawner(*words))) == []


def test_what_is_not_known_is_not_compared() -> None:
    wrong = spawner("arm")
    assert check(plan(wrong), None) == []
    assert check(plan(wrong, unresolved=(Unresolved(what="x", why=""),))) == []
    assert list(unknown_controllers(plan(wrong), find_configured(plan(wrong), {}))) == []
    words = ("ros2", "control", "load_controller", "arm", "arm.yaml")
    assert check(plan(Process(package=None, executable=None, command=words))) == []
    typed = Process(
        package="controller_manager",
        executable="spawner",
        arguments=("arm",),
        parameters={"controller_type": "a/B"},
    )
    assert check(plan(typed)) == []


def test_managers_may_be_nodes() -> None:
    node = Process(
        package="controller_manager",
        executable="ros2_control_node",
        parameters={"diff_cont.type": "a/B", "update_rate": 100},
    )
    wrong = plan(node, spawner("diff_cont", "arm"))
    found = unknown_controllers(wrong, find_configured(wrong, {}))
    assert [one.element for one in found] == ["arm"]
    unknown = plan(Process(package="controller_manager", executable="ros2_control_node"))
    configured = find_configured(unknown, {})
    assert configured is not None
    assert not configured.are_all
    # The plugin of the robot, for Gazebo, does not know what the node without a name reads.
    of_gazebo = find_configured(unknown, {FILE: read(TEXT)})
    assert of_gazebo is not None
    assert "diff_cont" in of_gazebo.names
    assert not of_gazebo.are_all


@pytest.mark.parametrize(
    "section", ["/robot/controller_manager", "/**", "/**/controller_manager", "controller_manager"]
)
def test_sections_of_managers(section: str) -> None:
    text = TEXT.replace("controller_manager", f'"{section}"', 1)
    assert check(plan(spawner("diff_cont")), text) == []
    nested = "ns:\n  " + TEXT.partition("diff_cont:\n  ros")[0].replace("\n", "\n  ")
    assert check(plan(spawner("diff_cont")), nested) == []


def test_plugins_name_their_files() -> None:
    root, _ = read_document(
        '<robot name="r"><gazebo><plugin filename="gz_ros2_control-system" name="n">'
        "<parameters> /a/b.yaml </parameters></plugin>"
        '<plugin filename="other"><parameters>/c</parameters></plugin></gazebo></robot>'
    )
    assert root is not None
    assert list(parameter_files([root])) == [Path("/a/b.yaml")]


@pytest.mark.parametrize(
    "written",
    [
        "joint_state_controller/JointStateController",
        "effort_controllers/JointTrajectoryController",
        "diff_drive_controller/DiffDriveControler",
        "joint_state_broadcster/JointStateBroadcaster",
    ],
)
def test_types_that_do_not_exist(written: str) -> None:
    text = TEXT.replace("diff_drive_controller/DiffDriveController", written)
    (found,) = unknown_types(FILE, read(text), ())
    assert (found.name, found.line, found.element) == ("unknown-controller-type", 5, "diff_cont")
    assert found.severity is Severity.WARNING
    (found,) = unknown_types(FILE, read(text), {"diff_cont"})  # a launch file starts it
    assert found.severity is Severity.ERROR


@pytest.mark.parametrize(
    "written",
    [
        "own/Controller",
        "diff_drive_controller/OwnController",
        "own_diff_drive_controller/DiffDriveController",
    ],
)
def test_types_that_may_exist(written: str) -> None:
    text = TEXT.replace("diff_drive_controller/DiffDriveController", written)
    assert list(unknown_types(FILE, read(text), ())) == []


@pytest.mark.parametrize(
    ("program", "distro", "meant"),
    [
        ("spawner.py", "humble", "`spawner`"),
        ("unspawner.py", "jazzy", "`unspawner`"),
        ("spawner.py", "foxy", None),
        ("spawner.py", None, None),
        ("spawner", "jazzy", None),
    ],
)
def test_spawners_that_humble_no_longer_has(
    program: str, distro: str | None, meant: str | None
) -> None:
    found = [*former_spawners(plan(spawner("a", executable=program)), distro)]
    assert [one.hint for one in found] == ([f"Did you mean {meant}?"] if meant else [])
    create = Process(package="ros_gz_sim", executable="create")
    of_later = [*former_spawners(plan(create, spawner("a", executable="spawner.py")), None)]
    assert [(one.code, one.line) for one in of_later] == [("LCH021", 3)]

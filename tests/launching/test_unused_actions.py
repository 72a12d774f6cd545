"""Actions that a launch file creates and forgets to add are named where they are missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace
from wsgen.diagnostics import Severity
from wsgen.launching.explain_missing import unused_actions, where_written
from wsgen.launching.simulators import find_simulator
from wsgen.launching.spawning import assume_spawn, find_spawns

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan


TEXT = (
    HEAD
    + """
def generate_launch_description():
    gazebo = IncludeLaunchDescription([FindPackageShare("gazebo_ros"), "/launch/gazebo.launch.py"])
    spawner = Node(package="gazebo_ros", executable="spawn_entity.py",
                   arguments=["-topic", "robot_description", "-entity", "r"])
    publisher = Node(package="robot_state_publisher", executable="robot_state_publisher",
                     parameters=[{"robot_description": "<robot name='r'/>"}])
    description = LaunchDescription()
    description.add_action(gazebo)
    description.add_action(spawner)
    description.add_action(publisher)
    return description
"""
)


def without(space: InstallSpace, name: str) -> LaunchPlan:
    text = TEXT.replace(f"    description.add_action({name})\n", "")
    share = space.add("my_robot", {"launch/test.launch.py": text})
    return space.evaluate(share / "launch" / "test.launch.py")


def missing_from(plan: LaunchPlan) -> list[Diagnostic]:
    spawns, not_spawned = find_spawns(plan)
    missing = [] if spawns or not_spawned else [assume_spawn(plan)[1]]
    return [*find_simulator(plan)[1], *not_spawned, *missing]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "code"), [("gazebo", "SPN001"), ("spawner", "SPN003"), ("publisher", "SPN008")]
)
def test_action_that_is_not_added(space: InstallSpace, name: str, code: str) -> None:
    plan = without(space, name)
    (found,) = missing_from(plan)
    assert found.severity is Severity.ERROR
    assert found.code == code
    assert f"`{name}` is created but not added" in found.message
    assert found.line == TEXT[: TEXT.index(f"    {name} = ")].count("\n") + 1
    assert f"add_action({name})" in (found.hint or "")


@pytest.mark.slow
@pytest.mark.parametrize(
    "unused",
    [
        "IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/rviz.launch.py'])",
        "Node(package='rviz2', executable='rviz2')",
        "Node(package='my_robot', executable=LaunchConfiguration('program'))",
    ],
)
def test_an_unused_action_for_another_thing_is_not_blamed(space: InstallSpace, unused: str) -> None:
    text = f"{HEAD}\ndef generate_launch_description():\n    other = {unused}\n"
    text += "    return LaunchDescription()\n"
    share = space.add("my_robot", {"launch/test.launch.py": text})
    plan = space.evaluate(share / "launch" / "test.launch.py")
    found = missing_from(plan)
    assert [(one.code, one.line) for one in found] == [("SPN001", None), ("SPN003", None)]


@pytest.mark.slow
def test_all_are_added(space: InstallSpace) -> None:
    plan = without(space, "nothing")
    assert not missing_from(plan)


@pytest.mark.slow
def test_what_is_missing_for_another_reason(space: InstallSpace) -> None:
    plan = space.play("Node(package='rviz2', executable='rviz2')", before="a = LogInfo(msg='')")
    assert [found.line for found in missing_from(plan)] == [None, None]


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("a = Node()", ["a"]),
        ("a = b.Node()", ["a"]),
        ("a = Node()\nld.add_action(a)", []),
        ("a = Node()\ndef f():\n    return [a]", []),
        ("a = Node()\nb = On(a)", ["b"]),
        ("a = Node()\nb = On(a)\nc = At([b])", ["c"]),
        ("a = Node()\nb = On(a)\nc = At([b])\nld = [c]", []),
        ("a = Node(a)", []),
        ("a = Other()", []),
        ("a.b = Node()", []),
        ("not Python", []),
    ],
)
def test_variables_that_nothing_reads(tmp_path: Path, text: str, names: list[str]) -> None:
    (tmp_path / "f.py").write_text(text)
    assert [found.name for found in unused_actions([tmp_path / "f.py"], ["Node"])] == names


def test_a_text_is_found_where_it_is_written_once(tmp_path: Path) -> None:
    file = tmp_path / "f.py"
    file.write_text("a = 1\nb = 'model/x.world'\nc = 'y', 'y.z'\nd = 'y'\n")
    assert where_written("x.world", [file, tmp_path / "no.py"]) == (str(file), 2)
    assert where_written("world", [file]) is None
    assert where_written("y", [file]) is None

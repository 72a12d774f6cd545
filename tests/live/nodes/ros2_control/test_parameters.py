"""Parameters of controllers from files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.live.nodes.simulator.ros2_control.parameters import ParameterFiles, Parameters
from wsgen.text.yamlfile import is_meant

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("pattern", "name", "matches"),
    [
        ("/controller_manager", "/controller_manager", True),
        ("/controller_manager", "/arm/controller_manager", False),
        ("/**", "/arm/controller_manager", True),
        ("/**/controller_manager", "/arm/left/controller_manager", True),
        ("/**/controller_manager", "/controller_manager", True),
        ("/*", "/controller_manager", True),
        ("/*", "/arm/controller_manager", False),
        ("/*/controller_manager", "/arm/controller_manager", True),
        ("/controller.manager", "/controllerXmanager", False),
        ("", "/anything", False),
    ],
)
def test_sections_are_for_nodes_as_rclcpp_matches_them(
    pattern: str, name: str, matches: bool
) -> None:
    assert is_meant(pattern, name) is matches


def test_later_sections_override_and_names_are_joined_by_dots(tmp_path: Path) -> None:
    first, second = tmp_path / "a.yaml", tmp_path / "b.yaml"
    first.write_text(
        "/**:\n  ros__parameters:\n    use_sim_time: true\n    update_rate: 50\n"
        "controller_manager:\n  ros__parameters:\n    update_rate: 100\n"
        "    arm:\n      type: some/Type\n"
        "arm:\n  ros__parameters:\n    joints: [a, b]\n    gains: {a: {p: 1.5}}\n"
    )
    second.write_text("arm:\n  ros__parameters:\n    joints: [c]\n")
    files = ParameterFiles.read([str(first), str(second)])
    assert files.errors == ()
    assert files.of_node("/controller_manager") == {
        "use_sim_time": True,
        "update_rate": 100,
        "arm.type": "some/Type",
    }
    assert files.of_node("/arm")["joints"] == ["c"]
    assert files.of_node("/arm")["gains.a.p"] == 1.5
    assert files.of_node("/robot/arm") == {"use_sim_time": True, "update_rate": 50}


def test_namespaces_may_be_nested_or_written_in_one_key(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text(
        "robot:\n  arm:\n    ros__parameters: {x: 1}\n/robot/leg:\n  ros__parameters: {y: 2}\n"
    )
    files = ParameterFiles.read([str(file)])
    assert files.of_node("/robot/arm") == {"x": 1}
    assert files.of_node("/robot/leg") == {"y": 2}


def test_files_that_cannot_be_read_are_reported(tmp_path: Path) -> None:
    broken, empty = tmp_path / "broken.yaml", tmp_path / "empty.yaml"
    broken.write_text("a:\n  - [\n")
    empty.write_text("")
    errors = ParameterFiles.read([str(broken), str(empty), str(tmp_path / "none.yaml")]).errors
    assert errors[0].startswith(f"{broken}:")
    assert "is empty" in errors[1]
    assert "does not exist" in errors[2]


def test_values_of_wrong_types_are_reported_and_their_defaults_used() -> None:
    parameters = Parameters({"rate": "fast", "joints": "a", "on": 1, "list": [1, 2.5], "n": 3})
    assert parameters.number("rate", 50.0) == 50.0
    assert parameters.texts("joints") == []
    assert parameters.flag("on", default=True) is True
    assert parameters.numbers("list") == [1.0, 2.5]
    assert parameters.number("n") == 3.0
    assert len(parameters.problems) == 3
    assert "`rate` is 'fast', which is not a number" in parameters.problems[0]


def test_an_integer_that_no_float_holds_is_no_number() -> None:
    parameters = Parameters({"rate": 10**400, "gains": [1.0, -(10**400)]})
    assert parameters.number("rate", 50.0) == 50.0
    assert parameters.numbers("gains", [2.0]) == [2.0]
    assert len(parameters.problems) == 2


def test_defaults_are_kept_for_whoever_lists_the_parameters() -> None:
    parameters = Parameters({})
    parameters.number("update_rate", 100.0)
    assert parameters.bound("limit") is None
    assert parameters.values["update_rate"] == 100.0

"""Launch files, tests, worlds and parameters that are added."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from porting.adding.added import added, opened, package, workspace
from wsgen.errors import NotFoundError, RequestError
from wsgen.pipeline.check import CheckRequest, check
from wsgen.porting.adding.launches import LaunchOptions, add_launch
from wsgen.porting.adding.parameters import add_parameter
from wsgen.porting.adding.tests import add_test
from wsgen.porting.adding.worlds import add_world

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition

ROVER, BEETLE = "five_launch_files/src/rover_sim", "python_package/src/beetle_bringup"


@pytest.mark.slow
@pytest.mark.parametrize("where", [ROVER, BEETLE])
@pytest.mark.parametrize(
    "add",
    [
        pytest.param(lambda one: add_launch(one, "show", LaunchOptions("rviz")), id="rviz"),
        pytest.param(
            lambda one: add_launch(one, "sim", LaunchOptions("simulator")), id="simulator"
        ),
        pytest.param(lambda one: add_world(one, "field"), id="world"),
        pytest.param(lambda one: add_test(one, "robot"), id="test"),
    ],
)
def test_nothing_more_is_reported(
    tmp_path: Path, where: str, add: Callable[[Addition], None]
) -> None:
    kind, _, path = where.partition("/")
    place = workspace(tmp_path, kind) / path

    def reported() -> list[str]:
        outcome = check(CheckRequest(paths=[place], distro="humble"), environment=os.environ)
        return sorted(one.code for one in outcome.diagnostics)

    before = reported()
    plan, _ = added(place, add)
    assert plan.pasted == ()
    assert len(plan.created) == 1
    assert reported() == before


def test_a_launch_file_that_includes_others(tmp_path: Path) -> None:
    place = workspace(tmp_path, "five_launch_files") / "src/rover_sim"
    includes = LaunchOptions(includes=["display.launch.py", "nav2_bringup/bringup_launch.py"])
    plan, lines = added(place, lambda one: add_launch(one, "all", includes))
    text = plan.created[0][1]
    assert "[FindPackageShare('rover_sim'), 'launch', 'display.launch.py']" in text
    assert "<exec_depend>nav2_bringup</exec_depend>" in lines["package.xml"]
    missing = LaunchOptions(includes=["displai.launch.py"])
    with pytest.raises(NotFoundError, match="has no launch file displai"):
        add_launch(opened(place), "more", missing)
    with pytest.raises(RequestError, match="what the launch file is for"):
        add_launch(opened(place), "more", LaunchOptions())


def test_a_launch_file_needs_a_robot(tmp_path: Path) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": "project(owl)\nament_package()\n"})
    with pytest.raises(NotFoundError, match="has no robot"):
        add_launch(opened(place), "show", LaunchOptions("rviz"))
    with pytest.raises(RequestError, match="neither a launch file nor a Python package"):
        add_test(opened(place), "owl")


NODE = """import rclpy
from rclpy.node import Node


class Owl(Node):

    def __init__(self):
        super().__init__("owl")
        {declared}
        self.create_timer(1.0, self.hoot)
"""


@pytest.mark.parametrize(
    ("declared", "new"),
    [
        ("pass", 'self.declare_parameter("loud", 0.5)'),
        ('self.declare_parameter("a", 1)', 'self.declare_parameter("loud", 0.5)'),
        (
            'self.a = self.declare_parameter("a", 1).value',
            'self.loud = self.declare_parameter("loud", 0.5).value',
        ),
        (
            'self.declare_parameters("", [\n            ("a", 1),\n        ])',
            '("loud", 0.5),',
        ),
    ],
)
def test_a_parameter_in_python(tmp_path: Path, declared: str, new: str) -> None:
    settings = (
        "owl:\n  ros__parameters:\n    a: 1  # once\n\nother:\n  ros__parameters:\n    b: 2\n"
    )
    files = {
        "CMakeLists.txt": "project(owl)\nament_package()\n",
        "scripts/owl.py": NODE.format(declared=declared),
        "config/owl.yaml": settings,
    }
    place = package(tmp_path, "owl", files)
    _, lines = added(place, lambda one: add_parameter(one, "loud:=0.5", None))
    assert lines == {"config/owl.yaml": ["loud: 0.5"], "scripts/owl.py": [new]}
    assert "    a: 1  # once\n    loud: 0.5\n\nother" in (place / "config/owl.yaml").read_text()


def test_a_parameter_in_cpp(tmp_path: Path) -> None:
    text = 'Owl() : Node("owl")\n{\n  this->declare_parameter("a", 1);\n}\n'
    files = {"CMakeLists.txt": "project(owl)\nament_package()\n", "src/owl.cpp": text}
    place = package(tmp_path, "owl", files)
    _, lines = added(place, lambda one: add_parameter(one, "names:=['a']".replace("'", '"'), "owl"))
    new = 'this->declare_parameter<std::vector<std::string>>("names", {"a"});'
    assert lines == {"src/owl.cpp": [new]}


def test_a_node_that_is_not_there(tmp_path: Path) -> None:
    place = workspace(tmp_path, "python_package") / "src/beetle_bringup"
    with pytest.raises(NotFoundError, match="has no node drive_in_squares"):
        add_parameter(opened(place), "loud:=1", "drive_in_squares")
    with pytest.raises(RequestError, match="is not a number, a text"):
        add_parameter(opened(place), "loud:=[1, true]", None)

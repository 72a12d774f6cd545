"""Nodes that are added: what is built, installed, started and tested then."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kind_workspaces import LIMIT
from porting.adding.added import added, opened, package, workspace
from ros_for_tests import ros_with, variables_for
from wsgen.errors import RequestError
from wsgen.pipeline.check import CheckRequest, check
from wsgen.porting.adding.nodes import NodeOptions, add_node

if TYPE_CHECKING:
    from pathlib import Path

BOTH = NodeOptions(
    publishes=["chatter:std_msgs/String"],
    subscribes=["scan:sensor_msgs/msg/LaserScan"],
    parameters=["speed:=0.5", 'names:=["a", "b"]'],
)
SETUP = """from setuptools import setup

setup(
    name='owl',
    packages=['owl'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/owl']),
        ('share/owl', ['package.xml'])
    ],
{entry_points})
"""


def found(place: Path, *, besides: frozenset[str] = frozenset()) -> set[str]:
    """What is reported about a package, by code."""
    outcome = check(CheckRequest(paths=[place]), environment={**os.environ, "ROS_DISTRO": "humble"})
    return {one.code for one in outcome.diagnostics} - besides


def test_in_a_python_package(tmp_path: Path) -> None:
    place = workspace(tmp_path, "python_package") / "src/beetle_bringup"
    before = found(place)
    plan, lines = added(place, lambda one: add_node(one, "talker", BOTH))
    assert lines == {
        "package.xml": [
            f"<exec_depend>{one}</exec_depend>"
            for one in ("launch", "launch_ros", "sensor_msgs", "std_msgs")
        ],
        "setup.py": ["'talker = beetle_bringup.talker:main',"],
    }
    assert plan.pasted == ()
    assert found(place) == before


def test_in_a_cmake_package(tmp_path: Path) -> None:
    place = workspace(tmp_path, "five_launch_files") / "src/rover_sim"
    before = found(place)
    _, lines = added(place, lambda one: add_node(one, "talker", BOTH))
    assert lines["CMakeLists.txt"] == [
        "install(PROGRAMS scripts/talker.py DESTINATION lib/${PROJECT_NAME})",
        "if(BUILD_TESTING)",
        "find_package(ament_cmake_pytest REQUIRED)",
        "ament_add_pytest_test(test_talker test/test_talker.py TIMEOUT 300)",
        "endif()",
    ]
    assert os.access(place / "scripts/talker.py", os.X_OK)
    assert found(place) == before


@pytest.mark.parametrize(
    ("entry_points", "new"),
    [
        pytest.param(
            "", "entry_points={'console_scripts': ['talker = owl.talker:main',],},", id="none"
        ),
        pytest.param(
            "    entry_points={\n        'console_scripts': [\n            'b = owl.b:main'\n"
            "        ],\n    },\n",
            "'talker = owl.talker:main',",
            id="without a last comma",
        ),
        pytest.param(
            '    entry_points={\n        "console_scripts": [\n        ],\n    },\n',
            "'talker = owl.talker:main',",
            id="empty",
        ),
        pytest.param(
            "    entry_points={\n        'gui_scripts': [],\n    },\n",
            "'console_scripts': ['talker = owl.talker:main',],",
            id="others",
        ),
    ],
)
def test_entry_points(tmp_path: Path, entry_points: str, new: str) -> None:
    files = {
        "setup.py": SETUP.format(entry_points=entry_points),
        "owl/__init__.py": "",
        "owl/b.py": "",
    }
    place = package(tmp_path, "owl", files, "ament_python")
    plan, lines = added(place, lambda one: add_node(one, "talker", NodeOptions(is_bare=True)))
    assert plan.pasted == ()
    assert "".join(lines["setup.py"]).replace('"', "'") == new


def test_what_cannot_be_placed_is_to_be_pasted(tmp_path: Path) -> None:
    points = "    entry_points=dict(console_scripts=scripts()),\n"
    files = {"setup.py": SETUP.format(entry_points=points), "owl/__init__.py": ""}
    place = package(tmp_path, "owl", files, "ament_python")
    addition = opened(place)
    add_node(addition, "talker", NodeOptions(is_bare=True))
    pasted = addition.finish().pasted
    assert [(one.file.name, one.text) for one in pasted] == [
        ("setup.py", "'talker = owl.talker:main',")
    ]


def test_carriage_returns_stay(tmp_path: Path) -> None:
    text = "project(owl)\r\nfind_package(ament_cmake REQUIRED)\r\nament_package()\r\n"
    place = package(tmp_path, "owl", {"CMakeLists.txt": text})
    added(place, lambda one: add_node(one, "talker", NodeOptions(language="cpp", is_bare=True)))
    written = (place / "CMakeLists.txt").read_bytes()
    assert written.count(b"\r\n") == written.count(b"\n")
    assert b"add_executable(talker src/talker.cpp)\r\n" in written


CMAKE = """cmake_minimum_required(VERSION 3.8)
project(owl)
find_package(ament_cmake REQUIRED)
find_package(rclcpp REQUIRED)

add_executable(hoot src/hoot.cpp)
{linked}

install(TARGETS
  hoot
  DESTINATION lib/${{PROJECT_NAME}}
)

ament_package()
"""


@pytest.mark.parametrize(
    ("linked", "distro", "new"),
    [
        (
            "ament_target_dependencies(hoot rclcpp)",
            "humble",
            "ament_target_dependencies(talker rclcpp std_msgs)",
        ),
        (
            "ament_target_dependencies(hoot rclcpp)",
            "lyrical",
            "target_link_libraries(talker rclcpp::rclcpp ${std_msgs_TARGETS})",
        ),
        (
            "target_link_libraries(hoot PUBLIC rclcpp::rclcpp)",
            "humble",
            "target_link_libraries(talker rclcpp::rclcpp ${std_msgs_TARGETS})",
        ),
    ],
)
def test_in_cpp(tmp_path: Path, linked: str, distro: str, new: str) -> None:
    files = {"CMakeLists.txt": CMAKE.format(linked=linked), "src/hoot.cpp": ""}
    place = package(tmp_path, "owl", files)
    options = NodeOptions("cpp", ["chatter:std_msgs/String"], is_bare=True)
    _, lines = added(place, lambda one: add_node(one, "talker", options), distro)
    assert lines == {
        "CMakeLists.txt": [
            "find_package(std_msgs REQUIRED)",
            "add_executable(talker src/talker.cpp)",
            new,
            "talker",
        ],
        "package.xml": ["<depend>rclcpp</depend>", "<depend>std_msgs</depend>"],
    }


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("Talk-er", NodeOptions(), "cannot be the name of a node"),
        ("class", NodeOptions(), "it is a word of Python"),
        ("talker", NodeOptions(publishes=["chatter"]), "is not a topic with its type"),
        ("talker", NodeOptions(publishes=["chatter:std_msgs/Strin"]), "has no message Strin"),
        ("talker", NodeOptions(publishes=["chatter:std_msg/String"]), "ROS has no such package"),
        ("talker", NodeOptions(parameters=["speed=1"]), "is not a parameter with its value"),
        ("talker", NodeOptions(language="cpp"), "compiles nothing"),
        ("drive_in_circles", NodeOptions(), None),
    ],
)
def test_refusals(tmp_path: Path, name: str, options: NodeOptions, message: str | None) -> None:
    place = workspace(tmp_path, "python_package") / "src/beetle_bringup"
    addition = opened(place)
    if message is None:  # it exists, and stays as it is
        add_node(addition, name, options)
        assert [one.name for one in addition.finish().kept] == [f"{name}.py"]
        return
    with pytest.raises(RequestError) as refused:
        add_node(addition, name, options)
    assert message in refused.value.message


def test_another_program_of_the_name(tmp_path: Path) -> None:
    points = "    entry_points={'console_scripts': ['talker = owl.b:main']},\n"
    files = {"setup.py": SETUP.format(entry_points=points), "owl/__init__.py": "", "owl/b.py": ""}
    addition = opened(package(tmp_path, "owl", files, "ament_python"))
    with pytest.raises(RequestError, match="has another program `talker`"):
        add_node(addition, "talker", NodeOptions())


@pytest.mark.parametrize("language", ["python", "cpp"])
def test_sources_have_what_is_asked_for(tmp_path: Path, language: str) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": CMAKE.format(linked="")})
    addition = opened(place)
    add_node(addition, "talker", BOTH._replace(language=language, is_bare=True))
    created = {file.name: text for file, text in addition.finish().created}
    if language == "python":
        text = created["talker.py"]
        ast.parse(text)
        assert "declare_parameter('names', ['a', 'b'])" in text
        assert "LaserScan, 'scan', self.take_scan, qos_profile_sensor_data)" in text
    else:
        text = created["talker.cpp"]
        assert text.count("{") == text.count("}")
        assert 'declare_parameter<std::vector<std::string>>("names", {"a", "b"});' in text
        assert '#include "sensor_msgs/msg/laser_scan.hpp"' in text


@pytest.mark.slow
def test_it_runs_live(tmp_path: Path) -> None:
    """The test that comes with a node passes, and does not where the node is silent."""
    root = workspace(tmp_path, "python_package")
    place = root / "src/beetle_bringup"
    added(place, lambda one: add_node(one, "talker", BOTH))
    variables = variables_for(ros_with())
    words = [sys.executable, "-m", "wsgen", "build", "-q"]
    subprocess.run(words, cwd=root, env=variables, check=True, timeout=LIMIT)
    test = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", "."]
    test.append("src/beetle_bringup/test/test_talker.py")
    done = subprocess.run(
        test, cwd=root, env=variables, check=False, timeout=LIMIT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    node = place / "beetle_bringup/talker.py"
    node.write_text(node.read_text().replace("publish(String())", "get_subscription_count()"))
    subprocess.run(words, cwd=root, env=variables, check=True, timeout=LIMIT)
    done = subprocess.run(
        test, cwd=root, env=variables, check=False, timeout=LIMIT, capture_output=True, text=True
    )
    assert done.returncode == 1
    assert "chatter" in done.stdout

"""Messages, services and actions that are added, to the letter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from porting.adding.added import added, opened, package, workspace
from wsgen.errors import RequestError
from wsgen.porting.adding.interfaces import KINDS, add_interface

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition

GENERATE = "rosidl_generate_interfaces(${PROJECT_NAME}\n  {}\n  DEPENDENCIES geometry_msgs\n)\n"
HEAD = "cmake_minimum_required(VERSION 3.8)\nproject(owl)\nfind_package(ament_cmake REQUIRED)\n"
FOUND = "find_package(rosidl_default_generators REQUIRED)\n"


def message(addition: Addition) -> None:
    add_interface(addition, KINDS["message"], "Hoot", [["loud:float64", "at:geometry_msgs/Point"]])


def test_the_first_one(tmp_path: Path) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": f"{HEAD}ament_package()\n"})
    _, lines = added(place, message)
    assert lines == {
        "CMakeLists.txt": [
            "find_package(rosidl_default_generators REQUIRED)",
            "find_package(geometry_msgs REQUIRED)",
            "rosidl_generate_interfaces(${PROJECT_NAME}",
            '"msg/Hoot.msg"',
            "DEPENDENCIES geometry_msgs",
            ")",
            "ament_export_dependencies(rosidl_default_runtime)",
        ],
        "package.xml": [
            "<buildtool_depend>rosidl_default_generators</buildtool_depend>",
            "<depend>geometry_msgs</depend>",
            "<exec_depend>rosidl_default_runtime</exec_depend>",
            "<member_of_group>rosidl_interface_packages</member_of_group>",
        ],
    }
    assert (place / "msg/Hoot.msg").read_text() == "float64 loud\ngeometry_msgs/Point at\n"


def test_blanks_behind_a_dependency_stay_there(tmp_path: Path) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": f"{HEAD}ament_package()\n"})
    manifest = place / "package.xml"
    manifest.write_text(manifest.read_text().replace("</buildtool_depend>", "</buildtool_depend> "))
    added(place, message)  # no line of before has changed


def test_a_target_has_the_name_of_the_package(tmp_path: Path) -> None:
    text = f"{HEAD}add_executable(owl a.cpp)\nament_package()\n"
    _, lines = added(package(tmp_path, "owl", {"CMakeLists.txt": text}), message)
    assert "rosidl_generate_interfaces(${PROJECT_NAME}_interfaces" in lines["CMakeLists.txt"]
    assert "LIBRARY_NAME ${PROJECT_NAME}" in lines["CMakeLists.txt"]


def test_beside_others(tmp_path: Path) -> None:
    place = workspace(tmp_path, "messages_and_nodes") / "src/mole_msgs"
    _, lines = added(place, message)
    assert lines["CMakeLists.txt"] == [
        "find_package(geometry_msgs REQUIRED)",
        '"msg/Hoot.msg"',
        "geometry_msgs",
    ]
    text = (place / "CMakeLists.txt").read_text()
    assert '  "msg/Hoot.msg"\n  "msg/Tunnel.msg"\n' in text or (
        '  "msg/Tunnel.msg"\n  "msg/Hoot.msg"\n  "srv/Dig.srv"\n' in text
    )
    assert "  DEPENDENCIES builtin_interfaces std_msgs\n    geometry_msgs\n)" in text


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        pytest.param(
            "set(msg_files\n  msg/A.msg\n  msg/Z.msg\n)\n" + GENERATE.replace("{}", "${msg_files}"),
            "  msg/A.msg\n  msg/Hoot.msg\n  msg/Z.msg\n)",
            id="in a variable, sorted",
        ),
        pytest.param(
            GENERATE.replace("{}", "srv/Z.srv"),
            "  srv/Z.srv\n  msg/Hoot.msg\n",
            id="the first of its kind",
        ),
        pytest.param(
            "file(GLOB msgs msg/*.msg)\n" + GENERATE.replace("{}", "${msgs}"),
            "file(GLOB msgs msg/*.msg)",
            id="by a pattern",
        ),
    ],
)
def test_where_it_is_listed(tmp_path: Path, written: str, expected: str) -> None:
    text = f"{HEAD}{FOUND}find_package(geometry_msgs REQUIRED)\n{written}ament_package()\n"
    place = package(tmp_path, "owl", {"CMakeLists.txt": text, "msg/A.msg": ""})
    plan, _ = added(place, message)
    assert plan.pasted == ()
    assert expected in (place / "CMakeLists.txt").read_text()


@pytest.mark.parametrize("kind", ["service", "action"])
def test_parts(tmp_path: Path, kind: str) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": f"{HEAD}ament_package()\n"})
    parts = [["a:int32[]"], ["b:string<=10"], ["c:bool[3]"]][: len(KINDS[kind].options)]
    added(place, lambda one: add_interface(one, KINDS[kind], "Hoot", parts))
    folder = KINDS[kind].folder
    wanted = "---\n".join(("int32[] a\n", "string<=10 b\n", "bool[3] c\n")[: len(parts)])
    assert (place / folder / f"Hoot.{folder}").read_text() == wanted


@pytest.mark.parametrize(
    ("field", "says"),
    [
        ("loud", "is not a field"),
        ("Loud:float64", "is not a field"),
        ("loud:double", "is not a type of fields"),
        ("at:geometry_msgs/Pont", "has no message Pont"),
        ("at:Nothing", "has no message Nothing"),
    ],
)
def test_fields_that_cannot_be(tmp_path: Path, field: str, says: str) -> None:
    place = package(tmp_path, "owl", {"CMakeLists.txt": f"{HEAD}ament_package()\n"})
    with pytest.raises(RequestError, match=says):
        add_interface(opened(place), KINDS["message"], "Hoot", [[field]])


def test_packages_that_generate_none(tmp_path: Path) -> None:
    place = workspace(tmp_path, "python_package") / "src/beetle_bringup"
    with pytest.raises(RequestError, match="ament_python") as refused:
        message(opened(place))
    assert "ros2 pkg create beetle_bringup_interfaces" in refused.value.hint
    text = f"{HEAD}ament_python_install_package(${{PROJECT_NAME}})\nament_package()\n"
    with pytest.raises(RequestError, match="would replace"):
        message(opened(package(tmp_path, "owl", {"CMakeLists.txt": text})))
    with pytest.raises(RequestError, match="CamelCase"):
        add_interface(opened(tmp_path / "src/owl"), KINDS["message"], "my_hoot", [[]])

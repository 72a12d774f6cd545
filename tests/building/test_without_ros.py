"""Builds that go on where a package of ROS, a compiler or a failed package is missing."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from building.building import (
    CMAKE,
    PACKAGE_XML,
    SHELL_PROGRAMS,
    build_here,
    cache_entry,
    link_programs,
    outside,
    write_package,
)
from wsgen.building.left_out import LAST_ARGUMENTS, LEFT_OUT, configure_again
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.building.run import BuildResult

pytestmark = pytest.mark.slow

NODE = CMAKE.replace("LANGUAGES NONE", "LANGUAGES CXX").replace(
    "install(",
    "find_package(rclcpp REQUIRED)\n"
    "add_executable(node node.cpp)\n"
    "@link@\n"
    "install(TARGETS node DESTINATION lib/${PROJECT_NAME})\n"
    "install(",
)
PLAIN = "int main() {return 0;}\n"


def write_node(root: Path, link: str = "", source: str = PLAIN) -> None:
    folder = write_package(root, cmake=NODE.replace("@link@", link))
    (folder / "node.cpp").write_text(source)


def left_out(result: BuildResult) -> tuple[str, ...]:
    assert result.succeeded, result.diagnostics
    (package,) = result.packages
    return package.left_out


@pytest.mark.parametrize(
    "link",
    [
        "ament_target_dependencies(node rclcpp)",
        "target_link_libraries(node rclcpp::rclcpp)",
        "target_link_libraries(node PRIVATE ${rclcpp_LIBRARIES})",
        "target_link_libraries(node PRIVATE $<BUILD_INTERFACE:rclcpp::rclcpp>)",
        "target_include_directories(node PRIVATE ${rclcpp_INCLUDE_DIRS})",
        (
            "add_library(own INTERFACE)\n"
            "target_link_libraries(own INTERFACE rclcpp::rclcpp)\n"
            "target_link_libraries(node own)"
        ),
        "find_library(THEIRS NAMES nobody_has_it REQUIRED)\ntarget_link_libraries(node ${THEIRS})",
        (
            "find_library(THEIRS nobody_has_it)\n"
            "if(NOT THEIRS)\n  message(FATAL_ERROR no)\nendif()\n"
            "target_link_libraries(node ${THEIRS})"
        ),
    ],
)
def test_a_target_that_names_what_is_missing_is_left_out(link: str, tmp_path: Path) -> None:
    write_node(tmp_path, link)
    result = build_here(tmp_path)
    assert "node" in left_out(result)
    (note,) = result.diagnostics
    assert (note.code, note.severity) == ("BLD032", Severity.INFO)
    assert "needs rclcpp" in note.message
    assert (tmp_path / "install/demo/share/demo/launch/demo.launch.py").is_file()


@pytest.mark.parametrize(
    "source",
    [
        "#include <rclcpp/rclcpp.hpp>\n",
        '#include "own.hpp"\n',
        '#  include "nowhere.hpp"\n',
    ],
)
def test_a_target_that_includes_what_is_missing_is_left_out(source: str, tmp_path: Path) -> None:
    write_node(tmp_path, source=source + PLAIN)
    (tmp_path / "src/demo/own.hpp").write_text("#include <rclcpp/node.hpp>\n")
    assert left_out(build_here(tmp_path)) == ("node",)


def test_a_left_out_target_may_have_a_name_that_cmake_takes_for_false(tmp_path: Path) -> None:
    cmake = NODE.replace("@link@", "ament_target_dependencies(n rclcpp)")
    folder = write_package(tmp_path, cmake=cmake.replace("e(node", "e(n").replace("S node", "S n"))
    (folder / "node.cpp").write_text(PLAIN)
    assert left_out(build_here(tmp_path)) == ("n",)


def test_a_target_that_needs_nothing_of_it_is_compiled(tmp_path: Path) -> None:
    write_node(tmp_path, source=f"#include <vector>\n{PLAIN}")
    assert left_out(build_here(tmp_path)) == ()
    assert (tmp_path / "install/demo/lib/demo/node").is_file()


@pytest.mark.parametrize(
    ("name", "meant"),
    [("rclpcp", "rclcpp"), ("gz-sin8", "gz-sim8"), ("hardware_interfaces", "hardware_interface")],
)
def test_a_name_that_nobody_knows_is_an_error(name: str, meant: str, tmp_path: Path) -> None:
    asking = f"find_package(std_msgs REQUIRED)\nfind_package({name} REQUIRED)\ninstall("
    write_package(tmp_path, cmake=CMAKE.replace("install(", asking))
    (error,) = build_here(tmp_path).diagnostics
    assert (error.code, error.line) == ("BLD008", 5)
    assert error.hint == f"Did you mean `{meant}`?"


@pytest.mark.parametrize(
    "name",
    ["ament_cmake_ros", "ignition-cmake2", "gz-sim8", "gz_gui_vendor", "Eigen3", "BZip2", "PCL"],
)
def test_a_name_that_ros_and_gazebo_know_is_none(name: str, tmp_path: Path) -> None:
    asking = f"find_package({name} REQUIRED)\ninstall("
    write_package(tmp_path, cmake=CMAKE.replace("install(", asking))
    assert left_out(build_here(tmp_path)) == ()


def test_with_a_sourced_ros_nothing_is_left_out(tmp_path: Path) -> None:
    write_node(tmp_path)
    (error,) = build_here(
        tmp_path, environment={**outside(), "AMENT_PREFIX_PATH": sys.prefix}
    ).diagnostics
    assert (error.code, error.severity) == ("BLD008", Severity.ERROR)
    assert "find_package(rclcpp)" in error.message


def test_a_library_that_a_package_goes_on_without_is_not_assumed(tmp_path: Path) -> None:
    link = "find_library(THEIRS nobody_has_it)\nif(THEIRS)\n  message(FATAL_ERROR no)\nendif()"
    write_node(tmp_path, link)
    assert left_out(build_here(tmp_path)) == ()


def test_cmake_sees_the_variables_of_a_sourced_ros(tmp_path: Path) -> None:
    asks = 'if(NOT DEFINED ENV{ROS_DISTRO} OR NOT "$ENV{ROS_VERSION}" EQUAL 2)\n'
    write_package(tmp_path, cmake=CMAKE + asks + "message(FATAL_ERROR no)\nendif()\n")
    assert left_out(build_here(tmp_path)) == ()


@pytest.mark.parametrize("asks", ["", "find_package(Python3 REQUIRED COMPONENTS Interpreter)\n"])
def test_a_python_without_the_modules_of_ros_is_replaced(asks: str, tmp_path: Path) -> None:
    python = tmp_path / "python3"
    python.write_text("#!/bin/sh\nexit 1\n")
    python.chmod(0o755)
    names = f"set(Python3_EXECUTABLE {python} CACHE FILEPATH theirs FORCE)\n{asks}find_package("
    write_package(tmp_path, cmake=CMAKE.replace("find_package(", names, 1))
    assert left_out(build_here(tmp_path)) == ()
    assert cache_entry(tmp_path, "Python3_EXECUTABLE") == sys.executable


def test_a_command_of_a_missing_package_does_nothing(tmp_path: Path) -> None:
    asking = "find_package(nav2_common REQUIRED)\nnav2_package()\ninstall("
    write_package(tmp_path, cmake=CMAKE.replace("install(", asking))
    assert left_out(build_here(tmp_path)) == ("nav2_package()",)


AUTO = """\
cmake_minimum_required(VERSION 3.8...3.31)
project(demo LANGUAGES CXX)
find_package(ament_cmake_auto REQUIRED)
ament_auto_find_build_dependencies()
ament_auto_add_executable(node node.cpp)
ament_auto_package(INSTALL_TO_SHARE launch model)
"""


def test_ament_cmake_auto_installs_what_it_is_asked_to(tmp_path: Path) -> None:
    depends = PACKAGE_XML.replace("ament_cmake</buildtool", "ament_cmake_auto</buildtool")
    folder = write_package(tmp_path, package_xml=depends, cmake=AUTO)
    (folder / "node.cpp").write_text(PLAIN)
    assert left_out(build_here(tmp_path)) == ("node",)
    share = tmp_path / "install" / "demo" / "share"
    assert (share / "ament_index" / "resource_index" / "packages" / "demo").is_file()
    assert {"launch", "model"} <= {entry.name for entry in (share / "demo").iterdir()}


def test_a_misspelled_command_is_an_error_beside_a_missing_package(tmp_path: Path) -> None:
    asking = "find_package(nav2_common REQUIRED)\ninstall("
    cmake = CMAKE.replace("install(", asking).replace("ament_package", "ament_pakage")
    write_package(tmp_path, cmake=cmake)
    (error,) = build_here(tmp_path).diagnostics
    assert error.code == "BLD027"
    assert "ament_package" in (error.hint or "")


def test_what_depends_on_a_failed_package_is_built(tmp_path: Path) -> None:
    write_package(tmp_path, "broken", cmake=CMAKE.replace("launch model", "launch nothing"))
    depends = PACKAGE_XML.replace("  <export>", "  <depend>broken</depend>\n  <export>")
    asking = CMAKE.replace("install(", "find_package(broken REQUIRED)\ninstall(")
    write_package(tmp_path, "second", package_xml=depends, cmake=asking)
    third = depends.replace("broken", "second")
    write_package(tmp_path, "third", package_xml=third)
    result = build_here(tmp_path)
    assert not result.succeeded
    assert {one.name: one.outcome for one in result.packages} == {
        "broken": "failed",
        "second": "built",
        "third": "built",
    }
    (error,) = result.diagnostics
    assert (error.code, error.element) == ("BLD003", "broken")
    assert (tmp_path / "install/second/share/second/launch").is_dir()


def test_what_exports_a_target_that_is_left_out(tmp_path: Path) -> None:
    """With what is not left out; of export(), for which install(EXPORT) is not needed."""
    exports = """
add_library(core SHARED core.cpp)
install(TARGETS node EXPORT nodes DESTINATION lib/demo)
install(TARGETS core EXPORT cores LIBRARY DESTINATION lib)
export(EXPORT nodes FILE ${CMAKE_BINARY_DIR}/nodes.cmake NAMESPACE demo::)
export(EXPORT cores FILE ${CMAKE_BINARY_DIR}/cores.cmake)
export(TARGETS node FILE ${CMAKE_BINARY_DIR}/node.cmake)
export(TARGETS node core FILE ${CMAKE_BINARY_DIR}/both.cmake)
"""
    write_node(tmp_path, "ament_target_dependencies(node rclcpp)" + exports)
    (tmp_path / "src/demo/core.cpp").write_text("int core() { return 1; }\n")
    assert left_out(build_here(tmp_path)) == ("node",)
    made = {file.name for file in (tmp_path / "build" / "demo").glob("*.cmake")}
    assert {"cores.cmake", "both.cmake"} <= made
    assert made.isdisjoint({"nodes.cmake", "node.cmake"})


def test_without_a_compiler_files_are_installed(tmp_path: Path) -> None:
    write_node(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    result = build_here(tmp_path, environment={**outside(), "PATH": str(path)})
    assert left_out(result) == ("node",)
    assert "a C++ compiler" in result.packages[0].needs
    assert (tmp_path / "install/demo/share/demo/model/robot.xacro").is_file()


def test_a_compiler_that_was_installed_later_is_used(tmp_path: Path) -> None:
    write_node(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    build_here(tmp_path, environment={**outside(), "PATH": str(path)})
    assert left_out(build_here(tmp_path)) == ()
    assert (tmp_path / "install/demo/lib/demo/node").is_file()


def test_a_package_is_configured_again_once_it_can_be_compiled(tmp_path: Path) -> None:
    folder = tmp_path / "build" / "demo"
    folder.mkdir(parents=True)
    (folder / LEFT_OUT).write_text("missing rclcpp\ntarget node\n")
    arguments = folder / LAST_ARGUMENTS
    arguments.write_text("[]")
    prefix = tmp_path / "prefix"
    configure_again([folder], [prefix], ())
    assert arguments.exists()
    (prefix / "share/rclcpp/cmake").mkdir(parents=True)
    (prefix / "share/rclcpp/cmake/rclcppConfig.cmake").touch()
    configure_again([folder], [prefix], ())
    assert not arguments.exists()


def test_who_includes_a_file_in_this_way_gets_no_other(tmp_path: Path) -> None:
    mine = tmp_path / "mine.cmake"
    mine.write_text("")
    write_package(tmp_path)
    option = f"-DCMAKE_PROJECT_TOP_LEVEL_INCLUDES={mine}"
    assert build_here(tmp_path, colcon_arguments=("--cmake-args", option)).succeeded
    assert cache_entry(tmp_path, "CMAKE_PROJECT_TOP_LEVEL_INCLUDES") == str(mine)

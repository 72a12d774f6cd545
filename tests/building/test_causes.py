"""Why a build failed, from what CMake printed and the files of the package."""

from collections.abc import Collection
from pathlib import Path

from building.building import CMAKE, write_package
from wsgen.building.explain import explain
from wsgen.building.failure import Failure
from wsgen.diagnostics import Diagnostic

POLICY = """\
CMake Error at {file}:{line} (cmake_policy):
  Policy CMP0026 may not be set to OLD behavior because this version of CMake
  no longer supports it.  The policy was introduced in CMake version 3.0.0,
  and use of NEW behavior is now required.
"""
LACKS = """\
CMake Error at CMakeLists.txt:4 (find_package):
  By not providing "Find{name}.cmake" in CMAKE_MODULE_PATH this project has
  asked CMake to find a package configuration file provided by "{name}",
  but CMake did not find one.
"""


def explained(folder: Path, output: str, failed: Collection[str] = ()) -> Diagnostic:
    (found,) = explain(
        Failure(
            package="demo",
            folder=folder,
            is_python=False,
            build_folder=folder.parents[1] / "build" / "demo",
            output=output,
            siblings=("demo", "solver_vendor"),
            distro="",
            log=None,
            failed=failed,
        )
    )
    return found


def test_a_policy_that_cmake_4_has_removed(tmp_path: Path) -> None:
    folder = write_package(tmp_path, cmake=CMAKE + "cmake_policy(SET CMP0026 OLD)\n")
    found = explained(folder, POLICY.format(file="CMakeLists.txt", line=9))
    assert (found.code, found.line) == ("BLD070", 9)
    assert found.message == "demo: the package sets CMP0026 to OLD, which CMake 4 refuses."
    assert "cmake<4" in (found.hint or "")


def test_a_policy_of_a_project_that_the_package_downloads(tmp_path: Path) -> None:
    """CMake names the file of that project as one of the package."""
    folder = write_package(tmp_path)
    found = explained(folder, POLICY.format(file="CMakeLists.txt", line=3))
    assert (found.code, found.file, found.line) == ("BLD070", folder, None)
    assert found.message.startswith("demo: a project that the package builds sets CMP0026")


def test_a_name_that_a_failed_package_would_have_brought(tmp_path: Path) -> None:
    cmake = CMAKE.replace("install(", "find_package(solver REQUIRED)\ninstall(")
    folder = write_package(tmp_path, cmake=cmake)
    output = LACKS.format(name="solver")
    assert "No ROS distribution" in (explained(folder, output).hint or "")
    found = explained(folder, output, failed=["solver_vendor"])
    assert found.message == (
        "demo: find_package(solver) does not find the package. The build of solver_vendor failed, "
        "which may bring it."
    )
    assert found.hint == "Correct solver_vendor first."


def test_a_name_of_ros_has_nothing_to_do_with_a_failed_package(tmp_path: Path) -> None:
    cmake = CMAKE.replace("install(", "find_package(rclcpp REQUIRED)\ninstall(")
    folder = write_package(tmp_path, cmake=cmake)
    found = explained(folder, LACKS.format(name="rclcpp"), failed=["solver_vendor"])
    assert "solver_vendor" not in found.message

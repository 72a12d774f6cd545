"""A test of pytest: of the robot that a package spawns, of its modules or its nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen.errors import RequestError
from wsgen.packages.workspace.layout import find_launch_files
from wsgen.porting.adding.cmake import CMake
from wsgen.porting.adding.types import check_name
from wsgen.text.files import read_or_empty

if TYPE_CHECKING:
    from wsgen.porting.adding.addition import Addition

_SPAWNING = ("spawn_entity", "ros_gz_sim", "ros_ign_gazebo", "gazebo_ros")


def add_test(addition: Addition, name: str) -> None:
    """Add a test: of its robot, if a launch file of the package spawns one.

    Raises:
        RequestError: The name cannot be, or there is nothing to test.
    """
    stem = name.removesuffix(".py").removeprefix("test_")
    check_name("test", stem)
    launch_files = find_launch_files(addition.folder)
    if any(word in read_or_empty(file) for file in launch_files for word in _SPAWNING):
        add_test_file(addition, stem, "test_robot.py")
    elif (addition.folder / addition.name / "__init__.py").is_file():
        add_test_file(addition, stem, "test.py", test=stem)
    elif launch_files:
        name = launch_files[0].name
        add_test_file(addition, stem, "test_launch.py", test=stem, launch_file=name)
    else:
        raise RequestError(
            f"{addition.name} has neither a launch file nor a Python package to be tested.",
            hint="Add a node first, which comes with a test: wsgen add node NAME",
        )


def add_test_file(addition: Addition, name: str, template: str, **names: Any) -> None:
    """Add a test of a template that `colcon test` runs."""
    path = f"test/test_{name}.py"
    addition.create(path, template, **names)
    if addition.is_python:
        addition.depend("test_depend", "python3-pytest")
    else:
        CMake(addition).test(f"test_{name}", path)
        addition.depend("test_depend", "ament_cmake_pytest")

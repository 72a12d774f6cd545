"""Causes of a failed build that lie in the files of the package."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import has_errors
from wsgen.suggestions import ask_for_nearest, did_you_mean, nearest
from wsgen.workspace.cmake_text import read_calls
from wsgen.workspace.package_xml import check_package_xml

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.workspace.failure import Failure

MISSING_MANIFEST = "PKG010"
MISSING_AMENT_CMAKE = "BLD002"
MISSING_INSTALLED_PATH = "BLD003"
MISSING_DEPENDENCY = "BLD008"
REPEATED_AMENT_PACKAGE = "BLD009"
MISSING_CMAKE_FILE = "BLD021"

# Names that may have been meant.
USUAL_PACKAGES = (
    *("ament_cmake", "ament_cmake_auto", "ament_cmake_python", "ament_lint_auto", "rclcpp"),
    *("controller_manager", "gazebo_dev", "gazebo_msgs", "gazebo_ros", "geometry_msgs"),
    *("hardware_interface", "joint_state_publisher", "nav_msgs", "pluginlib", "rclpy"),
    *("robot_state_publisher", "rosidl_default_generators", "sensor_msgs", "std_msgs", "tf2"),
    *("tf2_ros", "trajectory_msgs", "urdf", "visualization_msgs", "xacro"),
)

GIT_KEEPS_NO_EMPTY_FOLDERS = (
    " Git keeps no empty folders: one that was empty is missing from a clone."
)


def refused_manifest(failure: Failure) -> Iterator[Diagnostic]:
    """Say what is wrong with package.xml.

    colcon takes the package for one of plain CMake then, in another environment and with other
    arguments, so that whatever fails after that may have its cause here.
    """
    file = failure.folder / "package.xml"
    findings = check_package_xml(file) if file.is_file() else ()
    if has_errors(findings):
        yield from findings


def _missing_manifest(failure: Failure) -> Iterator[Diagnostic]:
    if not (failure.folder / "package.xml").exists() and "package.xml" in failure.output:
        yield failure.diagnose(
            MISSING_MANIFEST,
            "package.xml is missing, by which the package is a package of ROS.",
            hint="Bring it back (git checkout package.xml), or write one; to begin afresh: "
            "wsgen new PACKAGE",
        )


def _missing_cmake_file(failure: Failure) -> Iterator[Diagnostic]:
    if not failure.cmake_file.exists():
        yield failure.diagnose(
            MISSING_CMAKE_FILE,
            "CMakeLists.txt is missing, by which the package is built and installed.",
            hint="Bring it back (git checkout CMakeLists.txt), or write one.",
        )


def _missing_package(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'configuration file provided by "(.+?)"', error.message)
        if match is None:
            continue
        name = match[1]
        if name == "ament_cmake":
            yield failure.diagnose(
                MISSING_AMENT_CMAKE,
                "ament_cmake was not found.",
                error=error,
                hint="Source a ROS (source /opt/ros/<distro>/setup.bash), or install the one that "
                "comes with wsgen: python3 -m pip install --force-reinstall ros-ament-cmake",
            )
        elif name in failure.siblings:
            yield failure.diagnose(
                MISSING_DEPENDENCY,
                f"{name} is in this workspace and was not built before.",
                error=error,
                hint=f"Add <depend>{name}</depend> to package.xml, from which colcon takes the "
                "order.",
            )
        else:
            yield failure.diagnose(
                MISSING_DEPENDENCY,
                f"find_package({name}) found nothing.",
                error=error,
                hint=_where_to_get(name, failure),
            )


def _where_to_get(name: str, failure: Failure) -> str:
    known = {*failure.siblings, *USUAL_PACKAGES}
    near = None if name in known else nearest(name, known, cutoff=0.75)
    if near is not None:
        return did_you_mean(near)
    without = "remove the line if it is only launched or read, not compiled against"
    if failure.distro:
        return f"Install it (apt: ros-{failure.distro}-{name.replace('_', '-')}), or {without}."
    return f"Source the ROS that has it (source /opt/ros/<distro>/setup.bash), or {without}."


def _repeated_ament_package(failure: Failure) -> Iterator[Diagnostic]:
    calls = [call for call in read_calls(failure.cmake_file) if call.command == "ament_package"]
    if len(calls) > 1 and "ament_package" in failure.output:
        yield failure.diagnose(
            REPEATED_AMENT_PACKAGE,
            f"ament_package() is called again; the first call is in line {calls[0].line}.",
            line=calls[1].line,
            hint="Call it once, at the end.",
        )


def _missing_installed_path(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'file INSTALL cannot find "(.+?)"', error.message)
        if match is None:
            continue
        path = failure.folder / match[1]
        if not path.is_relative_to(failure.folder):
            continue
        name = str(path.relative_to(failure.folder))
        line, kind = _find_install(failure, name)
        beside = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else []
        yield failure.diagnose(
            MISSING_INSTALLED_PATH,
            f"the {kind} {name} is to be installed and does not exist.",
            line=line,
            hint=f"{ask_for_nearest(path.name, beside)}Make it, or take it out of install()."
            f"{GIT_KEEPS_NO_EMPTY_FOLDERS if kind == 'folder' else ''}",
        )


def _find_install(failure: Failure, name: str) -> tuple[int | None, str]:
    """Find the line that installs the path, and whether it takes it for a folder or a file."""
    for call in read_calls(failure.cmake_file):
        if call.command != "install":
            continue
        for argument, line in zip(call.arguments, call.argument_lines, strict=True):
            if argument.rstrip("/") == name or argument.rstrip("/").endswith(f"}}/{name}"):
                return line, "folder" if "DIRECTORY" in call.arguments else "file"
    return None, "file or folder"


CAUSES = (
    _missing_manifest,
    _missing_cmake_file,
    _missing_package,
    _repeated_ament_package,
    _missing_installed_path,
)

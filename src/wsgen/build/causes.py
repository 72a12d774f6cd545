"""Causes of a failed build that are a single word of CMakeLists.txt, or one too few.

Causes of a failed build that lie in the machine: a tool is missing, old or the wrong one.

Causes of a failed build that lie in the files of the package.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.build.cmake_text import find_open_block, find_open_quote, read_calls
from wsgen.diagnostics import Diagnostic, has_errors
from wsgen.suggestions import ask_for_nearest, did_you_mean, nearest
from wsgen.workspace.manifest import read_manifest
from wsgen.workspace.package_xml import check_package_xml

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.build.failure import Failure


CMAKE_SYNTAX = "BLD011"
UNKNOWN_COMMAND = "BLD027"
MISSING_DESTINATION = "BLD028"
DIFFERENT_NAMES = "BLD029"

# What packages of robots call, and the package that brings it; CMake's own without one.
COMMANDS = {
    "ament_auto_find_build_dependencies": "ament_cmake_auto",
    "ament_auto_package": "ament_cmake_auto",
    "ament_environment_hooks": "ament_cmake",
    "ament_export_dependencies": "ament_cmake",
    "ament_export_include_directories": "ament_cmake",
    "ament_export_libraries": "ament_cmake",
    "ament_export_targets": "ament_cmake",
    "ament_lint_auto_find_test_dependencies": "ament_lint_auto",
    "ament_package": "ament_cmake",
    "ament_python_install_package": "ament_cmake_python",
    "ament_target_dependencies": "ament_cmake",
    "rosidl_generate_interfaces": "rosidl_default_generators",
    "xacro_add_files": "xacro",
    **dict.fromkeys(
        (
            *("add_compile_options", "add_custom_command", "add_custom_target"),
            *("add_executable", "add_library", "add_subdirectory", "cmake_minimum_required"),
            *("configure_file", "else", "elseif", "endif", "endforeach", "endfunction"),
            *("execute_process", "file", "find_package", "foreach", "function", "if", "include"),
            *("include_directories", "install", "list", "message", "option", "project", "set"),
            *("string", "target_compile_features", "target_include_directories"),
            *("target_link_libraries",),
        ),
        "",
    ),
}


def unclosed_quote(failure: Failure) -> Iterator[Diagnostic]:
    """Name the line on which a quotation mark opens what CMake reads to the end of the file."""
    if any(error.message.startswith("Parse error") for error in failure.errors):
        line = find_open_quote(failure.cmake_file)
        if line is not None:
            yield failure.diagnose(
                CMAKE_SYNTAX,
                "a quotation mark is opened here and not closed on this line.",
                line=line,
                hint='Close it: "..."',
            )


def unclosed_block(failure: Failure) -> Iterator[Diagnostic]:
    """Name the if() that has no endif(), and its like."""
    if not any("not properly nested" in error.message for error in failure.errors):
        return
    opened, closing = find_open_block(failure.cmake_file)
    if opened is not None:
        end = f"end{opened.command}()"
        where = f" before {closing.command}() in line {closing.line}" if closing else ""
        yield failure.diagnose(
            CMAKE_SYNTAX,
            f"{opened.command}() in line {opened.line} has no {end}{where}.",
            line=opened.line,
            hint=f"Add {end} where the block ends.",
        )
    elif closing is not None:
        yield failure.diagnose(
            CMAKE_SYNTAX,
            f"{closing.command}() in line {closing.line} ends no {closing.command[3:]}().",
            line=closing.line,
            hint=f"Remove {closing.command}(), or add {closing.command[3:]}() before the block.",
        )


def syntax(failure: Failure) -> Iterator[Diagnostic]:
    """Hand on where CMake could not read on."""
    for error in failure.errors:
        if error.message.startswith("Parse error"):
            what = error.message.removeprefix("Parse error.").strip()
            yield failure.diagnose(
                CMAKE_SYNTAX,
                f"CMake cannot read the file: {what}",
                error=error,
                hint="Look for a parenthesis or quotation mark that is not closed, from this line "
                "on.",
            )
            return


def unknown_command(failure: Failure) -> Iterator[Diagnostic]:
    """Name the command that was meant, or the package that brings it."""
    # Only the first error: a command can be unknown because a find_package() before it failed.
    for error in failure.errors[:1]:
        match = re.search(r'Unknown CMake command "(\w+)"', error.message)
        if match is None:
            continue
        own = {
            call.arguments[0].lower()
            for call in read_calls(failure.cmake_file)
            if call.command in {"function", "macro"} and call.arguments
        }
        name = match[1].lower()
        near = nearest(name, {*COMMANDS, *own}, cutoff=0.7)
        if COMMANDS.get(name):
            hint = f"Write before it: find_package({COMMANDS[name]} REQUIRED)"
        elif near:
            hint = did_you_mean(near)
        else:
            hint = "Fix its name, or find the package that brings it before it is called."
        yield failure.diagnose(
            UNKNOWN_COMMAND, f"there is no CMake command {match[1]}().", error=error, hint=hint
        )


def missing_destination(failure: Failure) -> Iterator[Diagnostic]:
    """Say where to install what is to be installed nowhere."""
    for error in failure.errors:
        match = re.search(r"install (\w+) given no .*DESTINATION", error.message)
        if match:
            place = "lib" if match[1] in {"TARGETS", "PROGRAMS"} else "share"
            yield failure.diagnose(
                MISSING_DESTINATION,
                f"install({match[1]} ...) does not say where to.",
                error=error,
                hint=f"Add before its parenthesis: DESTINATION {place}/${{PROJECT_NAME}}",
            )


def different_names(failure: Failure) -> Iterator[Diagnostic]:
    """Say which file calls the package what."""
    for error in failure.errors:
        match = re.search(
            r"package name '(.+?)' in '.*?' does not match current PROJECT_NAME '(.*?)'",
            error.message,
        )
        if match is None:
            continue
        manifest = read_manifest(failure.folder / "package.xml")
        line = None if isinstance(manifest, Diagnostic) else manifest.line_of("name")
        called = [call for call in read_calls(failure.cmake_file) if call.command == "project"]
        yield failure.diagnose(
            DIFFERENT_NAMES,
            f"project() calls the package {match[2]}, and package.xml"
            f"{f' (line {line})' if line else ''} calls it {match[1]}.",
            error=None if called else error,
            line=called[-1].line if called else None,
            hint=f"Write project({match[1]}) here, or <name>{match[2]}</name> in package.xml; "
            "launch files and $(find ...) know the package by the name in package.xml.",
        )


CMAKE_CAUSES = (
    unclosed_quote,
    unclosed_block,
    syntax,
    unknown_command,
    missing_destination,
    different_names,
)


WRONG_PYTHON = "BLD004"
UNSUPPORTED_EMPY = "BLD005"
MISSING_COMPILER = "BLD006"
MISSING_CMAKE = "BLD007"
OLD_CMAKE_MINIMUM = "BLD012"
OLD_CMAKE = "BLD013"
MISSING_BUILD_PROGRAM = "BLD014"


def _unsupported_empy(failure: Failure) -> Iterator[Diagnostic]:
    if re.search(
        r"module 'em' has no attribute|No module named 'em'$", failure.output, re.MULTILINE
    ):
        yield failure.diagnose(
            UNSUPPORTED_EMPY,
            f"the templates of ROS need empy 3, and the Python that CMake took"
            f"{_python_taken(failure)} has another one, or none.",
            hint="Install it there: python3 -m pip install 'empy>=3.3.4,<4' (apt: python3-empy). "
            f"{failure.forget}",
        )


def _wrong_python(failure: Failure) -> Iterator[Diagnostic]:
    match = re.search(r"No module named '?(catkin_pkg|ament_package)", failure.output)
    if match:
        yield failure.diagnose(
            WRONG_PYTHON,
            f"CMake took a Python{_python_taken(failure)} that does not have {match[1]}.",
            hint=f"{failure.forget} Leave other environments (conda, venv) and give no "
            "Python3_EXECUTABLE; under a sourced ROS: sudo apt install python3-catkin-pkg-modules.",
        )


def _missing_cmake(failure: Failure) -> Iterator[Diagnostic]:
    if "Could not find 'cmake' executable" in failure.output or re.search(
        r"FileNotFoundError: .*cmake", failure.output
    ):
        yield failure.diagnose(
            MISSING_CMAKE,
            "there is no CMake.",
            hint="Install it: python3 -m pip install cmake (apt: cmake); CMAKE_COMMAND, if it is "
            "set, must be the path of one.",
        )


def _missing_build_program(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'unable to find a build program corresponding to "(.+?)"', error.message)
        if match:
            yield failure.diagnose(
                MISSING_BUILD_PROGRAM,
                f"there is no program for CMake's generator {match[1]}.",
                hint=f"Install it (apt: make or ninja-build). {failure.forget}",
            )
            return


def _missing_compiler(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r"No CMAKE_(C|CXX)_COMPILER could be found", error.message)
        if match:
            yield failure.diagnose(
                MISSING_COMPILER,
                f"there is no {'C' if match[1] == 'C' else 'C++'} compiler.",
                error=error,
                hint=f"A package without C and C++ needs none: project({failure.package} LANGUAGES "
                "NONE). Otherwise install one (apt: build-essential).",
            )
            return


def _cmake_version(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        if re.search(r"Compatibility with CMake < \S+ has been removed", error.message):
            yield failure.diagnose(
                OLD_CMAKE_MINIMUM,
                "cmake_minimum_required names a version that this CMake no longer imitates.",
                error=error,
                hint="Write cmake_minimum_required(VERSION 3.20), which every supported ROS has; "
                "for packages of others: wsgen build -- --cmake-args "
                "-DCMAKE_POLICY_VERSION_MINIMUM=3.5",
            )
        match = re.search(
            r"CMake (\S+) or higher is required\. You are running version (\S+)", error.message
        )
        if match:
            yield failure.diagnose(
                OLD_CMAKE,
                f"CMake {match[1]} is needed, and this is {match[2].rstrip('.')}.",
                error=error,
                hint="Install a newer one: python3 -m pip install -U cmake; CMAKE_COMMAND, if it "
                "is set, chooses the one that is used.",
            )


def _python_taken(failure: Failure) -> str:
    match = re.search(r"execute_process\((\S+)", failure.output)
    return f" ({match[1]})" if match else ""


MACHINE_CAUSES = (
    _unsupported_empy,
    _wrong_python,
    _missing_cmake,
    _missing_build_program,
    _missing_compiler,
    _cmake_version,
)


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


PACKAGE_CAUSES = (
    _missing_manifest,
    _missing_cmake_file,
    _missing_package,
    _repeated_ament_package,
    _missing_installed_path,
)

"""Causes of a failed build that lie in the machine: a tool is missing, old or the wrong one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.workspace.failure import Failure

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


CAUSES = (
    _unsupported_empy,
    _wrong_python,
    _missing_cmake,
    _missing_build_program,
    _missing_compiler,
    _cmake_version,
)

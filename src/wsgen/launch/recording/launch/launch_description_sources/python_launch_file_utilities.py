"""Load launch files that are written in Python."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from launch.invalid_launch_file_error import InvalidLaunchFileError
from wsgen.launch.record import RECORD, locate

if TYPE_CHECKING:
    from launch.launch_description import LaunchDescription


class InvalidPythonLaunchFileError(InvalidLaunchFileError):
    """A Python launch file without the function that makes it one."""


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Execute the file; no bytecode is written beside it."""
    path = os.fspath(python_launch_file_path)
    source = Path(path).read_bytes()
    RECORD.launch_files.append(path)
    module = ModuleType("python_launch_file")
    module.__file__ = path
    exec(compile(source, path, "exec"), module.__dict__)  # noqa: S102  a launch file is a program
    return module


def get_launch_description_from_python_launch_file(
    python_launch_file_path: str,
) -> LaunchDescription:
    """What its function gives."""
    module = load_python_launch_file_as_module(python_launch_file_path)
    generate = getattr(module, "generate_launch_description", None)
    if generate is None:
        error = InvalidPythonLaunchFileError(
            f"launch file at '{python_launch_file_path}' does not contain the required function "
            "'generate_launch_description()'"
        )
        locate(error, (python_launch_file_path, 1))
        raise error
    description: LaunchDescription = generate()
    if not hasattr(description, "visit"):
        error_type = TypeError(
            "generate_launch_description() must return a LaunchDescription, "
            f"but returned {description!r}"
        )
        line = generate.__code__.co_firstlineno if hasattr(generate, "__code__") else 1
        locate(error_type, (python_launch_file_path, line))
        raise error_type
    return description

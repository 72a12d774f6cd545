"""Where launch descriptions come from."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from launch._finder import show_public_names
from launch.base import InvalidLaunchFileError
from launch.launch_description import LaunchDescriptionSource
from wsgen.launching.plain import is_plain
from wsgen.launching.record import RECORD, locate
from wsgen.text.files import read_whole

if TYPE_CHECKING:
    from launch.base import SomeSubstitutionsType
    from launch.launch_description import LaunchDescription


SIZE_LIMIT = 2**23  # bytes; what people write by hand is far smaller


class InvalidPythonLaunchFileError(InvalidLaunchFileError):
    """A Python launch file without the function that makes it one."""


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Execute the file; no bytecode is written beside it."""
    path = os.fspath(python_launch_file_path)
    source = read_whole(Path(path), SIZE_LIMIT)
    RECORD.require_plain(lambda: path == RECORD.plain_file or is_plain(source))
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


def get_launch_description_from_any_launch_file(launch_file_path: str) -> LaunchDescription:
    """The description; a file of an unknown format is executed as Python, as in the original."""
    extension = os.path.splitext(launch_file_path)[1].lower()
    if extension in {".xml", ".yaml", ".yml"}:
        from launch.frontend.parser import get_launch_description_from_frontend_launch_file

        return get_launch_description_from_frontend_launch_file(launch_file_path)
    return get_launch_description_from_python_launch_file(launch_file_path)


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file whose format its name says."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_any_launch_file(location)


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file that is no program."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted frontend launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        from launch.frontend.parser import get_launch_description_from_frontend_launch_file

        return get_launch_description_from_frontend_launch_file(location)


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A Python launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted python launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_python_launch_file(location)


show_public_names(__name__)

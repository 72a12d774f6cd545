"""Launch files of any format."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from launch.launch_description_source import LaunchDescriptionSource
from launch.launch_description_sources.python_launch_file_utilities import (
    get_launch_description_from_python_launch_file,
)

if TYPE_CHECKING:
    from launch.launch_description import LaunchDescription
    from launch.some_substitutions_type import SomeSubstitutionsType


def get_launch_description_from_any_launch_file(launch_file_path: str) -> LaunchDescription:
    """The description; a file of an unknown format is executed as Python, as in the original."""
    extension = os.path.splitext(launch_file_path)[1].lower()
    if extension in {".xml", ".yaml", ".yml"}:
        from launch.frontend.file import get_launch_description_from_frontend_launch_file

        return get_launch_description_from_frontend_launch_file(launch_file_path)
    return get_launch_description_from_python_launch_file(launch_file_path)


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file whose format its name says."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_any_launch_file(location)

"""Launch files in XML or YAML."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.launch_description_source import LaunchDescriptionSource

if TYPE_CHECKING:
    from launch.launch_description import LaunchDescription
    from launch.some_substitutions_type import SomeSubstitutionsType


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file that is no program."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted frontend launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        from launch.frontend.file import get_launch_description_from_frontend_launch_file

        return get_launch_description_from_frontend_launch_file(location)

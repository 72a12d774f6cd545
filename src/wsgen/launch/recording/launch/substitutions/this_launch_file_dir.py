"""Where the launch file lies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that was loaded last, as in the original."""

    def describe(self) -> str:
        """Itself in words."""
        return "ThisLaunchFileDir()"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        folder = context.get_locals_as_dict().get("current_launch_file_directory")
        if folder is None:
            raise SubstitutionFailure(
                "ThisLaunchFileDir used outside of a launch file (in a script)"
            )
        return str(folder)

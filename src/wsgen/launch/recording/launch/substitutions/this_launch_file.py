"""The launch file itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class ThisLaunchFile(Substitution):
    """The path of the launch file that was loaded last, as in the original."""

    def describe(self) -> str:
        """Itself in words."""
        return "ThisLaunchFile()"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        path = context.get_locals_as_dict().get("current_launch_file_path")
        if path is None:
            raise SubstitutionFailure("ThisLaunchFile used outside of a launch file (in a script)")
        return str(path)

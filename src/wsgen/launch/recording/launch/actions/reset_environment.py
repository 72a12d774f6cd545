"""Go back to the first environment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.action import Action

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class ResetEnvironment(Action):
    """The environment is as it was before the launch."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the environment."""
        context._reset_environment()  # noqa: SLF001  a friend of the context

"""Begin a scope of configurations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.action import Action

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class PushLaunchConfigurations(Action):
    """What is set from here on ends with the scope."""

    def execute(self, context: LaunchContext) -> None:
        """Remember the configurations."""
        context._push_launch_configurations()  # noqa: SLF001  a friend of the context

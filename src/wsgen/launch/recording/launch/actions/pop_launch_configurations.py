"""End a scope of configurations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.action import Action

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class PopLaunchConfigurations(Action):
    """Configurations are as they were when the scope began."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the configurations."""
        context._pop_launch_configurations()  # noqa: SLF001  a friend of the context

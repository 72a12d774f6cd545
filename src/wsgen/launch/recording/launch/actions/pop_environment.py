"""End a scope of the environment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.action import Action

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class PopEnvironment(Action):
    """The environment is as it was when the scope began."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the environment."""
        context._pop_environment()  # noqa: SLF001  a friend of the context

"""Begin a scope of the environment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.action import Action

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class PushEnvironment(Action):
    """What is set from here on ends with the scope."""

    def execute(self, context: LaunchContext) -> None:
        """Remember the environment."""
        context._push_environment()  # noqa: SLF001  a friend of the context

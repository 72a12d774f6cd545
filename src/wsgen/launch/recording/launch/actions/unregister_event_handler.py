"""Wait no longer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action

if TYPE_CHECKING:
    from launch.event_handler import BaseEventHandler
    from launch.launch_context import LaunchContext


class UnregisterEventHandler(Action):
    """From here on the handler is not asked any more."""

    def __init__(self, event_handler: BaseEventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Unregister it."""
        context.unregister_event_handler(self.__event_handler)

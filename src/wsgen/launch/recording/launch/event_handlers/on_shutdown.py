"""When the launch ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.event_handler import BaseEventHandler
from launch.events.shutdown import Shutdown

if TYPE_CHECKING:
    from launch.event import Event
    from launch.launch_context import LaunchContext


class OnShutdown(BaseEventHandler):
    """What is done when the launch ends."""

    def __init__(self, *, on_shutdown: Any, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), **kwargs)
        self.__on_shutdown = on_shutdown

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the actions, or what the function gives."""
        super().handle(event, context)
        if callable(self.__on_shutdown):
            return self.__on_shutdown(event, context)
        return self.__on_shutdown

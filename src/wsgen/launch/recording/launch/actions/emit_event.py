"""Let an event happen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.event import Event

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class EmitEvent(Action):
    """Lets the event happen after what is being done."""

    def __init__(self, *, event: Event, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not isinstance(event, Event):
            raise TypeError(f"EmitEvent() expected an event instance, got '{event}'")
        self.__event = event

    @property
    def event(self) -> Event:
        """The event."""
        return self.__event

    def execute(self, context: LaunchContext) -> None:
        """Let it happen."""
        from launch.events.shutdown import Shutdown

        if isinstance(self.__event, Shutdown):
            context.shut_down(self.__event)
        else:
            context.emit_event_sync(self.__event)

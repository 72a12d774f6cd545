"""What is done when an event happens."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._located import Located

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from launch.event import Event
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity


class BaseEventHandler(Located):
    """Decides which events it handles; with `handle_once` only the first."""

    def __init__(self, *, matcher: Callable[[Event], bool], handle_once: bool = False) -> None:
        self.__matcher = matcher
        self.__handle_once = handle_once

    @property
    def handle_once(self) -> bool:
        """Whether it is unregistered after the first event."""
        return self.__handle_once

    @property
    def handler_description(self) -> str:
        """What it does, in words."""
        return "<unknown>"

    def matches(self, event: Event) -> bool:
        """Whether it handles this event."""
        return self.__matcher(event)

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and what it is known to bring about."""
        return type(self).__name__, []

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Handle the event; what comes back is visited."""
        del event
        if self.__handle_once:
            context.unregister_event_handler(self)


class EventHandler(BaseEventHandler):
    """Brings about the entities it was given."""

    def __init__(
        self,
        *,
        matcher: Callable[[Event], bool],
        entities: LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity] | None = None,
        handle_once: bool = False,
    ) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self.__entities = entities

    @property
    def entities(self) -> Any:
        """What is visited when the event happens."""
        return self.__entities

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and its entities."""
        text, entities = super().describe()
        if self.__entities is not None:
            entities.extend(
                self.__entities if isinstance(self.__entities, (list, tuple)) else [self.__entities]  # type: ignore[list-item]  # one entity
            )
        return text, entities

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the entities."""
        super().handle(event, context)
        return self.__entities

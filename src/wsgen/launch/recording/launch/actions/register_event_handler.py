"""Wait for events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.event_handler import BaseEventHandler
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity


class RegisterEventHandler(Action):
    """From here on the handler is asked."""

    def __init__(self, event_handler: BaseEventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__event_handler = event_handler

    @property
    def event_handler(self) -> BaseEventHandler:
        """The handler."""
        return self.__event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it."""
        context.register_event_handler(self.__event_handler)

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What the handler is known to bring about."""
        text, entities = self.__event_handler.describe()
        return [(text, entities)] if entities else []

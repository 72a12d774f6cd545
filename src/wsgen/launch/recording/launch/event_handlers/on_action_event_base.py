"""Handlers of what happens to an action."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from launch.event_handler import BaseEventHandler
from launch.launch_description_entity import LaunchDescriptionEntity

if TYPE_CHECKING:
    from launch.action import Action
    from launch.event import Event
    from launch.launch_context import LaunchContext


class OnActionEventBase(BaseEventHandler):
    """Waits for events of one action, of the actions that a matcher accepts, or of all."""

    def __init__(
        self,
        *,
        action_matcher: Any,
        on_event: Any,
        target_event_cls: type[Event],
        target_action_cls: type[Action],
        **kwargs: Any,
    ) -> None:
        # What is not known may be an action; it is no matcher, though it can be called.
        is_action = isinstance(action_matcher, target_action_cls) or hasattr(
            action_matcher, "wsgen_is_unknown"
        )
        if not is_action and action_matcher is not None and not callable(action_matcher):
            raise TypeError(
                f"action_matcher must be an '{target_action_cls.__name__}' instance or a callable"
            )

        def matches(event: Event) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            action = event.action  # type: ignore[attr-defined]  # all events of actions have one
            if callable(action_matcher) and not is_action:
                return bool(action_matcher(action))
            return action_matcher is None or action is action_matcher

        super().__init__(matcher=matches, **kwargs)
        self._on_event = on_event
        self._actions = [] if callable(on_event) else _entities(on_event)

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Give the actions, or what the function gives."""
        super().handle(event, context)
        return self._actions or self._function()(event, context)

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Itself in words, and its actions."""
        text, actions = super().describe()
        if not self._actions:
            self._function()
        actions.extend(self._actions)
        return text, actions

    def _function(self) -> Any:
        if not callable(self._on_event):
            # The original fails here too, before anything is started.
            raise AttributeError(  # noqa: TRY004  its type is that of the original
                f"'{type(self).__name__}' was given no actions: the list is empty"
            )
        return self._on_event


def _entities(on_event: Any) -> list[LaunchDescriptionEntity]:
    if not isinstance(on_event, Iterable):
        return [on_event]
    entities = list(on_event)
    for entity in entities:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(
                "expected all items in 'on_event' iterable to be of type "
                f"'LaunchDescriptionEntity' but got '{type(entity)}'"
            )
    return entities

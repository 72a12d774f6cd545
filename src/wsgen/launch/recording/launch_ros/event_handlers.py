"""When a node changes its state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._finder import show_public_names
from launch.base import EventHandler
from launch_ros.lifecycle_events import StateTransition

if TYPE_CHECKING:
    from launch.base import Event
    from launch_ros.actions import LifecycleNode


class OnStateTransition(EventHandler):
    """What is done when a node comes to a state, from another one where that is said."""

    def __init__(
        self,
        *,
        entities: Any,
        target_lifecycle_node: LifecycleNode | None = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        **kwargs: Any,
    ) -> None:
        del transition  # the original does not look at it either

        def matches(event: Event) -> bool:
            return (
                isinstance(event, StateTransition)
                and target_lifecycle_node in {None, event.action}
                and start_state in {None, event.start_state}
                and goal_state in {None, event.goal_state}
            )

        super().__init__(matcher=matches, entities=entities, **kwargs)


show_public_names(__name__)

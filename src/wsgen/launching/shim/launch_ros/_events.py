"""What happens to nodes: the events of `launch_ros.events`, and the event handler for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.base import Event, EventHandler

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch_ros.actions import LifecycleNode, Node


def matches_node_name(node_name: str) -> Callable[[Node], bool]:
    """Whether a node has this full name."""
    return lambda node: node.node_name == "/" + node_name.lstrip("/")


class ChangeState(Event):
    """Meant for the nodes that the matcher accepts."""

    name = "launch_ros.events.lifecycle.ChangeState"

    def __init__(
        self,
        *,
        lifecycle_node_matcher: Callable[[LifecycleNode], bool],
        transition_id: int,
    ) -> None:
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(Event):
    """From one state to the next, both by name; rcl gives no label of the transition."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(
        self,
        *,
        action: LifecycleNode,
        start_state: str,
        goal_state: str,
        transition: str = "",
        timestamp: int = 0,  # ns
    ) -> None:
        self.action = action
        self.timestamp = timestamp
        self.transition = transition
        self.start_state = start_state
        self.goal_state = goal_state


class OnStateTransition(EventHandler):
    """What is done when a node comes to a state, from another one where that is said."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        entities: Any,
        target_lifecycle_node: LifecycleNode | None = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[Event], bool] | None = None,
        **kwargs: Any,
    ) -> None:
        def matches(event: Event) -> bool:
            return (
                isinstance(event, StateTransition)
                and target_lifecycle_node in {None, event.action}
                and transition in {None, event.transition}
                and start_state in {None, event.start_state}
                and goal_state in {None, event.goal_state}
            )

        super().__init__(matcher=matcher or matches, entities=entities, **kwargs)

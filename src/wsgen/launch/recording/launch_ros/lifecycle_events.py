"""Things that happen to nodes with states."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.base import Event
from launch_ros.events import matches_node_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch_ros.actions import LifecycleNode


__all__ = ["ChangeState", "StateTransition", "matches_node_name"]


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
    """From one state to the next, both by name."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: LifecycleNode, start_state: str, goal_state: str) -> None:
        self.action = action
        self.start_state = start_state
        self.goal_state = goal_state

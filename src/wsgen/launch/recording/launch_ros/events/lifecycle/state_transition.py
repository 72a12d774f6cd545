"""A node has changed its state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.event import Event

if TYPE_CHECKING:
    from launch_ros.actions.lifecycle_node import LifecycleNode


class StateTransition(Event):
    """From one state to the next, both by name."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: LifecycleNode, start_state: str, goal_state: str) -> None:
        self.action = action
        self.start_state = start_state
        self.goal_state = goal_state

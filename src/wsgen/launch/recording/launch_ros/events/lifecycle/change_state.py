"""A node is asked to change its state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.event import Event

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch_ros.actions.lifecycle_node import LifecycleNode


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

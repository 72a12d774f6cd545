"""Ask nodes to change their states."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.events.lifecycle.change_state import ChangeState
from launch_ros.events.matchers import matches_node_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext


class LifecycleTransition(Action):
    """Asks each of the nodes for each of the transitions, one after the other."""

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[Any],
        transition_ids: Iterable[Any],
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__names = [normalize_to_list_of_substitutions(name) for name in lifecycle_node_names]
        self.__transitions = [
            normalize_to_list_of_substitutions(str(one) if isinstance(one, int) else one)
            for one in transition_ids
        ]
        if not self.__names or not self.__transitions:
            raise RuntimeError("lifecycle_node_names and transition_ids must not be empty")

    def execute(self, context: LaunchContext) -> None:
        """Ask them."""
        for name in self.__names:
            matcher = matches_node_name(perform_substitutions(context, name))
            for transition in self.__transitions:
                number = int(perform_substitutions(context, transition))
                context.emit_event_sync(
                    ChangeState(lifecycle_node_matcher=matcher, transition_id=number)
                )

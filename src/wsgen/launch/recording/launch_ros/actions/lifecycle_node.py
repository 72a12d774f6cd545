"""A node with states."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from launch.event_handler import EventHandler
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution
from launch_ros.actions.node import Node
from launch_ros.events.lifecycle.change_state import ChangeState
from launch_ros.events.lifecycle.state_transition import StateTransition

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.event import Event
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch.some_substitutions_type import SomeSubstitutionsType

# Transition -> the state before, the one on the way, and the one after it.
_STATES = {
    1: ("unconfigured", "configuring", "inactive"),
    2: ("inactive", "cleaningup", "unconfigured"),
    3: ("inactive", "activating", "active"),
    4: ("active", "deactivating", "inactive"),
    5: ("unconfigured", "shuttingdown", "finalized"),
    6: ("inactive", "shuttingdown", "finalized"),
    7: ("active", "shuttingdown", "finalized"),
}
_CONFIGURE, _ACTIVATE = 1, 3


class LifecycleNode(Node):
    """A node that must have a name and a namespace; its transitions always succeed here."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        autostart: Any = False,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.__autostart = normalize_typed_substitution(autostart, bool)
        self.__state = "unconfigured"

    @property
    def is_lifecycle_node(self) -> bool:
        """Whether it has states."""
        return True

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Start it, and listen to what it is asked."""
        super().execute(context)
        context.register_event_handler(_Listener(self))
        if perform_typed_substitution(context, self.__autostart, bool):
            for transition in (_CONFIGURE, _ACTIVATE):
                context.emit_event_sync(
                    ChangeState(
                        lifecycle_node_matcher=lambda node: node is self,
                        transition_id=transition,
                    )
                )
        return None

    def change_state(self, transition: int, context: LaunchContext) -> None:
        """Make a transition if its first state is the node's, and tell who waits for it."""
        states = _STATES.get(transition)
        if states is None or states[0] != self.__state:
            return
        for start, goal in itertools.pairwise(states):
            event = StateTransition(action=self, start_state=start, goal_state=goal)
            event.wsgen_cause = f"state {goal} of {self.process_name}"
            context.emit_event_sync(event)
        self.__state = states[-1]


class _Listener(EventHandler):
    """What a node does when it is asked to change its state."""

    def __init__(self, node: LifecycleNode) -> None:
        super().__init__(
            matcher=lambda event: (
                isinstance(event, ChangeState) and event.lifecycle_node_matcher(node)
            )
        )
        self.__node = node

    def handle(self, event: Event, context: LaunchContext) -> None:
        """Change it."""
        super().handle(event, context)
        if isinstance(event, ChangeState):
            self.__node.change_state(event.transition_id, context)

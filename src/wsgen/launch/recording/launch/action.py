"""Something that is done when it is visited."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.launch_description_entity import LaunchDescriptionEntity

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.condition import Condition
    from launch.launch_context import LaunchContext


class Action(LaunchDescriptionEntity):
    """Base of all actions, also of those that users write."""

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.__condition = condition

    @property
    def condition(self) -> Condition | None:
        """What decides whether it is executed."""
        return self.__condition

    def describe(self) -> str:
        """Itself in words."""
        return f"Action({self.__repr__()})"

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities that executing it gives, where they are known before."""
        return []

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """What a visit certainly gives."""
        return self.get_sub_entities() if self.condition is None else []

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What it gives if its condition holds."""
        if self.condition is None:
            return []
        return [(f"{self.condition.describe()} is True", self.get_sub_entities())]

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Execute it if its condition holds, and tell whoever waits for that."""
        if self.__condition is not None and not self.__condition.evaluate(context):
            return None
        try:
            return self.execute(context)
        finally:
            self._executed(context)

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do it; what comes back is visited next."""

    def _executed(self, context: LaunchContext) -> None:
        """Most actions are complete as soon as they were executed."""
        self.announce_completion(context)

    def announce_completion(self, context: LaunchContext) -> None:
        """Tell whoever waits for the action to be complete."""
        if context.has_event_handlers:
            from launch.events.execution_complete import ExecutionComplete

            context.emit_event_sync(ExecutionComplete(action=self))

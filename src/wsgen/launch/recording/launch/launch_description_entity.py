"""What a launch description is made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._located import Located

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext


class LaunchDescriptionEntity(Located):
    """Something that is visited: an action or a description."""

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do what it is for, and give what is to be visited next."""
        raise NotImplementedError

    def describe(self) -> str:
        """A line about it."""
        return self.__repr__()

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities that a visit certainly gives."""
        return []

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """The entities that it may give later, each group with its condition in words."""
        return []

    def get_asyncio_future(self) -> Any:
        """Nothing waits here: time is virtual."""
        return None

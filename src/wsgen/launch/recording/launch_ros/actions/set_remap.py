"""A remapping for what comes next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class SetRemap(Action):
    """A remapping of all nodes that come next; their own come after it."""

    def __init__(
        self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__src = normalize_to_list_of_substitutions(src)
        self.__dst = normalize_to_list_of_substitutions(dst)

    def execute(self, context: LaunchContext) -> None:
        """Add it to those that are set."""
        rule = (
            perform_substitutions(context, self.__src),
            perform_substitutions(context, self.__dst),
        )
        earlier = context.launch_configurations.get("ros_remaps", [])
        context.launch_configurations["ros_remaps"] = [*earlier, rule]

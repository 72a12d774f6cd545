"""Forget launch configurations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from launch.launch_context import LaunchContext


class ResetLaunchConfigurations(Action):
    """Forgets all configurations but those that it is given."""

    def __init__(
        self, launch_configurations: Mapping[Any, Any] | None = None, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__launch_configurations = launch_configurations or {}

    def execute(self, context: LaunchContext) -> None:
        """Evaluate what stays, and forget the rest."""
        kept = {
            perform_substitutions(context, normalize_to_list_of_substitutions(name)): (
                perform_substitutions(context, normalize_to_list_of_substitutions(value))
            )
            for name, value in self.__launch_configurations.items()
        }
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)

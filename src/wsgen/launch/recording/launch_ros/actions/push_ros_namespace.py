"""A namespace for what comes next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.utilities.namespaces import join_namespaces, validate_namespace

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class PushROSNamespace(Action):
    """Goes on from the namespace there is, or begins anew where it is absolute."""

    def __init__(self, namespace: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Set the namespace."""
        joined = join_namespaces(
            context.launch_configurations.get("ros_namespace"),
            perform_substitutions(context, self.__namespace),
        )
        if joined is not None:
            validate_namespace(joined)
            context.launch_configurations["ros_namespace"] = joined


PushRosNamespace = PushROSNamespace

"""Nodes that are loaded into a container."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.utilities.composition import note_composable_node

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch_ros.descriptions import ComposableNode


class LoadComposableNodes(Action):
    """Asks a container, given itself or by its name, to load nodes."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Iterable[ComposableNode],
        target_container: Any,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__descriptions = list(composable_node_descriptions)
        self.__target = target_container

    def execute(self, context: LaunchContext) -> None:
        """Note the nodes."""
        if hasattr(self.__target, "node_name"):
            container = self.__target.node_name
        else:
            container = perform_substitutions(
                context, normalize_to_list_of_substitutions(self.__target)
            )
        for description in self.__descriptions:
            note_composable_node(context, description, container, self.wsgen_location)

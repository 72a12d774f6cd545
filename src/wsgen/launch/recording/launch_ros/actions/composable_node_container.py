"""A process that nodes are loaded into."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch_ros.actions.node import Node

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch.some_substitutions_type import SomeSubstitutionsType
    from launch_ros.descriptions import ComposableNode


class ComposableNodeContainer(Node):
    """A container, with nodes that are loaded when it has started."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        composable_node_descriptions: Iterable[ComposableNode] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.__descriptions = list(composable_node_descriptions or [])

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Start the container, then load the nodes."""
        super().execute(context)
        if not self.__descriptions:
            return None
        from launch_ros.actions.load_composable_nodes import LoadComposableNodes

        return [
            LoadComposableNodes(
                composable_node_descriptions=self.__descriptions, target_container=self
            )
        ]

"""Nodes of Gazebo that run in a container, where the launch file wants that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.base import LaunchDescriptionEntity
    from launch.launch_context import LaunchContext


def in_container(
    context: LaunchContext, container: tuple[Any, Any, Any], **node: Any
) -> LaunchDescriptionEntity | None:
    """The node in a container: its own, or one that is there; None where it is a process.

    `container` says its name, whether it is made, and whether there is one at all.
    """
    from launch_ros.actions import ComposableNodeContainer, LoadComposableNodes
    from launch_ros.utilities import ComposableNode

    name, is_own, is_used = container
    if not _is_true(context, is_used):
        return None
    nodes = [ComposableNode(**node)]
    if _is_true(context, is_own):
        return ComposableNodeContainer(
            name=name,
            namespace="",
            package="rclcpp_components",
            executable="component_container",
            composable_node_descriptions=nodes,
        )
    return LoadComposableNodes(target_container=name, composable_node_descriptions=nodes)


def _is_true(context: LaunchContext, value: Any) -> bool:
    if isinstance(value, bool):
        return value
    text = perform_substitutions(context, normalize_to_list_of_substitutions(value))
    return text.strip().lower() in {"true", "1"}

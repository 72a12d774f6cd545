"""Which nodes are meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch_ros.actions.node import Node


def matches_node_name(node_name: str) -> Callable[[Node], bool]:
    """Whether a node has this full name."""
    return lambda node: node.node_name == "/" + node_name.lstrip("/")

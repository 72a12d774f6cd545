"""Which nodes are meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch._finder import show_public_names

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch_ros.actions import Node


def matches_node_name(node_name: str) -> Callable[[Node], bool]:
    """Whether a node has this full name."""
    return lambda node: node.node_name == "/" + node_name.lstrip("/")


show_public_names(__name__)

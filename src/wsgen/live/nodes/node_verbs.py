"""`wsgen node list` and `info`, as ros2node has them (ros2/ros2cli, ros2node/verb)."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)

from wsgen.live.nodes.graph import Absent, instead, is_hidden, node_names

if TYPE_CHECKING:
    from collections.abc import Iterable


def list_nodes(node: Any, *, with_hidden: bool, count: bool) -> None:
    """Print the names of nodes, or their number."""
    names = node_names(node, with_hidden=with_hidden)
    if count:
        print(len(names))
        return
    if len(set(names)) < len(names):
        print(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which "
            "can have unintended side effects.",
            file=sys.stderr,
        )
    if names:
        print(*names, sep="\n")


def show_info(node: Any, *, name: str, with_hidden: bool) -> None:
    """Print what a node publishes, takes and offers.

    Raises:
        Absent: The node is not there.
    """
    name = name if name.startswith("/") else f"/{name}"
    names = node_names(node, with_hidden=with_hidden)
    if name not in names:
        raise Absent(f"Unable to find node '{name}'", instead(name, names, "node"))
    if names.count(name) > 1:
        print(
            f'There are {names.count(name)} nodes in the graph with the exact name "{name}". You '
            "are seeing information about only one of them.",
            file=sys.stderr,
        )
    namespace, _, base = name.rpartition("/")
    of = (base, namespace or "/")
    print(name)
    for title, found in (
        ("Subscribers", node.get_subscriber_names_and_types_by_node(*of)),
        ("Publishers", node.get_publisher_names_and_types_by_node(*of)),
        ("Service Servers", node.get_service_names_and_types_by_node(*of)),
        ("Service Clients", node.get_client_names_and_types_by_node(*of)),
        ("Action Servers", get_action_server_names_and_types_by_node(node, *of)),
        ("Action Clients", get_action_client_names_and_types_by_node(node, *of)),
    ):
        print(f"  {title}:")
        _print(found, with_hidden=with_hidden)


def _print(found: Iterable[tuple[str, list[str]]], *, with_hidden: bool) -> None:
    shown = [one for one in sorted(found) if with_hidden or not is_hidden(one[0])]
    print(*(f"    {name}: {', '.join(types)}" for name, types in shown), sep="\n")

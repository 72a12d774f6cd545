"""Nodes within a container, noted as parts of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.utilities.namespaces import join_namespaces
from launch_ros.utilities.parameters import evaluate_parameters, global_parameters
from launch_ros.utilities.remappings import perform_remap_rules
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch_ros.descriptions import ComposableNode


def note_composable_node(
    context: LaunchContext,
    node: ComposableNode,
    container: str,
    location: tuple[str, int] | None,
) -> None:
    """Note a node as something that starts in its container; its executable is its plugin."""
    if node.condition is not None and not node.condition.evaluate(context):
        return
    namespace = join_namespaces(
        context.launch_configurations.get("ros_namespace"),
        None if node.namespace is None else perform_substitutions(context, node.namespace),
    )
    name = None if node.name is None else perform_substitutions(context, node.name)
    full_name = f"{(namespace or '').rstrip('/')}/{name or ''}"
    file, line = location or (None, None)
    RECORD.processes.append(
        {
            "package": perform_substitutions(context, node.package),
            "executable": perform_substitutions(context, node.plugin),
            "name": name,
            "namespace": namespace or "",
            "parameters": {
                **global_parameters(context, node=full_name, location=location),
                **evaluate_parameters(context, node.parameters, node=full_name, location=location),
            },
            "arguments": [],
            "remappings": perform_remap_rules(context, node.remappings),
            "command": None,
            "environment": {},
            "container": container,
            "starts": context.timeline.cause,
            "start_time": round(context.timeline.now, 6),
            "file": file,
            "line": line,
        }
    )

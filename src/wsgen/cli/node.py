"""`wsgen node`."""

from __future__ import annotations

from typing import Any

import click

from wsgen.cli.options import workspace_option
from wsgen.cli.ros_tool import ExampleGroup, graph_options, start_tool


@click.group(
    cls=ExampleGroup,
    examples=("wsgen node list", "wsgen node info /robot_state_publisher"),
)
@workspace_option
def command(**_options: Any) -> None:
    """Look at the nodes of a live run, as `ros2 node` does."""


@command.command("list")
@click.option("-a", "--all", "with_hidden", is_flag=True, help="Show hidden nodes as well.")
@click.option("-c", "--count-nodes", is_flag=True, help="Show only the number of nodes.")
@graph_options
@click.pass_context
def list_nodes(
    ctx: click.Context, /, *, with_hidden: bool, count_nodes: bool, **shared: Any
) -> None:
    """List the nodes."""
    start_tool(ctx, "node list", with_hidden=with_hidden, count=count_nodes, **shared)


@command.command("info")
@click.argument("name", metavar="NODE")
@click.option(
    "--include-hidden", "with_hidden", is_flag=True, help="Show hidden topics, services, actions."
)
@graph_options
@click.pass_context
def show_info(ctx: click.Context, /, *, name: str, with_hidden: bool, **shared: Any) -> None:
    """Show what a node publishes, subscribes to and offers."""
    start_tool(ctx, "node info", name=name, with_hidden=with_hidden, **shared)

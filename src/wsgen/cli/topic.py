"""`wsgen topic`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from wsgen.cli.options import Choice, workspace_option
from wsgen.cli.ros_tool import ExampleGroup, graph_options, start_tool

Function = Callable[..., Any]

PROFILES = (
    "default",
    "sensor_data",
    "system_default",
    "services_default",
    "parameters",
    "parameter_events",
    "action_status_default",
    "best_available",
)


OF_QOS = {  # words beside `system_default`, and the help
    "history": (("keep_last", "keep_all"), "Which messages the queue keeps."),
    "reliability": (("reliable", "best_effort", "best_available"), "Reliability."),
    "durability": (("transient_local", "volatile", "best_available"), "Durability."),
    "liveliness": (("automatic", "manual_by_topic", "best_available"), "Liveliness."),
}
QOS_OPTIONS: tuple[Callable[[Function], Function], ...] = (
    click.option("--qos-profile", type=Choice(PROFILES), help="Preset of the QoS."),
    click.option("--qos-depth", type=click.IntRange(0), metavar="N", help="Depth of the queue."),
    *(
        click.option(f"--qos-{name}", type=Choice(("system_default", *words)), help=explained)
        for name, (words, explained) in OF_QOS.items()
    ),
    click.option(
        "--qos-liveliness-lease-duration-seconds",
        "qos_lease_seconds",
        type=click.FloatRange(0),
        metavar="N",
        help="Lease duration of the liveliness.",
    ),
)
FILTER_OPTION = click.option(
    "--filter",
    "filter_expression",
    metavar="EXPRESSION",
    help="Python expression; `m` is the message.",
)


def _qos_options(function: Function) -> Function:
    for option in reversed(QOS_OPTIONS):
        function = option(function)
    return function


def _chosen_qos(options: dict[str, Any]) -> dict[str, Any]:
    """Take what the options of the QoS say out of the options of a verb."""
    names = [name for name in options if name.startswith("qos_")]
    chosen = {name.removeprefix("qos_"): options.pop(name) for name in names}
    return {name: value for name, value in chosen.items() if value is not None}


@click.group(
    cls=ExampleGroup,
    examples=(
        "wsgen topic echo /odom --once",
        "wsgen topic pub /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}}' -r 10",
    ),
)
@click.option(
    "--include-hidden-topics", is_flag=True, help="Consider topics whose names begin with `_`."
)
@workspace_option
def command(**_options: Any) -> None:
    """Look at the topics of a live run, as `ros2 topic` does, and publish on them."""


@command.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the type of each topic.")
@click.option("-c", "--count-topics", is_flag=True, help="Show only the number of topics.")
@click.option("--include-hidden-topics", is_flag=True, help="Consider hidden topics as well.")
@click.option(
    "-v", "--verbose", is_flag=True, help="Also show the numbers of publishers and subscribers."
)
@graph_options
@click.pass_context
def list_topics(
    ctx: click.Context,
    /,
    *,
    show_types: bool,
    count_topics: bool,
    include_hidden_topics: bool,
    verbose: bool,
    **shared: Any,
) -> None:
    """List the topics."""
    is_wanted_by_group = bool(ctx.parent and ctx.parent.params.get("include_hidden_topics"))
    start_tool(
        ctx,
        "topic list",
        show_types=show_types,
        count=count_topics,
        with_hidden=include_hidden_topics or is_wanted_by_group,
        verbose=verbose,
        **shared,
    )


@command.command("type")
@click.argument("topic")
@graph_options
@click.pass_context
def show_type(ctx: click.Context, /, *, topic: str, **shared: Any) -> None:
    """Show the type of a topic."""
    start_tool(ctx, "topic type", topic=topic, **shared)


@command.command("info")
@click.argument("topic")
@click.option("-v", "--verbose", is_flag=True, help="Show nodes, types and QoS of both sides.")
@graph_options
@click.pass_context
def show_info(ctx: click.Context, /, *, topic: str, verbose: bool, **shared: Any) -> None:
    """Show the type of a topic, and how many publish and subscribe."""
    start_tool(ctx, "topic info", topic=topic, verbose=verbose, **shared)


@command.command("echo")
@click.argument("topic")
@click.argument("message_type", required=False)
@click.option("--field", metavar="NAME[.NAME]", help="Show one field of the messages.")
@click.option("-f", "--full-length", is_flag=True, help="Show all of long arrays and texts.")
@click.option(
    "-l",
    "--truncate-length",
    type=click.IntRange(0),
    default=128,
    show_default=True,
    metavar="N",
    help="Length after which arrays and texts are cut.",
)
@click.option("--no-arr", is_flag=True, help="Show no arrays.")
@click.option("--no-str", is_flag=True, help="Show no texts.")
@click.option("--flow-style", is_flag=True, help="Show collections on one line.")
@click.option("--csv", is_flag=True, help="Show all fields separated by commas.")
@click.option("--raw", is_flag=True, help="Show the bytes of the messages.")
@click.option("--once", is_flag=True, help="End after the first message.")
@click.option("--timeout", type=click.FloatRange(0), metavar="SECONDS", help="End after this time.")
@FILTER_OPTION
@click.option("--no-lost-messages", is_flag=True, help="Do not report lost messages.")
@click.option("-n", "--node-name", metavar="NAME", help="Name of the node that subscribes.")
@_qos_options
@graph_options
@click.pass_context
def echo(ctx: click.Context, /, *, full_length: bool, **options: Any) -> None:
    """Print the messages of a topic."""
    qos = _chosen_qos(options)
    if full_length:
        options["truncate_length"] = None
    start_tool(ctx, "topic echo", qos=qos, **options)


@command.command("hz")
@click.argument("topics", nargs=-1, required=True, metavar="TOPIC...")
@click.option(
    "-w",
    "--window",
    type=click.IntRange(1),
    default=10_000,
    show_default=True,
    metavar="N",
    help="Number of messages from which the rate is computed.",
)
@FILTER_OPTION
@click.option("--wall-time", is_flag=True, help="Use wall-clock time.")
@graph_options
@click.pass_context
def measure(ctx: click.Context, /, *, topics: tuple[str, ...], **options: Any) -> None:
    """Measure how often messages are published."""
    start_tool(ctx, "topic hz", names=list(dict.fromkeys(topics)), **options)


@command.command("pub")
@click.argument("topic")
@click.argument("message_type")
@click.argument("values", default="{}", required=False)
@click.option("--stdin", is_flag=True, help="Read the values from standard input.")
@click.option(
    "-r",
    "--rate",
    type=click.FloatRange(0, min_open=True),
    default=1.0,
    show_default=True,
    metavar="HZ",
    help="Messages a second.",
)
@click.option(
    "-p",
    "--print",
    "print_each",
    type=int,
    default=1,
    show_default=True,
    metavar="N",
    help="Print every N-th message.",
)
@click.option("-1", "--once", is_flag=True, help="Publish one message.")
@click.option(
    "-t", "--times", type=click.IntRange(0), default=0, metavar="N", help="Publish N messages."
)
@click.option(
    "-w",
    "--wait-matching-subscriptions",
    "subscriptions",
    type=click.IntRange(0),
    metavar="N",
    help="Wait for N subscriptions.  [default: 1 with --once and --times]",
)
@click.option(
    "--max-wait-time-secs",
    "most_seconds",
    type=click.FloatRange(0, min_open=True),
    metavar="SECONDS",
    help="Longest time to wait for subscriptions.",
)
@click.option(
    "--keep-alive",
    type=click.FloatRange(0),
    default=0.1,
    show_default=True,
    metavar="SECONDS",
    help="Time to keep running after the last message.",
)
@click.option("-n", "--node-name", metavar="NAME", help="Name of the node that publishes.")
@_qos_options
@graph_options
@click.pass_context
def publish(
    ctx: click.Context,
    /,
    *,
    values: str,
    stdin: bool,
    once: bool,
    times: int,
    subscriptions: int | None,
    **options: Any,
) -> None:
    """Publish messages; VALUES are YAML: '{linear: {x: 0.5}}'."""
    if once and times:
        raise click.UsageError("--once and --times cannot be combined.")
    if stdin:
        import sys

        values = sys.stdin.read()
    number = 1 if once else times
    wanted = int(number != 0) if subscriptions is None else subscriptions
    if options["most_seconds"] is not None and not wanted:
        raise click.UsageError(
            "--max-wait-time-secs has no effect without --wait-matching-subscriptions, "
            "--once or --times"
        )
    # A publisher needs no list of what is there; who subscribes is waited for.
    options["spin_time"] = 0.0
    qos = _chosen_qos(options)
    start_tool(
        ctx, "topic pub", qos=qos, values=values, times=number, subscriptions=wanted, **options
    )

"""What `wsgen topic` and `wsgen node` share: their options, and the process behind them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from wsgen.cli import Commands
from wsgen.cli.options import ExampleCommand

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from typing import NoReturn

Function = Callable[..., Any]

# Without a new name; ros2cli has 0.5, and a daemon that knows all. What Fast DDS announces to a new
# process comes within two seconds.
SPIN_SECONDS = 2.0


class ExampleGroup(ExampleCommand, Commands):
    """A group whose help ends with examples."""


GRAPH_OPTIONS: tuple[Callable[[Function], Function], ...] = (
    click.option(
        "--spin-time",
        type=click.FloatRange(0),
        default=SPIN_SECONDS,
        show_default=True,
        metavar="SECONDS",
        help="Time to wait for discovery.",
    ),
    click.option(
        "-s", "--use-sim-time", is_flag=True, help="Use the time of /clock (simulated time)."
    ),
    # There is no daemon here; scripts that refuse it go on.
    click.option("--no-daemon", is_flag=True, hidden=True, expose_value=False),
)


def graph_options(function: Function) -> Function:
    """The options that ros2cli's verbs share."""
    for option in reversed(GRAPH_OPTIONS):
        function = option(function)
    return function


def start_tool(
    ctx: click.Context,
    verb: str,
    *,
    spin_time: float,
    use_sim_time: bool,
    message_type: str | None = None,
    node_name: str | None = None,
    **options: Any,
) -> NoReturn:
    """Become the process that answers: what it prints is the result, and signals reach it."""
    import json
    import os
    import shlex
    import sys

    from wsgen.cli.progress import listening
    from wsgen.isolation.parent import not_started
    from wsgen.ros.environment import open_ros, variables_of_nodes
    from wsgen.ros.environment.processes import hand_over, module_command
    from wsgen.simulation.live_runs import DOMAIN, find_runs

    environment = overlay_environment((ctx.parent or ctx).params.get("workspace"))
    package = (message_type or "").partition("/")[0]
    with listening(quiet=False, verbose=False, is_short=True) as listener:
        ros = open_ros(
            environment,
            messages=[package] if package else [],
            listener=listener or (lambda _event: None),
        )
    variables = {**environment, **variables_of_nodes(ros, environment)}
    if not ros.is_sourced:
        # Killed, it would leave queues of Fast DDS in shared memory. After a live run wsgen
        # removes those; nothing runs after this process that could. With LOCALHOST it may leave
        # them still, since rmw_fastrtps then adds them to all profiles.
        variables.setdefault("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
    if verb in TAKE_TYPE:
        options["message_type"] = message_type
    request = {
        "verb": verb,
        "seconds": spin_time,
        "use_sim_time": use_sim_time,
        "node_name": node_name,
        "built": [],
        "domain": variables.get(DOMAIN) or "0",
        "runs": find_runs(),
        "command": shlex.join(["wsgen", *sys.argv[1:]]),
        "options": options,
    }
    sys.stdout.flush()
    try:
        number = hand_over(json.dumps(request))
        command = module_command(ros.python, "wsgen.live.nodes.graph_tool", number)
        os.execve(command[0], command, variables)  # noqa: S606  no shell is wanted
    except OSError as error:
        raise not_started(error) from error


TAKE_TYPE = ("topic echo", "topic pub")


def overlay_environment(workspace: str | None) -> Mapping[str, str]:
    """The variables with the overlay of the workspace, whose messages are wanted."""
    import os

    from wsgen.packages.workspace.layout import workspace_if_any
    from wsgen.packages.workspace.overlay import SETUPS, source_overlay

    found = workspace_if_any(workspace)
    if found is None or not any((found.install / one).is_file() for one in SETUPS.values()):
        return dict(os.environ)
    if _is_sourced(found.install, os.environ):
        return dict(os.environ)
    return source_overlay(found, os.environ).environment


def _is_sourced(install: Path, environment: Mapping[str, str]) -> bool:
    """Whether the workspace is on the paths already: sourcing it again costs 0.3 s."""
    import os
    from pathlib import Path

    prefixes = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return any(Path(prefix).is_relative_to(install) for prefix in prefixes if prefix)

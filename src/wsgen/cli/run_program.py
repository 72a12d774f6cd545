"""`wsgen run`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.completion import complete_packages, complete_programs
from wsgen.cli.options import ExampleCommand, workspace_option

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path


@click.command(
    cls=ExampleCommand,
    examples=(
        "wsgen run turtlebot3_teleop teleop_keyboard",
        "wsgen run my_robot driver --ros-args -p use_sim_time:=true",
    ),
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
    no_args_is_help=True,
)
@workspace_option
@click.argument("package", shell_complete=complete_packages)
@click.argument("executable", shell_complete=complete_programs)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[ARGUMENT]...")
def command(
    *, workspace: str | None, package: str, executable: str, arguments: tuple[str, ...]
) -> None:
    """Run a program of a package, as `ros2 run` does.

    It finds a live run that goes on in another terminal (wsgen launch PACKAGE FILE --run). All that
    comes after its name is for the program, --ros-args, too.
    """
    import os
    import signal
    import sys

    from wsgen.cli.output import render_diagnostics
    from wsgen.cli.progress import listening
    from wsgen.cli.ros_tool import overlay_environment
    from wsgen.isolation.parent import not_started
    from wsgen.live.linux import require_linux
    from wsgen.live.messages import messages_of_packages
    from wsgen.live.program import distro_of_run, find_command, find_live_folder
    from wsgen.pipeline.changed_since_build import changed_since_build, shares_of, with_needs
    from wsgen.ros_environment import open_ros, variables_of_nodes
    from wsgen.simulation.live_scene import FOLDER_VARIABLE
    from wsgen.workspace.layout import find_packages, workspace_if_any
    from wsgen.workspace.overlay import overlay_of

    require_linux("wsgen run", "wsgen launch --play simulates the robots here.")
    found = workspace_if_any(workspace)
    environment = overlay_environment(workspace)
    packages = find_packages(found) if found else ()
    messages = messages_of_packages(packages)
    with listening(quiet=False, verbose=False, is_short=True) as listener:
        ros = open_ros(environment, messages=messages, listener=listener or (lambda _event: None))
    variables = {**environment, **variables_of_nodes(ros, environment)}
    words = find_command(package, executable, arguments, ros=ros, variables=variables)
    shares = shares_of(packages, overlay_of(variables))
    changed = [
        diagnostic
        for one in with_needs([package], shares).items()
        for diagnostic in changed_since_build(*one)
    ]
    for line in render_diagnostics(changed):
        click.echo(line, err=True)
    if not ros.is_sourced and words[0] == str(ros.python) == sys.executable:
        for warning in _warnings(words, variables, [one.name for one in packages], shares):
            click.echo(f"[WARN] [{executable}]: {warning}", err=True)
    live_folder = find_live_folder(variables)
    if live_folder is not None:
        variables.setdefault(FOLDER_VARIABLE, str(live_folder))
    if not ros.is_sourced:
        # Nodes choose types of messages by it, as those of the run beside it do.
        own = environment.get("ROS_DISTRO")
        beside = distro_of_run(live_folder) if live_folder is not None else None
        variables["ROS_DISTRO"] = own or beside or ros.distro
    if not ros.is_sourced:
        # Killed, it would leave queues of Fast DDS in shared memory: nothing runs after it. With
        # LOCALHOST it may do so still, since rmw_fastrtps then adds them to all profiles.
        variables.setdefault("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
    sys.stdout.flush()
    for ignored in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them; no other program does
        signal.signal(ignored, signal.SIG_DFL)
    try:
        os.execvpe(words[0], words, variables)  # noqa: S606  no shell is wanted
    except OSError as error:
        raise not_started(error) from error


def _warnings(
    words: Sequence[str],
    variables: Mapping[str, str],
    packages: Collection[str],
    shares: Mapping[Path, Path],
) -> Iterator[str]:
    """What will end a program at once: nobody could say so afterwards."""
    from pathlib import Path

    from wsgen.live.lacking import lacking_modules, syntax_error
    from wsgen.live.missing_modules import tell_of_module
    from wsgen.live.tracebacks import tell_of_source

    for module in lacking_modules(words, variables):
        yield tell_of_module(module, Path(words[0]), packages)
    wrong = syntax_error(words, variables)
    source = None if wrong is None else tell_of_source([wrong], shares)
    if source is not None:  # the program itself names the installed file
        yield source

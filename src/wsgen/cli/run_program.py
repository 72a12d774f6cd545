"""`wsgen run`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import (
    ExampleCommand,
    complete_packages_and_files,
    complete_programs,
    workspace_option,
)
from wsgen.cli.terminal import echo
from wsgen.errors import NotFoundError, RequestError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path
    from typing import NoReturn

    from wsgen.ros.environment import RosEnvironment

PYTHON = ".py"


@click.command(
    cls=ExampleCommand,
    examples=(
        "wsgen run my_robot driver --ros-args -p use_sim_time:=true",
        "wsgen run drive.py",
    ),
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
    no_args_is_help=True,
)
@workspace_option
@click.argument("package", metavar="PACKAGE|FILE", shell_complete=complete_packages_and_files)
@click.argument(
    "executable", required=False, metavar="[EXECUTABLE]", shell_complete=complete_programs
)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[ARGUMENT]...")
def command(
    *,
    workspace: str | None,
    package: str,
    executable: str | None,
    arguments: tuple[str, ...],
) -> None:
    """Run a program of a package, as `ros2 run` does, or a script.

    A FILE, such as drive.py, needs no package. The program finds a live run in another terminal
    (wsgen launch PACKAGE FILE --run). All words after its name are passed to it, --ros-args, too.
    """
    import sys

    from wsgen.cli.output import render_diagnostics
    from wsgen.cli.progress import listening
    from wsgen.cli.ros_tool import overlay_environment
    from wsgen.isolation.system import require_linux
    from wsgen.live.needed_ros import messages_of_packages, messages_of_text
    from wsgen.live.replacements import find_command
    from wsgen.packages.workspace.layout import find_packages, workspace_if_any
    from wsgen.packages.workspace.overlay import overlay_of
    from wsgen.pipeline.changed_since_build import changed_since_build, shares_of, with_needs
    from wsgen.ros.environment import open_ros, variables_of_nodes
    from wsgen.text.files import LARGEST_TEXT, read_regular

    require_linux("wsgen run", "wsgen launch --play simulates the robots here.")
    script = _script(package, executable)
    found = workspace_if_any(workspace)
    environment = overlay_environment(workspace)
    packages = find_packages(found) if found else ()
    messages = messages_of_packages(packages)
    if script is not None:
        messages |= messages_of_text(read_regular(script, LARGEST_TEXT))
        arguments = arguments if executable is None else (executable, *arguments)
    with listening(quiet=False, verbose=False, is_short=True) as listener:
        ros = open_ros(environment, messages=messages, listener=listener or (lambda _event: None))
    variables = {**environment, **variables_of_nodes(ros, environment)}
    words = (
        find_command(package, executable or "", arguments, ros=ros, variables=variables)
        if script is None
        else _script_command(script, arguments, str(ros.python))
    )
    shares = shares_of(packages, overlay_of(variables))
    changed = [
        diagnostic
        for one in with_needs([] if script else [package], shares).items()
        for diagnostic in changed_since_build(*one)
    ]
    for line in render_diagnostics(changed):
        echo(line, err=True)
    if not ros.is_sourced and words[0] == str(ros.python) == sys.executable:
        for warning in _warnings(words, variables, [one.name for one in packages], shares):
            echo(f"[WARN] [{script.name if script else executable}]: {warning}", err=True)
    _join_run(variables, environment, ros)
    _become(words, variables)


def _join_run(
    variables: dict[str, str], environment: Mapping[str, str], ros: RosEnvironment
) -> None:
    """Set what a program needs to find the live run beside it, if there is one."""
    from wsgen.simulation.live_runs import FOLDER_VARIABLE, distro_of_run, find_live_folder

    live_folder = find_live_folder(variables)
    if live_folder is not None:
        variables.setdefault(FOLDER_VARIABLE, str(live_folder))
    if not ros.is_sourced:
        # Nodes choose types of messages by it, as those of the run beside it do.
        own = environment.get("ROS_DISTRO")
        beside = distro_of_run(live_folder) if live_folder is not None else None
        variables["ROS_DISTRO"] = own or beside or ros.distro
        # Killed, it would leave queues of Fast DDS in shared memory: nothing runs after it. With
        # LOCALHOST it may do so still, since rmw_fastrtps then adds them to all profiles.
        variables.setdefault("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")


def _become(words: tuple[str, ...], variables: Mapping[str, str]) -> NoReturn:
    """Become the program."""
    import os
    import signal
    import sys

    from wsgen.isolation.parent import not_started

    sys.stdout.flush()
    for ignored in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them; no other program does
        signal.signal(ignored, signal.SIG_DFL)
    try:
        os.execvpe(words[0], words, variables)  # noqa: S606  no shell is wanted
    except OSError as error:
        raise not_started(error) from error


def _script(given: str, executable: str | None) -> Path | None:
    """The file that is given in place of a package; None where that is the name of a package.

    Raises:
        NotFoundError: It does not exist.
        RequestError: It is a package, and no program of it is named.
    """
    import os
    from pathlib import Path

    from wsgen.text.files import refuse_irregular

    path = Path(given)
    is_named = os.sep in given or path.suffix == PYTHON
    if path.is_file() and (is_named or executable is None):
        refuse_irregular(path)
        return path.absolute()
    if is_named:
        raise NotFoundError(
            f"The file {given} does not exist.",
            hint="Check its path, or name a package and its program: wsgen run PACKAGE EXECUTABLE",
        )
    if executable is None:
        raise RequestError(
            f"No program of the package {given} is named.", hint=f"wsgen run {given} EXECUTABLE"
        )
    return None


def _script_command(script: Path, arguments: Sequence[str], python: str) -> tuple[str, ...]:
    """Its command line: Python runs with the interpreter of ROS, executable or not.

    Raises:
        NotFoundError: It cannot be executed.
    """
    import os
    import shlex

    from wsgen.live.replacements import is_python

    if script.suffix == PYTHON or is_python(script):
        return (python, str(script), *arguments)
    if not os.access(script, os.X_OK):
        raise NotFoundError(
            f"{script} is not executable.", hint=f"chmod +x {shlex.quote(str(script))}"
        )
    return (str(script), *arguments)


def _warnings(
    words: Sequence[str],
    variables: Mapping[str, str],
    packages: Collection[str],
    shares: Mapping[Path, Path],
) -> Iterator[str]:
    """What will end a program at once: nobody could say so afterwards."""
    from pathlib import Path

    from wsgen.live.python_failures import (
        explain_module,
        explain_source,
        lacking_modules,
        syntax_error,
    )

    for module in lacking_modules(words, variables):
        yield explain_module(module, Path(words[0]), packages)
    wrong = syntax_error(words, variables)
    source = None if wrong is None else explain_source([wrong], shares)
    if source is not None:  # the program itself names the installed file
        yield source

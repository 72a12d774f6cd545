"""The command line: the only place that prints, colours and exits.

Commands are imported when they are called, so that `wsgen --help` costs little more than click.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import importlib
import os
import sys
from typing import TYPE_CHECKING

import click

from wsgen import __version__
from wsgen.errors import (
    EXIT_BUG,
    EXIT_INTERRUPTED,
    EXIT_MISSING,
    EXIT_PASSED,
    EXIT_REQUEST,
    EXIT_SIGNALLED,
    NotFoundError,
    RequestError,
    WsgenError,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

ENDING_SIGNALS = ("SIGTERM", "SIGHUP")  # CI cancels, the terminal is closed
GARBAGE_THRESHOLD = 100_000  # objects more than are freed, until the collector looks

# name -> one line of help; `wsgen.cli.NAME` holds the command as `command`.
COMMANDS = {
    "new": "Write a package, and the workspace around it if there is none.",
    "templates": "List the templates and their variables, or check one of yours.",
    "build": "Build the workspace with colcon and explain what fails.",
    "validate": "Play the installed launch file and see whether the robot stands.",
    "doctor": "Say what this machine has and lacks for a target, and what mends it.",
    "launch": "Show what a launch file would start, without ROS and without starting it.",
}


class CommandTable(click.Group):
    """A group whose commands are modules, imported one at a time."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002  click's signature
        """All names, in the order in which a user needs them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the one command that is asked for."""
        if cmd_name not in COMMANDS:
            return None
        if ctx.resilient_parsing:  # completion needs no more than names
            return click.Command(cmd_name, help=COMMANDS[cmd_name])
        module = importlib.import_module(f"wsgen.cli.{cmd_name}")
        command: click.Command = module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; a misspelt one is answered with its neighbour."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            import difflib

            near = difflib.get_close_matches(name, COMMANDS, n=1) or list(COMMANDS)
            raise RequestError(f"There is no command {name!r}.", hint=f"wsgen {' | '.join(near)}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002  click's signature
        """The list of commands from the table, without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(
    cls=CommandTable,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Start with: wsgen new my_robot && wsgen build && wsgen validate",
)
@click.version_option(__version__, message="%(prog)s %(version)s")
def wsgen() -> None:
    """From a name to a robot standing in a simulator, on a machine without ROS."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit; the one place where errors become words and exit codes."""
    # Short commands make little garbage: looking for it while modules are imported, and once more
    # at the end, is an eighth of the time of `wsgen new`.
    gc.set_threshold(GARBAGE_THRESHOLD)
    _put_overlays_last()
    _unwind_at_signals()
    code = run(sys.argv[1:] if arguments is None else arguments)
    gc.freeze()
    sys.exit(code)


def _put_overlays_last() -> None:
    """Look for modules in PYTHONPATH last: what a sourced ROS of another Python has is not ours."""
    overlays = {*os.environ.get("PYTHONPATH", "").split(os.pathsep)} - {""}
    if overlays:
        sys.path.sort(key=overlays.__contains__)


def run(arguments: Sequence[str]) -> int:
    """Run the command line; return the exit code instead of exiting."""
    code = EXIT_PASSED
    colors = _Colors()
    try:
        _check_current_folder()
        returned = wsgen.main(
            args=list(arguments),
            prog_name="wsgen",
            standalone_mode=False,
            color=colors.wanted,
            obj=colors,
        )
        code = returned if isinstance(returned, int) else EXIT_PASSED
    except WsgenError as error:
        _tell(error.message, error.hint, color=colors.wanted)
        code = error.exit_code
    except click.ClickException as error:
        error.show()
        code = EXIT_REQUEST
    except SystemExit as end:
        if end.code != 1:
            raise
        # So click leaves when whoever read our output has gone: nothing of ours has failed.
        code = EXIT_PASSED
    except (KeyboardInterrupt, click.Abort):
        click.echo("\nwsgen: interrupted", err=True)
        code = EXIT_INTERRUPTED
    except Exception as error:  # noqa: BLE001  the last resort: no traceback reaches a beginner
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            _drop_standard_output()
            _tell(f"{error.strerror}.", "Make room on the disk and try again.")
            code = EXIT_MISSING
        else:
            _tell_bug(error)
            code = EXIT_BUG
    return code


def _unwind_at_signals() -> None:
    """Let a supervisor's signals raise, so that children are ended and folders removed."""
    import signal

    numbers = [getattr(signal, name) for name in ENDING_SIGNALS if hasattr(signal, name)]

    def leave(number: int, _frame: object) -> None:
        for other in numbers:
            signal.signal(other, signal.SIG_IGN)  # a second one must not disturb the cleaning up
        raise SystemExit(EXIT_SIGNALLED + number)

    for number in numbers:
        if signal.getsignal(number) is signal.SIG_DFL:  # nohup has us ignore SIGHUP
            signal.signal(number, leave)


class _Colors:
    """Whether to colour, as far as it is known: None leaves it to the terminal."""

    def __init__(self) -> None:
        unwanted = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
        self.wanted: bool | None = False if unwanted else None


def _drop_standard_output() -> None:
    """Forget what is not written yet: Python would try, and complain, once more when it exits."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _check_current_folder() -> None:
    try:
        os.getcwd()  # noqa: PTH109  pathlib is not loaded for --help
    except OSError as error:
        raise NotFoundError(
            "The current folder does not exist any more.", hint="Go to another one: cd"
        ) from error


def _tell(message: str, hint: str, *, color: bool | None = None) -> None:
    click.echo(f"{click.style('error:', fg='red', bold=True)} {message}", err=True, color=color)
    if hint:
        click.echo(f"{click.style('  try:', fg='green')} {hint}", err=True, color=color)


def _tell_bug(error: Exception) -> None:
    import traceback

    if os.environ.get("WSGEN_TRACEBACK"):
        traceback.print_exc()
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(last.filename)}:{last.lineno}"  # noqa: PTH119  no pathlib here
    _tell(
        f"This is a bug in wsgen {__version__}: {type(error).__name__}: {error} ({place}).",
        "Set WSGEN_TRACEBACK=1, run the command again and report what it prints.",
    )

"""The command line: the only place that prints, colors and exits.

Commands are imported when they are called, so that `wsgen --help` costs little more than click.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import io
import os
import re
import sys
from typing import TYPE_CHECKING

import click

from wsgen import __version__
from wsgen.errors import (
    EXIT_BUG,
    EXIT_INTERRUPTED,
    EXIT_PASSED,
    EXIT_REQUEST,
    EXIT_SIGNALLED,
    SIGNAL_MESSAGES,
    NotFoundError,
    RequestError,
    WsgenError,
)

if TYPE_CHECKING:
    from collections.abc import Sequence


COMPLETION = "_WSGEN_COMPLETE"  # the variable by which click's scripts for shells ask
GARBAGE_THRESHOLD = 100_000  # objects more than are freed, until the collector looks

# name -> one line of help; `wsgen.cli.NAME` holds the command as `command`.
COMMANDS = {
    "new": "Create a package with a robot, and a workspace if none exists.",
    "add": "Add a node, a message, a launch file and more to a package of anybody.",
    "update": "Merge what a template has become into a package that was made of it.",
    "templates": "List the templates and their variables, or check your own template.",
    "build": "Build the workspace with colcon and explain build errors.",
    "check": "Check packages and files without building or simulating them.",
    "port": "Port packages from Gazebo Classic to Gazebo Sim, in place.",
    "validate": "Simulate the robots that launch files spawn.",
    "sweep": "Simulate many variants of a robot, and write a table.",
    "launch": "Show what a launch file would start, simulate it (--play) or start it (--run).",
    "run": "Run a program of a package beside a live run, as ros2 run does.",
    "topic": "Look at the topics of a live run, as ros2 topic does, and publish on them.",
    "node": "Look at the nodes of a live run, as ros2 node does.",
    "view": "Show a robot in the browser, with a slider for each joint.",
    "rule": "List all rules, or show the documentation of one.",
    "doctor": "Show what this machine has and lacks for a target, and the commands that fix it.",
}
HELP = "help"
MODULES = {"run": "run_program"}  # of commands whose names are taken in this package


class Commands(click.Group):
    """A group with the command `help`, which suggests the nearest name for a misspelled one."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; `help COMMAND` is `COMMAND --help`."""
        name, *rest = args
        known = self.list_commands(ctx)
        if name == HELP and not ctx.resilient_parsing:
            if not rest or rest[0] in {HELP, *ctx.help_option_names}:
                click.echo(ctx.get_help(), color=ctx.color)
                ctx.exit()
            return self.resolve_command(ctx, [*rest, "--help"])
        if name == HELP:
            return name, self, rest
        if name not in known and not name.startswith("-") and not ctx.resilient_parsing:
            from wsgen.text.suggestions import nearest

            near = nearest(name, known) or " | ".join(known)
            raise RequestError(
                f"{name!r} is not a command of {ctx.command_path}.",
                hint=f"{ctx.command_path} {near}",
            )
        return super().resolve_command(ctx, args)


class CommandTable(Commands):
    """A group whose commands are modules, imported one at a time."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002  click's signature
        """All names, in the order in which a user needs them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the command with this name."""
        if cmd_name not in COMMANDS:
            return None
        if ctx.resilient_parsing:  # completing names needs only names
            return click.Command(cmd_name, help=COMMANDS[cmd_name])
        return self._import_command(cmd_name)

    def _import_command(self, cmd_name: str) -> click.Command:
        module = importlib.import_module(f"wsgen.cli.{MODULES.get(cmd_name, cmd_name)}")
        command: click.Command = module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; of what follows a name, or a misspelled one, in a completion, too."""
        name = args[0]
        if ctx.resilient_parsing and name != HELP:
            command = self._import_command(name) if name in COMMANDS else None
            return name if command else None, command, args[1:]
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002  click's signature
        """The list of commands from the table, without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(
    cls=CommandTable,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Start with: wsgen new my_robot && wsgen build && wsgen validate\n\n"
    "Options of a command: wsgen help COMMAND",
)
@click.version_option(__version__, message="%(prog)s %(version)s")
def wsgen() -> None:
    """From a name to a robot standing in a simulator, on a machine without ROS."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit; the one place where errors become text and exit codes."""
    # Short commands make little garbage: looking for it while modules are imported, and once more
    # at the end, is an eighth of the time of `wsgen new`.
    gc.set_threshold(GARBAGE_THRESHOLD)
    _put_overlays_last()
    _print_what_is_encodable()
    try:
        _unwind_at_signals()
        code = run(sys.argv[1:] if arguments is None else arguments)
        _ignore_signals()
    except (KeyboardInterrupt, SystemExit) as end:  # outside of what `run` catches
        code = _report_end(end)
    gc.freeze()
    sys.exit(code)


_ends: list[BaseException] = []  # that signals have raised
SECONDS_UNTIL_AGAIN = 0.01  # after an end was dropped
ESCAPING = frozenset({"strict", "surrogateescape"})  # how a stream treats such characters


def _print_what_is_encodable() -> None:
    """Print `?` for what the encoding of the output does not have, as in pipes on Windows.

    In the C locale, Python would write the bytes of a file name as they are: that is no JSON.
    """
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors in ESCAPING:
        sys.stdout.reconfigure(errors="replace")


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
        if COMPLETION not in os.environ:  # a shell that completes words reads only the words
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
        _print_error(error.message, error.hint, color=colors.wanted)
        code = error.exit_code
    except click.ClickException as error:
        _print_usage_error(error, arguments, color=colors.wanted)
        code = EXIT_REQUEST
    except (KeyboardInterrupt, SystemExit, click.Abort) as end:
        code = _report_end(end)
    except Exception as error:  # noqa: BLE001  the last resort: no traceback reaches a beginner
        disk = _explain_disk(error) if isinstance(error, OSError) else None
        library = _explain_library(error) if isinstance(error, ImportError) else None
        if library is not None:
            _print_error(library.message, library.hint, color=colors.wanted)
            code = library.exit_code
        elif disk is not None:
            _drop_standard_output()
            _print_error(disk.message, disk.hint, color=colors.wanted)
            code = disk.exit_code
        else:
            _print_bug(error)
            code = EXIT_BUG
    return code


def _unwind_at_signals() -> None:
    """Let the ending signals raise, so that children are ended and folders removed.

    Python drops what is raised in some places, such as the callbacks of weak references that every
    import has: there, it is raised again a moment later.
    """
    import signal

    def leave(number: int, _frame: object) -> None:
        _ignore_signals()  # a second signal must not interrupt the cleanup
        is_interrupt = number == signal.SIGINT
        _ends.append(KeyboardInterrupt() if is_interrupt else SystemExit(EXIT_SIGNALLED + number))
        raise _ends[-1]

    def raise_again(dropped: sys.UnraisableHookArgs) -> None:
        end = dropped.exc_value
        if not isinstance(end, (KeyboardInterrupt, SystemExit)) or not hasattr(signal, "setitimer"):
            sys.__unraisablehook__(dropped)
            return

        def leave_now(_number: int, _frame: object) -> None:
            raise end

        signal.signal(signal.SIGALRM, leave_now)
        signal.setitimer(signal.ITIMER_REAL, SECONDS_UNTIL_AGAIN)

    for number in _ending_signals():
        signal.signal(number, leave)
    sys.unraisablehook = raise_again


def take_all_signals() -> None:
    """Let SIGINT and SIGTERM end wsgen also where who has started it ignores them.

    A shell has what a script starts in the background ignore SIGINT; `ros2 launch` does not.
    """
    import signal

    taken = (signal.SIGINT, signal.SIGTERM)
    ignored = [number for number in taken if signal.getsignal(number) is signal.SIG_IGN]
    for number in ignored:
        signal.signal(number, signal.SIG_DFL)
    if ignored:
        _unwind_at_signals()


def raise_dropped_end() -> None:
    """Raise again what a signal has raised, if the command goes on all the same.

    Code in C may drop it without a word. A command calls this before it begins what has no end.
    """
    if _ends:
        raise _ends[-1]


def _ignore_signals() -> None:
    import signal

    for number in _ending_signals():
        signal.signal(number, signal.SIG_IGN)


def _ending_signals() -> list[int]:
    """The signals that end wsgen; nohup has us ignore SIGHUP."""
    import signal

    numbers = [getattr(signal, name) for name in SIGNAL_MESSAGES if hasattr(signal, name)]
    return [number for number in numbers if signal.getsignal(number) is not signal.SIG_IGN]


def _report_end(end: BaseException) -> int:
    """Report the signal that ended the command; gives the exit code."""
    import signal

    code = end.code if isinstance(end, SystemExit) else EXIT_INTERRUPTED
    if code == 1:
        # click exits like this when the reader of our output is gone: no failure of wsgen.
        return EXIT_PASSED
    if not isinstance(code, int) or code <= EXIT_SIGNALLED:
        raise end
    with contextlib.suppress(OSError):  # the terminal may be gone
        click.echo(SIGNAL_MESSAGES[signal.Signals(code - EXIT_SIGNALLED).name], err=True)
    return code


class _Colors:
    """Whether to color; None while the terminal decides."""

    def __init__(self) -> None:
        unwanted = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
        self.wanted: bool | None = False if unwanted else None


def _drop_standard_output() -> None:
    """Discard what is not written yet: Python would try again at exit, and fail again."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _check_current_folder() -> None:
    try:
        os.getcwd()  # noqa: PTH109  pathlib is not loaded for --help
    except OSError as error:
        raise NotFoundError(
            "The current folder no longer exists.", hint="Change to another folder: cd"
        ) from error


def _print_error(message: str, hint: str, *, color: bool | None = None) -> None:
    from wsgen.cli.terminal import echo

    labels = (click.style("error:", fg="red", bold=True), click.style("  try:", fg="green"))
    for label, text in zip(labels, (message, hint), strict=True):
        if text:
            # A name with a line break must not begin a line, which may mean something in a log.
            echo(f"{label} {text.replace(chr(10), f'{chr(10)}  | ')}", err=True, color=color)


def _print_usage_error(
    error: click.ClickException, arguments: Sequence[str], *, color: bool | None
) -> None:
    """Print what click refused in the form of all errors."""
    ctx = getattr(error, "ctx", None)
    if ctx is None:
        command = next((f" {one}" for one in arguments[:1] if one in COMMANDS), "")
        _print_error(
            f"{error.format_message().rstrip('.')}.", f"wsgen{command} --help", color=color
        )
        return
    if error.message.startswith("Usage: "):  # click gives the help to whom gives no words
        error.show()
        return
    from wsgen.text.suggestions import did_you_mean, nearest

    # A required option gets its choices by click on lines of their own.
    message, near = re.sub(r"(:|,)\n\t", r"\1 ", error.format_message()), None
    if isinstance(error, click.NoSuchOption):
        message = f"{ctx.command_path} has no option {error.option_name}"
        options = {option.lstrip("-"): option for option in error.possibilities or ()}
        near = nearest(error.option_name.lstrip("-"), options)  # dashes are not a similarity
        near = near and options[near]
    usage = " ".join(ctx.get_usage().partition(" ")[2].split())
    hint = did_you_mean(near) if near else f"{usage} (options: {ctx.command_path} --help)"
    # click has a question at the end of some: did you mean another command?
    for kind, one in (("float", "a number"), ("integer", "an integer")):
        message = re.sub(rf"is not a valid {kind}( range)?\b", f"is not {one}", message)
    message = message.rstrip(".")
    _print_error(message if message.endswith("?") else f"{message}.", hint, color=color)


def _explain_library(error: ImportError) -> WsgenError | None:
    """The error for a library of the system that a compiled module needs; None for any other."""
    from wsgen.isolation.result import find_missing_library

    missing = find_missing_library(str(error))
    if missing is None:
        return None
    return NotFoundError(
        f"The Python module {error.name} needs {missing.name}, which the system lacks.",
        hint=missing.advice,
    )


def _explain_disk(error: OSError) -> WsgenError | None:
    from wsgen.text.files import explain_disk_error

    return explain_disk_error(error)


def _print_bug(error: Exception) -> None:
    import traceback

    if os.environ.get("WSGEN_TRACEBACK"):
        traceback.print_exc()
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(last.filename)}:{last.lineno}"  # noqa: PTH119  no pathlib here
    _print_error(
        f"This is a bug in wsgen {__version__}: {type(error).__name__}: {error} ({place}).",
        "Set WSGEN_TRACEBACK=1, run the command again and report the output.",
    )

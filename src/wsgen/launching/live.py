"""What starts processes while a launch file is evaluated for real, as the shim sees it.

An evaluation has none of it (`RECORD.live` is None) where it makes a plan: nothing is started then,
and time is virtual.
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.launching.record import CommandOutcome
    from wsgen.model.plan import Include, Process


@dataclass(frozen=True, kw_only=True)
class ParameterGroup:
    """Parameters of a node that are given at once, in a file."""

    file: Path | None = None  # that exists, or not
    text: str | None = None  # of a file whose substitutions were performed
    values: Mapping[str, Any] = field(default_factory=dict)  # of neither
    is_for_all: bool = False  # the values are those of whatever node the process has


@dataclass(frozen=True, kw_only=True)
class Start:
    """A process to be started, as the launch file wants it."""

    action: Any  # of the launch file
    process: Process  # as a plan has it
    package: str | None = None  # of a node; None: `words` are a command line
    executable: str | None = None
    path: str | None = None  # of the executable, where it is known
    node: str | None = None  # its full name, if it has one
    name: str | None = None  # what the process is called, without its number; None: as its program
    prefix: tuple[str, ...] = ()  # what runs the command
    words: tuple[str, ...]  # the command, or what follows the path of a node
    is_shell: bool = False
    folder: str | None = None
    environment: Mapping[str, str]  # complete
    output: Mapping[str, Any] | str = "log"
    output_format: str | None = None
    is_cached: bool = False
    emulates_tty: bool = False
    logs_command: bool = False
    respawns: bool = False
    respawn_delay: float = 0.0  # s
    respawn_max_retries: int = -1  # negative: without end
    sigterm_timeout: float = 5.0  # s after SIGINT
    sigkill_timeout: float = 5.0  # s after SIGTERM


def joined(groups: Iterable[ParameterGroup]) -> list[ParameterGroup]:
    """The groups, with values that follow one another in one of them."""
    found: list[ParameterGroup] = []
    for group in groups:
        last = found[-1] if found else None
        if last and last.values and group.values and last.is_for_all == group.is_for_all:
            found[-1] = replace(last, values={**last.values, **group.values})
        else:
            found.append(group)
    return found


class Live(Protocol):
    """Starts what a launch file describes."""

    def make_timeline(self) -> Any:
        """Make a timeline, on which real time passes; contexts of launch files have their own."""

    def begin(self, context: Any) -> None:
        """Begin to play the launch whose state this is."""

    def start(self, start: Start) -> None:
        """Start a process after what is being done."""

    def write_parameters(self, group: ParameterGroup, node: str) -> str | None:
        """Write parameters into a file that a node can be given; None: the file is missing."""

    def load(self, process: Process, extra_arguments: Mapping[str, Any]) -> None:
        """Load a node into its container."""

    def follow_states(self, action: Any) -> None:
        """Let the transitions of the lifecycle node of an action be events of the launch."""

    def change_state(self, action: Any, transition: int) -> None:
        """Ask the lifecycle node of an action for a transition, given by its number."""

    def included(self, include: Include) -> Iterable[Any]:
        """What is visited in the place of a launch file that is not installed."""

    def end(self, matches: Callable[[Any], bool]) -> None:
        """End the processes whose actions match."""

    def send_signal(self, number: str | int, matches: Callable[[Any], bool]) -> None:
        """Send a signal, given by its number or name, to the processes whose actions match."""

    def shut_down(self, context: Any, *, due_to_sigint: bool) -> None:
        """End all processes, after those have been asked who handle the end of the launch."""

    def run_coroutine(self, run: Callable[[], None], done: Callable[[], None]) -> None:
        """Call a function while the launch goes on, and another one in the launch afterwards."""

    def run_command(self, words: Sequence[str]) -> CommandOutcome:
        """Run a command to its end."""

    def leave_out(self, what: str, why: str) -> None:
        """Name something that cannot run here."""

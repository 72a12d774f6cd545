"""The shutdown of a launch: who asks for it, whether all went well, the exit code."""

from __future__ import annotations

import logging
import signal
from typing import TYPE_CHECKING, Any

from wsgen.errors import EXIT_FAILED, EXIT_MISSING, EXIT_PASSED, EXIT_SIGNALLED
from wsgen.live.awaited import what_is_started

if TYPE_CHECKING:
    from wsgen.launching.live import Start


class Shutdown:
    """How one launch ends.

    Attributes:
        went_well: Whether nothing has failed, as far as this, and not the launch file, is
            concerned.

    Args:
        until_exit: The node or process whose end is to be that of all.
    """

    def __init__(self, until_exit: str | None) -> None:
        self.went_well = True
        self._until_exit = until_exit
        self._is_awaited_missing = False
        self._started: set[str] = set()  # names of processes
        self._has_awaited = until_exit is None  # or it is said that it is not started
        self._is_interrupted = False
        self._is_terminated = False
        self._has_run = False  # a process was started
        self._is_all_left_out = False
        self._logger = logging.getLogger("launch")
        self._context: Any = None

    def begin(self, context: Any) -> None:
        """Begin to play the launch whose state this is."""
        self._context = context

    def has_begun(self) -> bool:
        """Whether processes are asked to end, and none is started any more."""
        return bool(self._context.is_shutdown)

    def request(self, reason: str, *, due_to_sigint: bool = False) -> None:
        """Shut the launch down, as soon as its handlers have been asked."""
        from launch._events import Shutdown as ShutdownEvent  # noqa: PLC0415  the shim's

        if not self.has_begun():
            event = ShutdownEvent(reason=reason, due_to_sigint=due_to_sigint)
            self._context.timeline.post(event)

    def fail(self, text: str, reason: str | None = None) -> None:
        """Shut the launch down because of what has gone wrong; the reason is the text as a rule."""
        self.went_well = False
        self._logger.error("%s", text)
        self.request(reason or text)

    def interrupt(self) -> None:
        """Shut down as Ctrl-C does."""
        message = "user interrupted with ctrl-c (SIGINT)"
        if self._is_interrupted:
            self._logger.warning("%s again, ignoring...", message)
            return
        self._is_interrupted = True
        self._logger.warning("%s", message)
        self.request("ctrl-c (SIGINT)", due_to_sigint=True)

    def terminate(self) -> None:
        """Shut down as SIGTERM does."""
        self._is_terminated = True
        self.request("SIGTERM")

    def is_awaited(self, start: Start, name: str) -> bool:
        """Whether the end of this process is to be that of all."""
        names = {name, name.rpartition("-")[0], start.executable, start.node}
        names.add((start.node or "").rpartition("/")[2])
        return self._until_exit is not None and self._until_exit in names

    def note_start(self, start: Start, name: str) -> None:
        """Note the name of a process that is to be started."""
        self._started.add(name.rpartition("-")[0])
        if self.is_awaited(start, name):
            self._has_awaited = True

    def note_run(self) -> None:
        """Note that a process was started."""
        self._has_run = True

    def look_for_awaited(self, *, may_come: bool) -> None:
        """Say once that what is awaited has not been started, when all that was due has been.

        `may_come` says whether something that is still to happen may start it.
        """
        if self._has_awaited or not self._started or self.has_begun():
            return
        if self._context.timeline.starts_more:
            return
        self._has_awaited = True
        name = self._until_exit or ""
        hint = what_is_started(name, self._started).replace("It starts", "It has started", 1)
        if may_come or self._context.has_event_handlers:
            text = f"nothing is started yet that is called {name}, whose end --until-exit waits for"
            self._logger.warning("%s", f"{text}. {hint}")
        else:
            self._logger.error("%s", f"the launch file starts nothing called {name}. {hint}")
            self.give_up()

    def give_up(self) -> None:
        """End all: what is waited for does not run, and never ends."""
        if self._is_awaited_missing:
            return
        self._is_awaited_missing = True
        self.fail(f"{self._until_exit}, whose end --until-exit waits for, is not started")

    def take_end(self, start: Start, name: str, code: int, *, is_simulator: bool) -> None:
        """Shut down where the end of this process is the end of all."""
        if self.has_begun():
            return
        if is_simulator:
            self.went_well &= code == 0
            self.request("the simulation has ended")
        if self.is_awaited(start, name):
            self.went_well &= code == 0
            self.request(f"{self._until_exit} has ended")

    def end_idle(self, *, is_left_out: bool) -> None:
        """Shut down where nothing runs any more; `is_left_out`: something that is missed."""
        if self._until_exit is not None:  # its end would have been that of all
            self.give_up()
        elif is_left_out and not self._has_run:
            self._is_all_left_out = True
            self._logger.error("nothing has run: all that the launch file starts is left out")
        self.request("idle")

    def exit_code(self, *, went_well: bool) -> int:
        """That of the launch service; `went_well` says it of the launch file."""
        if self._is_terminated:
            return EXIT_SIGNALLED + signal.SIGTERM
        if not (went_well and self.went_well):
            return EXIT_FAILED
        return EXIT_MISSING if self._is_all_left_out else EXIT_PASSED

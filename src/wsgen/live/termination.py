"""The events of a live launch, and how it ends: who asks for it, exit code, signals of processes.

The time of events is that of the clock, or of the simulator, which is asked for it.
"""

from __future__ import annotations

import heapq
import itertools
import logging
import signal
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import EXIT_FAILED, EXIT_MISSING, EXIT_PASSED, EXIT_SIGNALLED
from wsgen.live.journal import OTHER, FailedProgram, Failures
from wsgen.live.plan_checks import what_is_started
from wsgen.live.process import ENDING
from wsgen.live.python_failures import explain_module, explain_numpy, find_source
from wsgen.simulation.live_runs import SimulatorClient, SimulatorError

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.launching.live import Start
    from wsgen.live.journal import JournalWriter
    from wsgen.live.process import Causes, RunningProcess
    from wsgen.live.python_failures import Frame, SourceLine
    from wsgen.live.request import ServiceRequest


class Termination:
    """Ends the processes of one launch, with the signals and the words of `ros2 launch`.

    Args:
        request: What is played.
        shutdown: Of the launch.
        journal: Where the ends of processes are noted.
        is_running: Whether a process has not been reaped.
    """

    def __init__(
        self,
        request: ServiceRequest,
        shutdown: Shutdown,
        journal: JournalWriter | None,
        is_running: Callable[[RunningProcess], bool],
    ) -> None:
        self._request = request
        self._shutdown = shutdown
        self._journal = journal
        self._is_running = is_running
        self._missing_modules: set[str] = set()
        self._missing_names: set[str] = set()  # what was said of them
        self._newer_numpy: set[str] = set()  # releases
        self._traced: dict[tuple[Frame, ...], SourceLine | None] = {}
        self._failures = Failures(request.folder)
        self._timeline: Any = None

    def begin(self, timeline: Any) -> None:
        """Begin to play the launch whose events these are."""
        self._timeline = timeline

    def end(self, process: RunningProcess, *, is_notified: bool) -> None:
        """Send SIGINT now, later SIGTERM, then SIGKILL, while the process does not end."""
        if process.is_ending:
            return
        process.is_ending = True
        if is_notified:
            self.send_signal(process, signal.SIGINT)
        else:  # the terminal has signaled it, as far as users know
            process.send_signal(signal.SIGINT)
        start = process.start
        first = start.sigterm_timeout
        second = first + start.sigkill_timeout
        steps = (
            (first, signal.SIGINT, signal.SIGTERM, f"{first:g}"),
            (second, signal.SIGTERM, signal.SIGKILL, str(second)),
        )
        for delay, before, then, words in steps:
            message = (
                f"process[{process.name}] failed to terminate '{words}' seconds after receiving "
                f"'{before.name}', escalating to '{then.name}'"
            )
            escalate = ScheduledCall(
                partial(self._escalate, process, then, message), partial(self._has_ended, process)
            )
            self._timeline.post(escalate, delay=delay)

    def send_signal(self, process: RunningProcess, number: int) -> None:
        """Send a signal, and say so."""
        name = signal.Signals(number).name
        text = f"sending signal '{name}' to process[{process.name}]"
        logging.getLogger(process.name).info("%s", text)
        process.send_signal(number)

    def take_end(self, process: RunningProcess, code: int, causes: Causes) -> None:
        """Report to users, the launch file and the journal how a process has ended.

        Args:
            process: That has ended, and is reaped.
            code: Its exit code; minus the number of the signal that has ended it.
            causes: What it has printed of why it has ended.
        """
        logger = logging.getLogger(process.name)
        is_wanted = process.is_end_wanted(code) or self._shutdown.has_begun()
        source = None
        if code == 0:
            logger.info("process has finished cleanly [pid %d]", process.pid)
        else:
            text = f"process has died [pid {process.pid}, exit code {code}, cmd '{process.shown}']."
            logger.error("%s", text)
            self._report_cause(process, causes)
            # What signals have ended has named no mistake; a module to be installed is none.
            if code > 0 and causes.missing_module is None and not process.is_end_wanted(code):
                source = self._report_source(process, causes.frames)
        if code == 0 or is_wanted or -code in ENDING:  # by whoever has sent the signal
            self._failures.remove(process.name)
        else:
            failed = FailedProgram(
                name=process.name.rpartition("-")[0],
                place=None if source is None else source.place,
                is_built=source is None or not source.is_link,
                missing_module=causes.missing_module,
                is_of_user=process.role == OTHER,
            )
            self._failures.add(process.name, failed)
        if self._journal is not None:
            self._journal.ended(process.name, code, is_wanted=is_wanted)
        action = process.start.action
        action.return_code = code
        from launch._events import ProcessExited  # noqa: PLC0415  the shim's, of this process

        self._timeline.post(ProcessExited(returncode=code, **action.process_details))

    def _escalate(self, process: RunningProcess, number: int, message: str) -> None:
        logging.getLogger(process.name).error("%s", message)
        self.send_signal(process, number)

    def _has_ended(self, process: RunningProcess) -> bool:
        return not self._is_running(process)

    def _report_cause(self, process: RunningProcess, causes: Causes) -> None:
        """Say once what to install, where that is why a process has ended; or what it misspells."""
        request = self._request
        python = None if request.is_sourced else request.python
        logger = logging.getLogger(process.name)
        module, numpy = causes.missing_module, causes.newer_numpy
        if numpy is not None and numpy not in self._newer_numpy:
            self._newer_numpy.add(numpy)
            logger.error("%s", explain_numpy(numpy, python))
        if causes.missing_name is not None and causes.missing_name not in self._missing_names:
            self._missing_names.add(causes.missing_name)
            logger.error("%s", causes.missing_name)
        if module is None or module in self._missing_modules:
            return
        self._missing_modules.add(module)
        distro = request.environment.get("ROS_DISTRO") if request.is_sourced else None
        logger.error("%s", explain_module(module, python, request.packages, distro))

    def _report_source(
        self, process: RunningProcess, frames: tuple[Frame, ...]
    ) -> SourceLine | None:
        """Say once where the source is of what has ended a process: it has named the copy."""
        if frames not in self._traced:
            sources = {Path(share): source for share, source in self._request.sources.items()}
            self._traced[frames] = source = find_source(frames, sources)
            if source is not None:
                logging.getLogger(process.name).error("%s", source.reported())
        return self._traced[frames]


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


LONGEST_WAIT = 0.5  # s; what ends without a signal is noticed after it
PUMP_SECONDS = 0.02  # the longest time that events keep the output of processes waiting
POLL_SECONDS = 0.05  # between two looks at the time of the simulation


class ScheduledCall:
    """A function that is called at a time, and is no event of launch."""

    wsgen_cause: str | None = "launch"

    def __init__(
        self, call: Callable[[], object], is_void: Callable[[], bool] | None = None
    ) -> None:
        self.call = call
        self._is_void = is_void

    @property
    def wsgen_is_void(self) -> bool:
        """Whether it need not be called any more."""
        return self._is_void is not None and self._is_void()


class _Simulated(NamedTuple):
    """An event that waits for the time of the simulation."""

    due: float  # s, simulated
    event: Any


class LiveTimeline:
    """As the timeline of a plan, on which real time passes.

    Args:
        wait: Waits for what happens outside, so many seconds at most, and posts its events.
        is_busy: Whether anything runs whose end is yet to come.
        simulated_now: The time of the simulation in seconds; None where it has not begun.
    """

    def __init__(
        self,
        wait: Callable[[float], None],
        is_busy: Callable[[], bool],
        simulated_now: Callable[[], float | None],
    ) -> None:
        self.cause = "launch"  # of plans
        self._wait = wait
        self._is_busy = is_busy
        self._simulated_now = simulated_now
        self._order = itertools.count()
        self._coming: list[tuple[float, int, Any]] = []
        self._simulated: list[_Simulated] = []
        self._begun = time.monotonic()
        self._pumped = 0.0

    @property
    def now(self) -> float:
        """Seconds since the launch."""
        return time.monotonic() - self._begun

    def post(self, event: Any, *, delay: float = 0.0, is_simulated: bool = False) -> None:
        """Let the event happen after a delay in seconds."""
        if event.wsgen_cause is None:
            event.wsgen_cause = self.cause
        now = self._simulated_now() if is_simulated and delay > 0.0 else None
        if is_simulated and delay > 0.0:
            # Before the simulation begins its time is zero.
            self._simulated.append(_Simulated(due=(now or 0.0) + delay, event=event))
        else:
            due = time.monotonic() + max(0.0, delay)
            heapq.heappush(self._coming, (due, next(self._order), event))

    def next(self) -> Any | None:
        """Wait for the next event; None where nothing can bring one any more."""
        while True:
            now = time.monotonic()
            if now - self._pumped > PUMP_SECONDS:
                self._pumped = now
                self._wait(0.0)
            self._drop_void()
            if self._coming and self._coming[0][0] <= now:
                _, _, event = heapq.heappop(self._coming)
                if isinstance(event, ScheduledCall):
                    event.call()
                    continue
                self.cause = event.wsgen_cause or "launch"
                return event
            if not self._coming and not self._simulated and not self._is_busy():
                return None
            seconds = LONGEST_WAIT
            if self._coming:
                seconds = min(seconds, self._coming[0][0] - now)
            if self._simulated:
                seconds = min(seconds, POLL_SECONDS)
                self._take_simulated()
            self._wait(max(0.0, seconds))
            self._pumped = time.monotonic()

    @property
    def starts_more(self) -> bool:
        """Whether events of the launch are to come, which may start processes."""
        return bool(self._simulated) or any(
            not isinstance(event, ScheduledCall) for _, _, event in self._coming
        )

    def cancel(self, is_canceled: Callable[[Any], bool]) -> None:
        """Drop events that are to come."""
        self._coming = [entry for entry in self._coming if not is_canceled(entry[-1])]
        heapq.heapify(self._coming)
        self._simulated = [entry for entry in self._simulated if not is_canceled(entry.event)]

    def clear(self) -> None:
        """Drop nothing: what runs is yet to end."""

    def _drop_void(self) -> None:
        if any(entry[-1].wsgen_is_void for entry in self._coming):
            self.cancel(lambda event: event.wsgen_is_void)
        self._simulated = [one for one in self._simulated if not one.event.wsgen_is_void]

    def _take_simulated(self) -> None:
        now = self._simulated_now()
        if now is None:
            return
        for one in [one for one in self._simulated if one.due <= now]:
            self._simulated.remove(one)
            self.post(one.event)


SECONDS = 0.2  # wall-clock, for an answer


class SimulatedTime:
    """The time of the simulator in the folder of a live run, asked by one connection."""

    def __init__(self, folder: Path) -> None:
        self._client = SimulatorClient(folder, patience=SECONDS)

    def now(self) -> float | None:
        """Seconds of the simulation; None where the simulator is not there or does not answer."""
        try:
            if self._client.connect(0.0):
                return float(self._client.ask("state")["seconds"])
        except (SimulatorError, OSError, ValueError, TypeError, KeyError):
            self.close()  # a late answer would be that to the next question
        return None

    def close(self) -> None:
        """End the connection."""
        self._client.close()

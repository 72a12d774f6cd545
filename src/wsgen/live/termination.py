"""How processes of a live launch end: the signals that they get, and how an end is reported."""

from __future__ import annotations

import logging
import signal
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.live.failures import FailedProgram, Failures
from wsgen.live.journal import OTHER
from wsgen.live.missing_modules import explain_module, explain_numpy
from wsgen.live.process import ENDING
from wsgen.live.timeline import ScheduledCall
from wsgen.live.tracebacks import find_source

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.live.journal import JournalWriter
    from wsgen.live.process import Causes, RunningProcess
    from wsgen.live.request import ServiceRequest
    from wsgen.live.shutdown import Shutdown
    from wsgen.live.tracebacks import Frame, SourceLine


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

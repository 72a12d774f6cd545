"""Events -> standard error: a status line on a terminal, elsewhere one line for each step.

Of a sweep it says how many runs are done.
"""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from wsgen.cli.terminal import echo
from wsgen.events import Event, Listener, OutputLine, StepEnded, StepProgressed, StepStarted
from wsgen.text.printable import clean_line

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType

    from wsgen.cli.terminal import StatusLine
    from wsgen.sweeping.sweep import Progress


class LineProgress:
    """One line when a step ends, for logs; with `verbose` also the output of other programs."""

    def __init__(self, *, verbose: bool) -> None:
        self.verbose = verbose

    def __call__(self, event: Event) -> None:
        """Draw one event."""
        if isinstance(event, StepEnded):
            echo(_ended(event), err=True)
        elif isinstance(event, StepStarted) and (self.verbose or self._shows(event)):
            echo(f"  ...  {_title(event)}", err=True)
        elif isinstance(event, OutputLine) and self.verbose:
            echo(f"       {event.text}", err=True)

    def _shows(self, event: StepStarted) -> bool:
        """Whether a line says that a step begins."""
        return event.takes_long


class TerminalProgress(LineProgress):
    """The running steps with a spinner, below the lines of those that ended."""

    def __init__(self, *, verbose: bool, keeps_lines: bool = True) -> None:
        super().__init__(verbose=verbose)
        self.keeps_lines = keeps_lines  # of steps that ended
        from wsgen.cli.terminal import StatusLine

        self.status = StatusLine()
        self.running: dict[tuple[str, ...], str] = {}  # several, with more than one job

    def _shows(self, event: StepStarted) -> bool:
        """The status line does."""
        del event
        return False

    def __call__(self, event: Event) -> None:
        """Draw one event."""
        if isinstance(event, (StepStarted, StepProgressed)):
            self.running[event.step] = _title(event)
        if isinstance(event, StepEnded):
            self.running.pop(event.step, None)
            self.status.hide()
        if self.keeps_lines or not isinstance(event, StepEnded):
            super().__call__(event)
        if self.running:
            self.status.show("  ".join(self.running.values()))


@contextmanager
def listening(*, quiet: bool, verbose: bool, is_short: bool = False) -> Iterator[Listener | None]:
    """The listener for standard error; None for `quiet`.

    With `is_short`, no line stays for a step that ended, unless `verbose`.
    """
    if quiet:
        yield None
    elif sys.stderr is not None and sys.stderr.isatty():
        progress = TerminalProgress(verbose=verbose, keeps_lines=verbose or not is_short)
        try:
            yield progress
        finally:
            progress.status.hide()
    else:
        yield LineProgress(verbose=verbose)


def _title(event: StepStarted | StepProgressed | StepEnded) -> str:
    return clean_line(f"{' '.join(event.step)}  {event.detail}".rstrip())


def _ended(event: StepEnded) -> str:
    mark = click.style("  ok ", fg="green") if event.succeeded else click.style("failed", fg="red")
    seconds = click.style(f"{event.seconds:.2f} s", dim=True)
    return f"{mark:6} {_title(event)}  {seconds}"


SHOW_EVERY = 0.1  # s, wall-clock, on a terminal
PRINT_EVERY = 10.0  # s, wall-clock, in a log
MINUTE, HOUR = 60, 3600  # s


class SweepProgress:
    """A status line on a terminal; elsewhere now and then a line."""

    def __init__(self, *, quiet: bool) -> None:
        self._is_quiet = quiet
        self._status: StatusLine | None = None
        self._shown = time.monotonic()
        if not quiet and sys.stderr is not None and sys.stderr.isatty():
            from wsgen.cli.terminal import StatusLine

            self._status = StatusLine()
        self._last: Progress | None = None

    def __enter__(self) -> SweepProgress:  # noqa: PYI034  Python 3.10 has no Self
        return self

    def hide(self) -> None:
        """Remove the status line, so that others can be printed."""
        if self._status is not None:
            self._status.hide()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.hide()
        last = self._last
        if error is not None and last is not None and not self._is_quiet and last.done < last.runs:
            echo(
                f"{last.done:,} of {last.runs:,} runs are done. Run the same command again to "
                "continue.",
                err=True,
            )

    def __call__(self, progress: Progress) -> None:
        """Show how far the sweep is, if it is time to."""
        self._last = progress
        now = time.monotonic()
        if self._is_quiet or now < self._shown + (SHOW_EVERY if self._status else PRINT_EVERY):
            return
        self._shown = now
        text = _describe(progress)
        if self._status is not None:
            self._status.show(text)
        else:
            echo(f"  {text}", err=True)


def _describe(progress: Progress) -> str:
    parts = [f"{progress.done:,} of {progress.runs:,} runs"]
    if progress.failed:
        parts.append(f"{progress.failed:,} failed")
    if progress.seconds_left is not None:
        parts.append(f"{write_duration(progress.seconds_left)} left")
    return ", ".join(parts)


def write_duration(seconds: float) -> str:
    """A time as a person says it."""
    whole = round(seconds)
    if whole < MINUTE:
        return f"{whole} s"
    if whole < HOUR:
        return f"{whole // MINUTE} min {whole % MINUTE} s"
    minutes = round(seconds / MINUTE)
    return f"{minutes // MINUTE} h {minutes % MINUTE} min"

"""How far a sweep is, on standard error."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from wsgen.cli.terminal import echo

if TYPE_CHECKING:
    from types import TracebackType

    from wsgen.cli.terminal import StatusLine
    from wsgen.sweeping.sweep import Progress


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

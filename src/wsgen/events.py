"""Progress as values; listeners draw them.

A step is named by its path: `("build", "gazebo_test")` is the package inside the build.
A listener that fails must not break the work: `post` suppresses its exceptions, because a broken
terminal is no reason to lose a build.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class StepStarted:
    """A step begins; `detail` says what it works on."""

    step: tuple[str, ...]
    detail: str = ""
    takes_long: bool = False  # more than a few seconds: a log says it at once


@dataclass(frozen=True, kw_only=True)
class StepProgressed:
    """A step continues; `detail` says what it does at this moment."""

    step: tuple[str, ...]
    detail: str


@dataclass(frozen=True, kw_only=True)
class OutputLine:
    """A line that another program printed while the step ran."""

    step: tuple[str, ...]
    text: str
    is_error_stream: bool = False


@dataclass(frozen=True, kw_only=True)
class StepEnded:
    """A step ends."""

    step: tuple[str, ...]
    succeeded: bool
    seconds: float  # wall-clock
    detail: str = ""


Event = StepStarted | StepProgressed | OutputLine | StepEnded
Listener = Callable[[Event], None]


class OneAtATime:
    """A listener for several threads: it receives one event at a time, until it is closed."""

    def __init__(self, listener: Listener | None) -> None:
        self._listener = listener
        self._lock = threading.Lock()

    def __call__(self, event: Event) -> None:
        """Pass the event on."""
        with self._lock:
            if self._listener is not None:
                self._listener(event)

    def listen(self, listener: Listener) -> None:
        """Pass the events on to another listener, if they were passed on to one."""
        if self._listener is not None:
            self._listener = listener

    def close(self) -> None:
        """Receive no more events, so that an interrupted step is not reported as failed."""
        self._listener = None


def post(listener: Listener | None, event: Event) -> None:
    """Pass the event to the listener; one that raises does not break the work."""
    if listener is not None:
        with contextlib.suppress(Exception):
            listener(event)

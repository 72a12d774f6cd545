"""Things that are done to processes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.event import Event

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.actions.execute_local import ExecuteLocal


class ProcessTargetedEvent(Event):
    """Meant for the processes that the matcher accepts."""

    name = "launch.events.process.ProcessTargetedEvent"

    def __init__(self, *, process_matcher: Callable[[ExecuteLocal], bool]) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """End a process."""

    name = "launch.events.process.ShutdownProcess"


class SignalProcess(ProcessTargetedEvent):
    """Send a signal to a process."""

    name = "launch.events.process.SignalProcess"

    def __init__(
        self, *, signal_number: str | int, process_matcher: Callable[[ExecuteLocal], bool]
    ) -> None:
        super().__init__(process_matcher=process_matcher)
        self.signal = signal_number

"""The launch ends."""

from __future__ import annotations

from launch.event import Event


class Shutdown(Event):
    """Asks for the end of the launch."""

    name = "launch.events.Shutdown"
    wsgen_cause = "shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint

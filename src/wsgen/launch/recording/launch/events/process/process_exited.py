"""A process ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.events.process.running_process_event import RunningProcessEvent

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class ProcessExited(RunningProcessEvent):
    """A process ended; here always well."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int = 0, **keywords: Any) -> None:
        super().__init__(**keywords)
        self.returncode = returncode

    def wsgen_happen(self, context: LaunchContext) -> None:
        """Its action is complete now."""
        self.action.announce_completion(context)

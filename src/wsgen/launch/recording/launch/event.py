"""Something that happens."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Event:
    """Base of all events, also of those that users write."""

    name = "launch.Event"
    wsgen_cause: str | None = None  # what to name as the reason for what it starts

    def wsgen_happen(self, context: LaunchContext) -> Any:
        """What the event brings about by itself, before its handlers are asked."""

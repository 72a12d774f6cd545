"""End the launch."""

from __future__ import annotations

from typing import Any

from launch.actions.emit_event import EmitEvent
from launch.events.shutdown import Shutdown as ShutdownEvent


class Shutdown(EmitEvent):
    """Ends the launch."""

    def __init__(self, *, reason: str = "reason not given", **kwargs: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **kwargs)

"""A timer fires."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.event import Event

if TYPE_CHECKING:
    from launch.actions.timer_action import TimerAction
    from launch.launch_context import LaunchContext


class TimerEvent(Event):
    """The period of a timer action is over."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: TimerAction) -> None:
        self.timer_action = timer_action

    def wsgen_happen(self, context: LaunchContext) -> Any:
        """The actions of the timer."""
        return self.timer_action.handle(context)

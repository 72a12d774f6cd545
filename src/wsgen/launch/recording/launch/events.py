"""All events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._finder import show_public_names
from launch.base import Event

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.actions import TimerAction
    from launch.base import Action
    from launch.launch_context import LaunchContext


class ExecutionComplete(Event):
    """An action was executed to its end."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Action) -> None:
        self.action = action


def matches_action(target_action: Action) -> Callable[[Action], bool]:
    """Whether an action is this very one."""
    return lambda action: action is target_action


class Shutdown(Event):
    """Asks for the end of the launch."""

    name = "launch.events.Shutdown"
    wsgen_cause = "shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class TimerEvent(Event):
    """The period of a timer action is over."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: TimerAction) -> None:
        self.timer_action = timer_action

    def wsgen_happen(self, context: LaunchContext) -> Any:
        """The actions of the timer."""
        return self.timer_action.handle(context)


show_public_names(__name__)

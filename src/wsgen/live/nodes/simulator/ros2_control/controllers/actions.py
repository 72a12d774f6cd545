"""Actions whose goals end in updates of a controller, not in a function that waits."""

from __future__ import annotations

from typing import Any, Literal

from rclpy.action import ActionServer

End = Literal["succeed", "abort", "canceled"]


class GoalServer(ActionServer):
    """An action server that executes nothing: goals run until `finish`.

    rclpy would poll a function that waits for the end of its goal each time that it looks for
    messages.
    """

    def notify_execute(self, goal_handle: Any, execute_callback: Any) -> None:
        """A goal begins; there is nothing to call."""

    def finish(self, goal_handle: Any, end: End, result: Any) -> None:
        """End a goal and send its result; a goal that is to be canceled is asked for `canceled`."""
        if not goal_handle.is_active:
            return
        getattr(goal_handle, end)()
        super().notify_execute(goal_handle, lambda _: result)

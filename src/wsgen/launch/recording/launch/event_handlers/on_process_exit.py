"""When a process ends."""

from __future__ import annotations

from typing import Any

from launch.actions.execute_local import ExecuteLocal
from launch.event_handlers.on_action_event_base import OnActionEventBase
from launch.events.process.process_exited import ProcessExited


class OnProcessExit(OnActionEventBase):
    """What is done when a process ends; without a target, any process."""

    def __init__(self, *, target_action: Any = None, on_exit: Any, **kwargs: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_exit,
            target_event_cls=ProcessExited,
            target_action_cls=ExecuteLocal,
            **kwargs,
        )

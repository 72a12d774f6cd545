"""Something that a process does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.event import Event

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from launch.actions.execute_local import ExecuteLocal


class RunningProcessEvent(Event):
    """An event of one process; the process number is invented, because nothing runs."""

    name = "launch.events.process.RunningProcessEvent"

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        action: ExecuteLocal,
        name: str,
        cmd: Sequence[str],
        cwd: str | None = None,
        env: Mapping[str, str] | None = None,
        pid: int = 0,
    ) -> None:
        self.action = action
        self.execute_process_action = action
        self.process_name = name
        self.cmd = cmd
        self.cwd = cwd
        self.env = env
        self.pid = pid

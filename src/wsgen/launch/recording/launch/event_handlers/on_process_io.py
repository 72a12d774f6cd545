"""When a process writes."""

from __future__ import annotations

from typing import Any

from launch.event_handler import BaseEventHandler
from wsgen.launch.record import RECORD, caller


class OnProcessIO(BaseEventHandler):
    """Never handles anything, because nothing runs; what waits for output is unresolved."""

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **kwargs: Any,
    ) -> None:
        del target_action, on_stdin, on_stdout, on_stderr
        super().__init__(matcher=lambda _event: False, **kwargs)
        RECORD.note_unresolved(
            "OnProcessIO", "what a process writes is known only when it runs", caller()
        )

"""colcon's events as ours, and what the result of the build keeps of them."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.events import OutputLine, StepEnded, StepProgressed, StepStarted, post

if TYPE_CHECKING:
    from wsgen.events import Listener

STEP = ("build",)
INTERRUPTED = "SIGINT"  # what colcon gives for the return code of a job that it stopped


@dataclass(frozen=True, kw_only=True)
class PackageResult:
    """What became of one package."""

    name: str
    outcome: str  # "built", "failed", "interrupted" (another one failed meanwhile) or "skipped"
    seconds: float  # wall-clock
    error_output: tuple[str, ...] = ()  # the lines its programs wrote to standard error


@dataclass
class Progress:
    """Called for each event of `colcon_events`."""

    listener: Listener | None
    results: list[PackageResult] = field(default_factory=list)
    log_folder: Path | None = None
    colcon_output: list[str] = field(default_factory=list)  # what it wrote to standard error
    _started: dict[str, float] = field(default_factory=dict)  # time.monotonic()
    _error_output: dict[str, list[str]] = field(default_factory=dict)

    def __call__(self, event: dict[str, Any]) -> None:
        """Hand on the event, and remember what the result needs."""
        if event["event"] == "log":
            self.log_folder = None if event["path"] is None else Path(event["path"])
            return
        name: str = event["package"]
        step = (*STEP, name)
        if event["event"] == "started":
            self._started[name] = time.monotonic()
            post(self.listener, StepStarted(step=step))
        elif event["event"] == "progress":
            post(self.listener, StepProgressed(step=step, detail=event["detail"]))
        elif event["event"] == "line":
            is_error = event["is_error_stream"]
            if is_error:
                self._error_output.setdefault(name, []).append(event["text"])
            post(self.listener, OutputLine(step=step, text=event["text"], is_error_stream=is_error))
        elif event["event"] == "skipped":
            self.results.append(PackageResult(name=name, outcome="skipped", seconds=0.0))
        elif event["event"] == "ended":
            self._end(name, event["result"])

    def _end(self, name: str, returncode: int | str) -> None:
        outcome = {0: "built", INTERRUPTED: "interrupted"}.get(returncode, "failed")
        seconds = time.monotonic() - self._started[name]
        self.results.append(
            PackageResult(
                name=name,
                outcome=outcome,
                seconds=seconds,
                error_output=tuple(self._error_output.get(name, ())),
            )
        )
        post(
            self.listener,
            StepEnded(
                step=(*STEP, name),
                succeeded=outcome == "built",
                seconds=seconds,
                detail="" if outcome == "built" else outcome,
            ),
        )

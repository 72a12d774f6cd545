"""Input and output of processes; never happens here, but handlers name the classes."""

from __future__ import annotations

from typing import Any

from launch.events.process.running_process_event import RunningProcessEvent


class ProcessIO(RunningProcessEvent):
    """A process reads or writes."""

    name = "launch.events.process.ProcessIO"

    def __init__(self, *, text: bytes, fd: int, **keywords: Any) -> None:
        super().__init__(**keywords)
        self.text = text
        self.fd = fd

    @property
    def from_stdin(self) -> bool:
        """Whether it is input."""
        return self.fd == 0

    @property
    def from_stdout(self) -> bool:
        """Whether it is standard output."""
        return self.fd == 1

    @property
    def from_stderr(self) -> bool:
        """Whether it is standard error."""
        return self.fd == 2  # noqa: PLR2004  the number of the stream


class ProcessStdin(ProcessIO):
    """Input."""


class ProcessStdout(ProcessIO):
    """Standard output."""


class ProcessStderr(ProcessIO):
    """Standard error."""

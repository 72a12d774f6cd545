"""All events: what `launch.events` and `launch.events.process` show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.base import Event
from wsgen.launching.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from launch.actions import ExecuteLocal, TimerAction
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

    def wsgen_happen(self, context: LaunchContext) -> None:
        """End what runs, where something does."""
        if RECORD.live is not None:
            RECORD.live.shut_down(context, due_to_sigint=self.due_to_sigint)


class TimerEvent(Event):
    """The period of a timer action is over."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: TimerAction) -> None:
        self.timer_action = timer_action

    @property
    def wsgen_is_void(self) -> bool:  # type: ignore[override]  # of others it never changes
        """Whether the timer was canceled."""
        return self.timer_action.wsgen_is_canceled

    def wsgen_happen(self, context: LaunchContext) -> Any:
        """The actions of the timer."""
        return self.timer_action.handle(context)


class RunningProcessEvent(Event):
    """An event of one process; in a plan nothing runs, and the process number is 0."""

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


class ProcessExited(RunningProcessEvent):
    """A process ended; in a plan always well."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int = 0, **keywords: Any) -> None:
        super().__init__(**keywords)
        self.returncode = returncode

    def wsgen_happen(self, context: LaunchContext) -> None:
        """Its action is complete now."""
        self.action.announce_completion(context)


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


def matches_name(name: str) -> Callable[[ExecuteLocal], bool]:
    """Whether a process has this name."""
    return lambda action: action.process_name == name


def matches_pid(pid: int) -> Callable[[ExecuteLocal], bool]:
    """Whether a process has this number; in a plan none has one."""
    return lambda action: (action.process_details or {}).get("pid") == pid


class ProcessStarted(RunningProcessEvent):
    """A process was started."""

    name = "launch.events.process.ProcessStarted"


class ProcessTargetedEvent(Event):
    """Meant for the processes that the matcher accepts."""

    name = "launch.events.process.ProcessTargetedEvent"

    def __init__(self, *, process_matcher: Callable[[ExecuteLocal], bool]) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """End a process."""

    name = "launch.events.process.ShutdownProcess"

    def wsgen_happen(self, context: LaunchContext) -> None:
        """End it, where it runs."""
        del context
        if RECORD.live is not None:
            RECORD.live.end(self.process_matcher)


class SignalProcess(ProcessTargetedEvent):
    """Send a signal to a process."""

    name = "launch.events.process.SignalProcess"

    def __init__(
        self, *, signal_number: str | int, process_matcher: Callable[[ExecuteLocal], bool]
    ) -> None:
        super().__init__(process_matcher=process_matcher)
        self.signal = signal_number

    @property
    def signal_name(self) -> str:
        """The name of the signal."""
        import signal

        number = self.signal
        return number if isinstance(number, str) else signal.Signals(number).name

    def wsgen_happen(self, context: LaunchContext) -> None:
        """Send it, where something runs."""
        del context
        if RECORD.live is not None:
            RECORD.live.send_signal(self.signal, self.process_matcher)

"""A process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch._timeline import NEVER, PROCESS_TIME
from launch.action import Action
from launch.events.process.process_exited import ProcessExited
from launch.events.process.process_started import ProcessStarted
from wsgen.launch import known_packages
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity

# How a process is run, which decides nothing about what is run.
_RUNNING = {
    "cached_output",
    "emulate_tty",
    "log_cmd",
    "output",
    "output_format",
    "respawn",
    "respawn_delay",
    "respawn_max_retries",
    "sigkill_timeout",
    "sigterm_timeout",
}


class ExecuteLocal(Action):
    """Something that would be started; here it is noted, and its events happen."""

    def __init__(
        self,
        *,
        process_description: Any = None,
        shell: bool = False,
        on_exit: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**{name: value for name, value in kwargs.items() if name not in _RUNNING})
        self.process_description = process_description
        self.shell = shell
        self.process_name = ""
        self.__on_exit = on_exit
        self.__executed = False
        self.return_code: int | None = None

    def prepare(self, context: LaunchContext) -> dict[str, Any]:
        """What is to be noted of the process; see `wsgen.model.plan.Process`."""
        raise NotImplementedError

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Note the process, and let it start and, sooner or later, exit."""
        process = self.prepare(context)
        if self.__executed:
            raise RuntimeError("ExecuteLocal action executed more than once")
        self.__executed = True
        if self.__on_exit is not None:
            from launch.event_handlers.on_process_exit import OnProcessExit

            context.register_event_handler(
                OnProcessExit(target_action=self, on_exit=self.__on_exit)
            )
        file, line = self.wsgen_location or (None, None)
        RECORD.processes.append(
            {
                **process,
                "starts": context.timeline.cause,
                "start_time": round(context.timeline.now, 6),
                "file": file,
                "line": line,
            }
        )
        self._happen(context, process)
        return None

    def _happen(self, context: LaunchContext, process: dict[str, Any]) -> None:
        command: Sequence[str] = process["command"] or process["arguments"]
        program = process["executable"] or (command[0].rpartition("/")[2] if command else "")
        self.process_name = process["name"] or program
        details: dict[str, Any] = {
            "action": self,
            "name": self.process_name,
            "cmd": list(command),
        }
        started = ProcessStarted(**details)
        started.wsgen_cause = f"start of {self.process_name}"
        exited = ProcessExited(**details)
        exited.wsgen_cause = f"exit of {self.process_name}"
        context.timeline.post(started)
        lives_on = known_packages.runs_for_ever(program)
        context.timeline.post(exited, delay=NEVER if lives_on else PROCESS_TIME)

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when the process exits, not when it is started."""

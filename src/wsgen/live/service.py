"""The launch service: plays a launch file in the time that passes, and runs its processes.

It is the only part of a live run that knows the launch file. It waits in one place (`_wait`): for
output and ends of processes, for what its parent tells it, and for the next event of the launch.
"""

from __future__ import annotations

import logging
import os
import selectors
import shutil
import signal
import subprocess
import threading
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from wsgen.launch import commands, known_packages
from wsgen.launch.record import CommandOutcome
from wsgen.live.includes import entities_of
from wsgen.live.process import (
    PRINTED_A_SECOND,
    STDOUT,
    Output,
    RunningProcess,
    signal_number,
)
from wsgen.live.programs import PLUGINS, LeftOut, Ours, find_stand
from wsgen.live.request import INTERRUPT, TERMINATE
from wsgen.live.screen import LogFiles, Screen, ScreenHandler, make_log_folder
from wsgen.live.simulated_time import SimulatedTime
from wsgen.live.timeline import Happening, LiveTimeline
from wsgen.ros_environment.processes import module_command
from wsgen.simulation.live_scene import FOLDER_VARIABLE
from wsgen.values import dataclass

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.launch.live import ParameterGroup, Start
    from wsgen.live.request import ServiceRequest
    from wsgen.model.plan import Include, Process

COMMAND_SECONDS = 60.0  # wall-clock, for a Command() that is executed
MIDDLEWARE = "RMW_IMPLEMENTATION"  # of which the ROS of PyPI has one
_PATHS = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PATH", "PYTHONPATH")


@dataclass(frozen=True, kw_only=True)
class Resolved:
    """What is really started."""

    command: tuple[str, ...]
    shown: tuple[str, ...]  # as `ros2 launch` would have started it
    is_shell: bool = False
    is_ours: bool = False
    is_simulator: bool = False


class Service:
    """Plays one launch."""

    def __init__(self, request: ServiceRequest, control: socket.socket | None) -> None:
        self.request = request
        self.went_well = True  # as far as this, and not the launch file, is concerned
        self.is_terminated = False
        self._control = control
        self.screen = Screen(1, is_colored=request.is_colored)
        self.logs = LogFiles(make_log_folder(request.environment, os.getpid()))
        self._logger = logging.getLogger("launch")
        self._context: Any = None
        self._timeline: Any = None
        self._processes: dict[int, RunningProcess] = {}  # by pid
        self._coroutines = 0
        self._count = 0
        self._has_told_middleware = False
        self._left_out: set[str] = set()
        self._is_interrupted = False
        self._selector = selectors.DefaultSelector()
        self._paused: dict[int, RunningProcess] = {}  # descriptors that wait for their budget
        self._done: list[Callable[[], None]] = []  # by other threads
        self._parameter_files = 0
        self._simulator: RunningProcess | None = None
        self._has_simulator = False  # one has been started
        self._simulated_time = SimulatedTime(request.folder)
        self._is_awaited_missing = False
        self._wake, self._woken = os.pipe()
        os.set_blocking(self._wake, False)
        os.set_blocking(self._woken, False)

    def prepare(self) -> None:
        """Set up loggers and signals of this process."""
        logging.root.handlers[:] = [ScreenHandler(self.screen, self.logs)]
        logging.root.setLevel(logging.INFO)
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._take_signal)
        signal.set_wakeup_fd(self._woken, warn_on_full_buffer=False)
        self._selector.register(self._wake, selectors.EVENT_READ, None)
        if self._control is not None:
            self._control.setblocking(False)
            self._selector.register(self._control, selectors.EVENT_READ, None)
        if self.logs.folder is not None:
            self._logger.info("All log files can be found below %s", self.logs.folder)
        self._logger.info("Default logging verbosity is set to INFO")

    def close(self) -> None:
        """Write what is left to be written."""
        self.logs.close()
        self.screen.close()

    # What the shim asks for: `wsgen.launch.live.Live`.

    def make_timeline(self) -> LiveTimeline:
        """Make a timeline."""
        return LiveTimeline(self._wait, self._is_busy, self._simulated_now)

    def begin(self, context: Any) -> None:
        """Begin to play."""
        self._context = context
        self._timeline = context.timeline
        if self.request.seconds is not None and not self.request.awaits_simulator:
            reason = f"{self.request.seconds:g} s are over"
            # A simulator knows when the time of the simulation is over.
            end = Happening(
                partial(self._request_shutdown, reason),
                lambda: self._has_simulator or self._is_shut_down(),
            )
            self._timeline.post(end, delay=self.request.seconds)

    def start(self, start: Start) -> None:
        """Start a process after what is being done."""
        self._count += 1
        name = f"{self._name_of(start)}-{self._count}"
        start.action.process_description = SimpleNamespace(final_name=name)
        start.action.process_name = name
        resolved = self._resolve(start)
        if resolved is None:
            return  # it is another launch file
        if isinstance(resolved, LeftOut):
            self._leave_out_process(start, resolved)
            return
        run = Happening(partial(self._run, start, name, resolved, 0), self._is_shut_down)
        self._timeline.post(run)

    def write_parameters(self, group: ParameterGroup, node: str) -> str | None:
        """Write parameters into a file of the live folder."""
        if group.file is not None:
            if not group.file.is_file():
                self._logger.warning("Parameter file path is not a file: %s", group.file)
                return None
            return str(group.file)
        text = group.text
        if text is None:
            import yaml  # noqa: PLC0415  a launch file may have no parameters

            name = "/**" if group.is_for_all or not node else node
            content = {name: {"ros__parameters": dict(group.values)}}
            text = yaml.dump(content, default_flow_style=False)
        self._parameter_files += 1
        folder = self.request.folder / "parameters"
        folder.mkdir(exist_ok=True)
        path = folder / f"launch_params_{self._parameter_files}.yaml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    def load(self, process: Process) -> None:
        """Start the program that does the same as a node of a container; others are named."""
        plugin = process.executable or ""
        if plugin not in PLUGINS:
            why = "it is a C++ node for a container, and containers do not run here"
            self.leave_out(f"{plugin} of {process.package}", why)
            return
        from launch.launch_description import visit  # noqa: PLC0415  the shim's
        from launch_ros.actions import Node  # noqa: PLC0415  same

        package, executable = PLUGINS[plugin]
        node = Node(
            package=package,
            executable=executable,
            name=process.name,
            namespace=process.namespace or None,
            parameters=[dict(process.parameters)] if process.parameters else None,
            remappings=list(process.remappings),
            output="screen",
        )
        visit(node, self._context)

    def included(self, include: Include) -> Iterable[Any]:
        """What a launch file of Gazebo starts, that is not installed."""
        found = entities_of(include)
        if found is None:
            self.leave_out(f"{include.file.name} of {include.package}", "it is not installed")
            return []
        return found

    def end(self, matches: Callable[[Any], bool]) -> None:
        """End the processes whose actions match."""
        for process in list(self._processes.values()):
            if matches(process.start.action):
                self._end(process, is_told=True)

    def send_signal(self, number: str | int, matches: Callable[[Any], bool]) -> None:
        """Send a signal to the processes whose actions match."""
        for process in list(self._processes.values()):
            if matches(process.start.action):
                self._tell(process, signal_number(number))

    def shut_down(self, context: Any, *, due_to_sigint: bool) -> None:
        """End all processes, the last one first, when the handlers of this have been asked."""
        context.is_shutdown = True
        self._timeline.cancel(
            lambda event: (
                hasattr(event, "timer_action") and not event.timer_action.wsgen_outlives_shutdown
            )
        )

        def end_all() -> None:
            for process in reversed(list(self._processes.values())):
                self._end(process, is_told=not due_to_sigint)

        self._timeline.post(Happening(end_all))

    def run_coroutine(self, run: Callable[[], None], done: Callable[[], None]) -> None:
        """Call a function in a thread, and another one here afterwards."""
        self._coroutines += 1

        def finish() -> None:
            self._coroutines -= 1
            done()

        def work() -> None:
            try:
                run()
            except Exception as error:  # noqa: BLE001  foreign code
                text = f"exception in a coroutine of the launch file: {error}"
                self._logger.error("%s", text)  # noqa: TRY400  its traceback is not for users
                self.went_well = False
            self._done.append(lambda: self._timeline.post(Happening(finish)))
            os.write(self._woken, b"\0")

        threading.Thread(target=work, daemon=True).start()

    def run_command(self, words: Sequence[str]) -> CommandOutcome:
        """Run a command to its end."""
        try:
            done = subprocess.run(
                list(words),
                stdin=subprocess.DEVNULL,
                capture_output=True,
                check=False,
                env=self._environment_of(os.environ),
                timeout=COMMAND_SECONDS,
            )
        except OSError as error:
            return CommandOutcome("", stderr=f"{words[0]}: {error.strerror}", code=127)
        except subprocess.TimeoutExpired:
            return CommandOutcome("", stderr=f"no end within {COMMAND_SECONDS:g} s", code=124)
        return CommandOutcome(
            done.stdout.decode(errors="replace"),
            done.stderr.decode(errors="replace"),
            done.returncode,
        )

    def leave_out(self, what: str, why: str, *, is_missed: bool = True) -> None:
        """Name something that cannot run here, once."""
        if self.request.until_exit == what.partition(" of ")[0]:
            self._give_up()
        if what in self._left_out:
            return
        self._left_out.add(what)
        if self.request.is_strict and is_missed:
            self.went_well = False
            self._logger.error("%s", f"{what} cannot run: {why}")
            self._request_shutdown(f"{what} cannot run, and --strict is given")
        else:
            log = self._logger.warning if is_missed else self._logger.info
            log("%s", f"{what} is left out: {why}")

    # What is started.

    def _name_of(self, start: Start) -> str:
        if start.name is not None:
            return start.name
        command = (start.executable or "",) if _is_node(start) else (*start.words, "")
        return Path((*start.prefix, *command)[0]).name

    def _resolve(self, start: Start) -> Resolved | LeftOut | None:
        """What is started in the place of a process; None: the launch file is played here, too."""
        programs = commands.programs(start.process)
        if any(commands.nested_launch(program) for program in programs):
            return None
        if start.prefix and shutil.which(start.prefix[0]) is None:
            return LeftOut(why=f"{start.prefix[0]}, which is to run it, is not installed")
        only = programs[0] if len(programs) == 1 else None
        found = None if only is None else self._stand_of(only, start)
        if found is None:
            found = self._node(start) if _is_node(start) else self._command(start, only)
        return found

    def _stand_of(self, program: Process, start: Start) -> Resolved | LeftOut | None:
        """What stands in the place of a program, if anything does."""
        arguments = start.words if _is_node(start) else program.arguments
        is_sourced = self.request.is_sourced
        name = program.executable or ""
        found = find_stand(program.package, name, tuple(arguments), is_sourced=is_sourced)
        if found is None:
            return None
        if isinstance(found.stand, LeftOut):
            return found.stand
        return self._ours(found.stand, found.arguments, start)

    def _command(self, start: Start, only: Process | None) -> Resolved | LeftOut:
        """A command line, which may be that of one program."""
        if only is not None and only.package is not None:
            return self._ros2_run(only, start)
        shown = (*start.prefix, *start.words)
        command = shown if start.is_shell else self._with_interpreter(shown)
        return Resolved(command=command, shown=shown, is_shell=start.is_shell)

    def _node(self, start: Start) -> Resolved | LeftOut:
        """A program of a package, or one by its path."""
        path = start.path if start.package else start.executable
        if path is None:
            return LeftOut(why="it is not compiled")
        missing = self._why_missing(start.package, path)
        if missing is not None:
            return missing
        command = (*start.prefix, *self._with_interpreter((path, *start.words)))
        return Resolved(command=command, shown=(*start.prefix, path, *start.words))

    def _ours(self, stand: Ours, arguments: tuple[str, ...], start: Start) -> Resolved:
        # Its path on a machine with ROS is none of this one.
        name = [Path(start.path).name] if start.path else []
        shown = (*start.prefix, *name, *start.words)
        words = arguments if stand.keeps_arguments else _ros_arguments(arguments)
        ours = module_command(self.request.python, stand.module, *stand.arguments, *words)
        command = (*start.prefix, *ours)
        is_simulator = stand.module.endswith(".simulator")
        return Resolved(command=command, shown=shown, is_ours=True, is_simulator=is_simulator)

    def _ros2_run(self, program: Process, start: Start) -> Resolved | LeftOut:
        """What `ros2 run` starts; with a sourced ROS that itself."""
        if self.request.is_sourced:
            return Resolved(command=start.words, shown=start.words, is_shell=start.is_shell)
        package, executable = program.package or "", program.executable or ""
        variables = self._environment_of(os.environ)
        for prefix in variables.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
            path = str(Path(prefix, "lib", package, executable))
            if os.access(path, os.X_OK):
                command = self._with_interpreter((path, *program.arguments))
                return Resolved(command=command, shown=start.words)
        return LeftOut(why=f"no package {package} with this program is installed")

    def _why_missing(self, package: str | None, path: str) -> LeftOut | None:
        """Why a program cannot be started, if it cannot."""
        if package is None or Path(path).exists():
            return None
        if path.startswith(known_packages.prefix()):
            return LeftOut(
                why=f"the package {package} is not installed; with ROS 2 installed and sourced it "
                "runs"
            )
        return LeftOut(why=f"{package} is not built; run `wsgen build`")

    def _with_interpreter(self, command: tuple[str, ...]) -> tuple[str, ...]:
        """A command whose Python is the one that ROS's libraries are for."""
        if self.request.is_sourced or not command:
            return command
        program, *rest = command
        if program in {"python", "python3"}:
            return (str(self.request.python), *rest)
        if Path(program).is_absolute() and _is_python_script(program):
            return (str(self.request.python), *command)
        return command

    def _environment_of(self, wanted: Mapping[str, str]) -> dict[str, str]:
        """The environment of a process: what the launch file wants, and what ROS needs."""
        found = dict(wanted)
        before = self.request.environment
        for name, value in self.request.variables.items():
            own = found.get(name)
            if own is None or own == before.get(name):
                found[name] = value
            elif name == MIDDLEWARE and not self.request.is_sourced:
                found[name] = value
                if own != value:
                    self._tell_middleware(own, value)
            elif name in _PATHS:  # the launch file has added to it
                found[name] = os.pathsep.join([own, value])
        if not self.request.is_sourced:
            beside = str(self.request.python.parent)
            found["PATH"] = os.pathsep.join([beside, found.get("PATH", os.defpath)])
        found[FOLDER_VARIABLE] = str(self.request.folder)
        found.setdefault("PYTHONUNBUFFERED", "1")
        if self.request.is_colored:
            found.setdefault("RCUTILS_COLORIZED_OUTPUT", "1")
        if self.logs.folder is not None:
            found.setdefault("ROS_LOG_DIR", str(self.logs.folder))
        return found

    def _tell_middleware(self, wanted: str, used: str) -> None:
        if not self._has_told_middleware:
            self._has_told_middleware = True
            self._logger.info("%s", f"{wanted} is not on PyPI: nodes use {used}")

    def _leave_out_process(self, start: Start, left_out: LeftOut) -> None:
        """Name what is not started: who waits for its start goes on, not who waits for its end."""
        what = start.executable if _is_node(start) else " ".join(start.words[:1])
        of = f" of {start.package}" if start.package else ""
        self.leave_out(f"{what}{of}", left_out.why, is_missed=left_out.is_missed)
        if self._is_awaited(start, start.action.process_name):
            self._give_up()
        from launch._events import ProcessStarted  # noqa: PLC0415  the shim's, of this process

        started = ProcessStarted(
            action=start.action, name=start.action.process_name, cmd=list(start.words)
        )
        self._timeline.post(started)

    def _run(self, start: Start, name: str, resolved: Resolved, tries: int) -> None:
        """Start a process now."""
        logger = logging.getLogger(name)
        shown = " ".join(word for word in resolved.shown if word.strip())
        if start.logs_command:
            logger.info("%s", f"process details: cmd='{shown}', cwd='{start.folder}'")
        environment = self._environment_of(start.environment)
        if resolved.is_ours:
            environment["PYTHONSAFEPATH"] = "1"  # modules in the folder that they run in
        try:
            process = RunningProcess(
                resolved.command,
                start=start,
                name=name,
                environment=environment,
                screen=self.screen,
                logs=self.logs,
                is_shell=resolved.is_shell,
            )
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else str(error)
            text = f"exception occurred while executing process: {shown}: {reason}"
            logger.error("%s", text)  # noqa: TRY400  its traceback is not for users
            if self._is_awaited(start, name):
                self._give_up()
            return
        self._processes[process.pid] = process
        if resolved.is_simulator:
            self._simulator = process
            self._has_simulator = True
        for descriptor in process.outputs:
            self._selector.register(descriptor, selectors.EVENT_READ, process)
        logger.info("process started with pid [%d]", process.pid)
        action = start.action
        action.wsgen_cached = {one.stream: one.text for one in process.outputs.values()}
        action.process_details = {
            "action": action,
            "name": name,
            "cmd": list(resolved.shown),
            "cwd": start.folder,
            "env": dict(start.environment),
            "pid": process.pid,
        }
        process.respawn = partial(self._respawn, start, name, resolved, tries)
        process.shown = shown
        from launch._events import ProcessStarted  # noqa: PLC0415  the shim's, of this process

        self._timeline.post(ProcessStarted(**action.process_details))

    def _respawn(self, start: Start, name: str, resolved: Resolved, tries: int) -> None:
        """Start a process again, if that is wanted, after the delay."""
        if not start.respawns or self._is_shut_down():
            return
        if 0 <= start.respawn_max_retries <= tries:
            return
        run = Happening(partial(self._run, start, name, resolved, tries + 1), self._is_shut_down)
        self._timeline.post(run, delay=start.respawn_delay)

    # How processes end.

    def _end(self, process: RunningProcess, *, is_told: bool) -> None:
        """SIGINT now, later SIGTERM, then SIGKILL, while the process does not end."""
        if process.is_ending:
            return
        process.is_ending = True
        if is_told:
            self._tell(process, signal.SIGINT)
        else:  # the terminal has told it, as far as users know
            process.send_signal(signal.SIGINT)
        start = process.start
        first = start.sigterm_timeout
        second = first + start.sigkill_timeout
        steps = (
            (first, signal.SIGINT, signal.SIGTERM, f"{first:g}"),
            (second, signal.SIGTERM, signal.SIGKILL, str(second)),
        )
        for delay, before, then, words in steps:
            message = (
                f"process[{process.name}] failed to terminate '{words}' seconds after receiving "
                f"'{before.name}', escalating to '{then.name}'"
            )
            escalate = Happening(
                partial(self._escalate, process, then, message), partial(self._has_ended, process)
            )
            self._timeline.post(escalate, delay=delay)

    def _escalate(self, process: RunningProcess, number: int, message: str) -> None:
        logging.getLogger(process.name).error("%s", message)
        self._tell(process, number)

    def _tell(self, process: RunningProcess, number: int) -> None:
        name = signal.Signals(number).name
        text = f"sending signal '{name}' to process[{process.name}]"
        logging.getLogger(process.name).info("%s", text)
        process.send_signal(number)

    def _has_ended(self, process: RunningProcess) -> bool:
        return self._processes.get(process.pid) is not process

    def _reap(self) -> None:
        """Take notice of the processes that have ended."""
        for process in [one for one in self._processes.values() if one.child.poll() is not None]:
            self._finish(process)

    def _finish(self, process: RunningProcess) -> None:
        try:  # handlers of the launch file may fail
            process.drain(partial(self._take_output, process))
            for output in process.outputs.values():
                output.finish()
                self._tell_listeners(process, output, b"", is_last=True)
        finally:
            self._take_end(process)

    def _take_end(self, process: RunningProcess) -> None:
        for descriptor in process.outputs:
            self._paused.pop(descriptor, None)
            with suppress(KeyError):
                self._selector.unregister(descriptor)
        process.close()
        del self._processes[process.pid]
        code = process.child.returncode
        logger = logging.getLogger(process.name)
        if code == 0:
            logger.info("process has finished cleanly [pid %d]", process.pid)
        else:
            text = f"process has died [pid {process.pid}, exit code {code}, cmd '{process.shown}']."
            logger.error("%s", text)
        action = process.start.action
        action.return_code = code
        from launch._events import ProcessExited  # noqa: PLC0415  the shim's, of this process

        self._timeline.post(ProcessExited(returncode=code, **action.process_details))
        process.respawn()
        self._look_for_end(process, code)

    def _look_for_end(self, process: RunningProcess, code: int) -> None:
        """Shut down where the end of this process is the end of all."""
        if self._is_shut_down():
            return
        if process is self._simulator:
            self._simulator = None
            self.went_well &= code == 0
            self._request_shutdown("the simulation has ended")
        if self._is_awaited(process.start, process.name):
            self.went_well &= code == 0
            self._request_shutdown(f"{self.request.until_exit} has ended")

    def _is_awaited(self, start: Start, name: str) -> bool:
        """Whether the end of this process is to be that of all."""
        names = {name, name.rpartition("-")[0], start.executable, start.node}
        names.add((start.node or "").rpartition("/")[2])
        return self.request.until_exit is not None and self.request.until_exit in names

    def _give_up(self) -> None:
        """End all: what is waited for does not run, and never ends."""
        if self._is_awaited_missing:
            return
        self._is_awaited_missing = True
        self.went_well = False
        reason = f"{self.request.until_exit}, whose end --until-exit waits for, is not started"
        self._logger.error("%s", reason)
        self._request_shutdown(reason)

    def _is_shut_down(self) -> bool:
        return bool(self._context.is_shutdown)

    def _request_shutdown(self, reason: str, *, due_to_sigint: bool = False) -> None:
        from launch._events import Shutdown  # noqa: PLC0415  the shim's, of this process

        if not self._context.is_shutdown:
            self._timeline.post(Shutdown(reason=reason, due_to_sigint=due_to_sigint))

    # What is waited for.

    def _is_busy(self) -> bool:
        """Whether something runs; where nothing does, the launch is shut down once."""
        if self._processes or self._coroutines or self._done:
            return True
        if not self._is_shut_down():
            self._request_shutdown("idle")
            return True
        return False

    def _wait(self, seconds: float) -> None:
        """Wait for output, ends and commands, so long at most."""
        if self._paused:
            self._resume()
            seconds = min(seconds, 0.05)
        if self.screen.is_full:  # what processes print waits until it can be shown
            events = []
            time.sleep(min(seconds, 0.02))
            self._take_commands()
        else:
            if seconds > 0.0:
                self.logs.flush()
            events = self._selector.select(seconds)
        for key, _ in events:
            if key.data is not None:
                self._read(key.data, key.fd)
            elif key.fd == self._wake:
                with suppress(BlockingIOError):
                    os.read(self._wake, 1 << 12)
            else:
                self._take_commands()
        self._take_done()
        self._reap()

    def _take_done(self) -> None:
        while self._done:
            self._done.pop(0)()

    def _read(self, process: RunningProcess, descriptor: int) -> None:
        if descriptor not in process.outputs:
            return
        data = process.read(descriptor)
        if data is None:
            self._selector.unregister(descriptor)
            process.outputs[descriptor].finish()
            return
        self._take_output(process, descriptor, data)
        if process.budget.spend(data):
            logging.getLogger(process.name).warning(
                "%s",
                f"process prints more than {PRINTED_A_SECOND >> 10} kB a second; it has to wait, "
                "so that others are seen and heard",
            )
        if process.budget.is_spent:
            self._selector.unregister(descriptor)
            self._paused[descriptor] = process

    def _resume(self) -> None:
        for descriptor, process in list(self._paused.items()):
            if not process.budget.is_spent:
                del self._paused[descriptor]
                self._selector.register(descriptor, selectors.EVENT_READ, process)

    def _take_output(self, process: RunningProcess, descriptor: int, data: bytes) -> None:
        output: Output = process.outputs[descriptor]
        output.take(data)
        self._tell_listeners(process, output, data)

    def _tell_listeners(
        self, process: RunningProcess, output: Output, data: bytes, *, is_last: bool = False
    ) -> None:
        from launch._events import ProcessStderr, ProcessStdout  # noqa: PLC0415  the shim's

        kind = ProcessStdout if output.stream == STDOUT else ProcessStderr
        details = process.start.action.process_details
        if self._context.would_handle_event(kind(text=b"", fd=output.stream, **details)):
            heard = output.hear(data, is_last=is_last)
            if heard:
                self._timeline.post(kind(text=heard, fd=output.stream, **details))

    def _take_commands(self) -> None:
        if self._control is None:
            return
        try:
            words = self._control.recv(1 << 8)
        except BlockingIOError:
            return
        except OSError:
            words = b""
        if not words:  # the parent is gone; its guard ends this
            self._selector.unregister(self._control)
            self._control = None
        for word in (bytes([one]) for one in words):
            if word == INTERRUPT:
                self._interrupt()
            elif word == TERMINATE:
                self._terminate()

    def _take_signal(self, number: int, _frame: object) -> None:
        """As the same from the parent: somebody has sent the signal to this process."""
        happen = self._interrupt if number == signal.SIGINT else self._terminate
        self._done.append(happen)

    def _interrupt(self) -> None:
        message = "user interrupted with ctrl-c (SIGINT)"
        if self._is_interrupted:
            self._logger.warning("%s again, ignoring...", message)
            return
        self._is_interrupted = True
        self._logger.warning("%s", message)
        self._request_shutdown("ctrl-c (SIGINT)", due_to_sigint=True)

    def _terminate(self) -> None:
        self.is_terminated = True
        self._request_shutdown("SIGTERM")

    def _simulated_now(self) -> float | None:
        """The time of the simulation; that of the clock on the wall where nothing is simulated."""
        if not self.request.awaits_simulator and not self._has_simulator:
            return time.monotonic()
        return self._simulated_time.now()


def _is_node(start: Start) -> bool:
    """Whether it is a node, and not a command line."""
    return start.process.command is None


def _ros_arguments(words: Sequence[str]) -> tuple[str, ...]:
    """What follows --ros-args, which a program takes whatever else it is given."""
    if "--ros-args" not in words:
        return ()
    return tuple(words[list(words).index("--ros-args") :])


def _is_python_script(path: str) -> bool:
    """Whether the first line of a program says that Python runs it."""
    try:
        with open(path, "rb") as stream:  # noqa: PTH123  as launch has them, paths are texts
            first = stream.readline(256)
    except OSError:
        return False
    return first.startswith(b"#!") and b"python" in first

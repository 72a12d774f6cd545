"""The launch service: plays a launch file in the time that passes, and runs its processes.

It is the only part of a live run that knows the launch file. It waits in one place (`_wait`): for
output and ends of processes, for commands of its parent, and for the next event of the launch.
"""

from __future__ import annotations

import logging
import os
import selectors
import signal
import subprocess
import threading
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from wsgen.launching.record import CommandOutcome
from wsgen.live.asked_nodes import AskedNodes, LaunchNode, managed_by
from wsgen.live.journal import JournalWriter
from wsgen.live.process import (
    LOG_FOLDER,
    PRINTED_A_SECOND,
    STDOUT,
    LogFiles,
    Output,
    RunningProcess,
    Screen,
    ScreenHandler,
    log_base,
    make_log_folder,
    signal_number,
)
from wsgen.live.replacements import LeftOut, find_component
from wsgen.live.request import INTERRUPT, TERMINATE
from wsgen.live.resolve import Resolved, Resolver, entities_of, is_node
from wsgen.live.termination import LiveTimeline, ScheduledCall, Shutdown, SimulatedTime, Termination
from wsgen.ros.environment.environment import (
    ON_THIS_MACHINE,
    PROFILES,
    profiles_of,
    variables_of_simulator,
)
from wsgen.simulation.live_runs import ENDED_FILE
from wsgen.text.files import explain_write_error

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.launching.live import ParameterGroup, Start
    from wsgen.live.forked_nodes import ForkedNode, NodeServer
    from wsgen.live.request import ServiceRequest
    from wsgen.model.plan import Include, Process

# s of the wall clock, beside those of --for, in which what is behind events must be started.
SECONDS_TO_SIMULATE = 60.0
COMMAND_SECONDS = 60.0  # wall-clock, for a Command() that is executed


class Service:
    """Plays one launch."""

    def __init__(
        self,
        request: ServiceRequest,
        control: socket.socket | None,
        nodes: NodeServer | None = None,
    ) -> None:
        self.request = request
        self._nodes = nodes
        self.shutdown = Shutdown(request.until_exit)
        self._control = control
        self.screen = Screen(1, is_colored=request.is_colored)
        log_folder = make_log_folder(request.environment, os.getpid())
        self._keeps_logs = log_folder is not None
        if log_folder is None:  # nodes do not start without one
            log_folder = make_log_folder({LOG_FOLDER: str(request.folder / "log")}, os.getpid())
        self.logs = LogFiles(log_folder)
        self.journal = JournalWriter(request.folder) if request.is_watched else None
        self._logger = logging.getLogger("launch")
        self._context: Any = None
        self._timeline: Any = None
        self._processes: dict[int, RunningProcess] = {}  # by pid
        self._coroutines = 0
        self._count = 0
        self._left_out: set[str] = set()
        self._is_missing = False  # one of them is missed
        self._selector = selectors.DefaultSelector()
        self._paused: dict[int, RunningProcess] = {}  # descriptors that wait for their budget
        self._done: list[Callable[[], None]] = []  # by other threads
        self._parameter_files = 0
        self._simulator: RunningProcess | None = None
        self._has_simulator = False  # one has been started
        simulator_folder = request.joined or request.folder
        self._simulated_time = SimulatedTime(simulator_folder)
        self._resolver = Resolver(
            request, log_folder=self.logs.folder, simulator_folder=simulator_folder
        )
        self._termination = Termination(
            request, self.shutdown, self.journal, is_running=self._is_running
        )
        self._asked = AskedNodes(self._begin_launch_node, self._post, self.leave_out)
        self._wake, self._woken = os.pipe()
        os.set_blocking(self._wake, False)
        os.set_blocking(self._woken, False)

    def prepare(self) -> None:
        """Set up loggers and signals of this process, and what its processes find."""
        self._resolver.write_programs()
        logging.root.handlers[:] = [ScreenHandler(self.screen, self.logs, self.journal)]
        logging.root.setLevel(logging.INFO)
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._take_signal)
        signal.set_wakeup_fd(self._woken, warn_on_full_buffer=False)
        self._selector.register(self._wake, selectors.EVENT_READ, None)
        if self._control is not None:
            self._control.setblocking(False)
            self._selector.register(self._control, selectors.EVENT_READ, None)
        if self._nodes is not None and self._nodes.descriptor is not None:
            self._selector.register(self._nodes.descriptor, selectors.EVENT_READ, self._nodes)
        if not self._keeps_logs:
            os.environ.pop(LOG_FOLDER, None)  # that of the resolver is taken
            self._logger.warning(
                "Logs are not kept: their folder cannot be written, %s. Set %s to a folder "
                "of yours",
                os.fspath(log_base(self.request.environment)),
                LOG_FOLDER,
            )
        elif self.logs.folder is not None:
            self._logger.info("All log files can be found below %s", self.logs.folder)
        self._logger.info("Default logging verbosity is set to INFO")
        self._report_distro()
        self._report_beside()

    def _report_beside(self) -> None:
        """Say it where another run simulates in the same domain: nodes hear both."""
        if self.request.beside is not None:
            self._logger.warning(
                "another live run simulates in the same ROS_DOMAIN_ID: %s. Nodes hear /clock and "
                "the topics of both: end it, or set another ROS_DOMAIN_ID for one of them",
                self.request.beside,
            )

    def _report_distro(self) -> None:
        """Say it where nodes see another distribution than that of the ROS that runs."""
        given, runs = self.request.variables.get("ROS_DISTRO"), self.request.distro
        if given is not None and runs is not None and given != runs:
            self._logger.info(
                "ROS_DISTRO of the nodes is %s, which they were written for; the ROS that runs "
                "is %s",
                given,
                runs,
            )

    def close(self) -> None:
        """Write what is left to be written."""
        self._asked.close()
        if self.journal is not None:
            self.journal.close()
        self.logs.close()
        self.screen.close()

    # What the shim asks for: `wsgen.launching.live.Live`.

    def make_timeline(self) -> LiveTimeline:
        """Make a timeline."""
        return LiveTimeline(self._wait, self._is_busy, self._simulated_now)

    def begin(self, context: Any) -> None:
        """Begin to play."""
        self._context = context
        self._timeline = context.timeline
        self.shutdown.begin(context)
        self._termination.begin(context.timeline)
        if self.request.seconds is None:
            return
        # A simulator knows when the time of the simulation is over.
        is_void = lambda: self._has_simulator or self.shutdown.has_begun()  # noqa: E731
        if self.request.awaits_simulator:
            seconds = self.request.seconds + SECONDS_TO_SIMULATE
            end = ScheduledCall(partial(self._miss_simulator, seconds), is_void)
        else:
            seconds = self.request.seconds
            end = ScheduledCall(partial(self.shutdown.request, f"{seconds:g} s are over"), is_void)
        self._timeline.post(end, delay=seconds)

    def _miss_simulator(self, seconds: float) -> None:
        """End all: the time that --for means does not begin."""
        self.shutdown.fail(
            f"the simulator is not started within {seconds:g} s, and --for counts its time; "
            "what the launch file starts it after has not happened"
        )

    def start(self, start: Start) -> None:
        """Start a process after what is being done."""
        self._count += 1
        name = f"{self._name_of(start)}-{self._count}"
        start.action.process_description = SimpleNamespace(final_name=name)
        start.action.process_name = name
        self.shutdown.note_start(start, name)
        resolved = self._resolver.resolve(start)
        if resolved is None:  # it is another launch file, which is played here
            if self.shutdown.is_awaited(start, name):
                self.shutdown.give_up()
            return
        if isinstance(resolved, LeftOut):
            self._leave_out_process(start, resolved)
            return
        run = ScheduledCall(partial(self._run, start, name, resolved, 0), self.shutdown.has_begun)
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
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise explain_write_error(error, path) from None
        return str(path)

    def follow_states(self, action: Any) -> None:
        """Let the transitions of a lifecycle node be events."""
        self._asked.follow(action)

    def change_state(self, action: Any, transition: int) -> None:
        """Ask a lifecycle node for a transition."""
        self._asked.change_state(action, transition)

    def load(self, process: Process, extra_arguments: Mapping[str, Any]) -> None:
        """Have a container load a node, or start the program that does the same; name others."""
        plugin = process.executable or ""
        found = find_component(plugin, is_sourced=self.request.is_sourced)
        if found is None:
            self._asked.load(process, extra_arguments)
            return
        if isinstance(found, LeftOut):
            self.leave_out(f"{plugin} of {process.package}", found.why)
            return
        package, executable = found
        from launch.launch_description import visit  # noqa: PLC0415  the shim's
        from launch_ros.actions import Node  # noqa: PLC0415  same

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
                self._termination.end(process, is_notified=True)

    def send_signal(self, number: str | int, matches: Callable[[Any], bool]) -> None:
        """Send a signal to the processes whose actions match."""
        for process in list(self._processes.values()):
            if matches(process.start.action):
                self._termination.send_signal(process, signal_number(number))

    def shut_down(self, context: Any, *, due_to_sigint: bool) -> None:
        """End all processes, the last one first, when the handlers of this have been asked."""
        context.is_shutdown = True
        with suppress(OSError):  # the disk is full: somebody takes the launch for one that goes on
            (self.request.folder / ENDED_FILE).touch()
        self._asked.give_up()
        self._timeline.cancel(
            lambda event: (
                hasattr(event, "timer_action") and not event.timer_action.wsgen_outlives_shutdown
            )
        )

        def end_all() -> None:
            for process in reversed(list(self._processes.values())):
                self._termination.end(process, is_notified=not due_to_sigint)

        self._timeline.post(ScheduledCall(end_all))

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
                self.shutdown.went_well = False
            self._done.append(lambda: self._timeline.post(ScheduledCall(finish)))
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
                env=self._resolver.environment_of(os.environ),
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
            self.shutdown.give_up()
        if what in self._left_out:
            return
        self._left_out.add(what)
        self._is_missing |= is_missed
        if self.journal is not None and is_missed:
            self.journal.left_out(what, why)
        if self.request.is_strict and is_missed:
            reason = f"{what} cannot run, and --strict is given"
            self.shutdown.fail(f"{what} cannot run: {why}", reason)
        else:
            log = self._logger.warning if is_missed else self._logger.info
            log("%s", f"{what} is left out: {why}")

    # What is started.

    def _name_of(self, start: Start) -> str:
        if start.name is not None:
            return start.name
        command = (start.executable or "",) if is_node(start) else (*start.words, "")
        return Path((*start.prefix, *command)[0]).name

    def _leave_out_process(self, start: Start, left_out: LeftOut) -> None:
        """Name what is not started: who waits for its start goes on, not who waits for its end."""
        what = start.executable if is_node(start) else " ".join(start.words[:1])
        of = f" of {start.package}" if start.package else ""
        if left_out.is_mistake:  # ros2 launch does not go on then, either
            reason = f"{what}{of} cannot be started"
            self.shutdown.fail(f"{reason}: {left_out.why}", reason)
        else:
            why = f"{left_out.why}{managed_by(start.process)}"
            self.leave_out(f"{what}{of}", why, is_missed=left_out.is_missed)
        self._asked.note_not_started(start.action)
        if self.shutdown.is_awaited(start, start.action.process_name):
            self.shutdown.give_up()
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
        environment = self._environment_of(start.environment, is_ours=resolved.is_ours)
        if resolved.is_simulator:
            environment.update(variables_of_simulator(environment))
        try:
            process = RunningProcess(
                partial(self._begin_process, resolved, start.folder),
                start=start,
                name=name,
                environment=environment,
                screen=self.screen,
                logs=self.logs,
                journal=self.journal,
            )
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else str(error)
            text = f"exception occurred while executing process: {shown}: {reason}"
            logger.error("%s", text)  # noqa: TRY400  its traceback is not for users
            if self.shutdown.is_awaited(start, name):
                self.shutdown.give_up()
            return
        self.shutdown.note_run()
        process.shown = shown
        process.role = resolved.role
        self._processes[process.pid] = process
        if resolved.is_simulator:
            self._simulator = process
            self._has_simulator = True
        for descriptor in process.outputs:
            self._selector.register(descriptor, selectors.EVENT_READ, process)
        logger.info("process started with pid [%d]", process.pid)
        if self.journal is not None:
            node = start.node if start.node and "<" not in start.node else None  # it may have none
            self.journal.started(name, process.pid, node, resolved.role)
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
        from launch._events import ProcessStarted  # noqa: PLC0415  the shim's, of this process

        self._timeline.post(ProcessStarted(**action.process_details))

    def _begin_process(
        self,
        resolved: Resolved,
        folder: str | None,
        environment: Mapping[str, str],
        outputs: Sequence[int],
    ) -> subprocess.Popen[bytes] | ForkedNode:
        """Fork a program of wsgen, or start what it is."""
        if self._nodes is not None and resolved.forked is not None:
            forked = self._nodes.start(
                resolved.forked.module,
                resolved.forked.words,
                title=resolved.shown or resolved.command,
                environment=environment,
                folder=folder,
                outputs=outputs,
            )
            if forked is not None:
                return forked
        command = resolved.command
        return subprocess.Popen(
            " ".join(command) if resolved.is_shell else list(command),
            shell=resolved.is_shell,
            stdin=subprocess.PIPE,
            stdout=outputs[0],
            stderr=outputs[1],
            cwd=folder,
            env=dict(environment),
            start_new_session=True,
        )

    def _environment_of(self, wanted: Mapping[str, str], *, is_ours: bool) -> dict[str, str]:
        """That of a process, for which the launch file wants these variables."""
        environment = self._resolver.environment_of(wanted)
        if is_ours:
            environment["PYTHONSAFEPATH"] = "1"  # modules in the folder that they run in
        if environment.get(PROFILES) in ON_THIS_MACHINE:
            environment.update(profiles_of(environment))
        return environment

    def _begin_launch_node(self) -> LaunchNode:
        """Start what asks nodes, in the environment that the launch has now."""
        environment = self._environment_of(os.environ, is_ours=True)
        started = LaunchNode(
            partial(self._begin_process, self._resolver.launch_node(), None, environment)
        )
        self._selector.register(started.descriptor, selectors.EVENT_READ, self._asked)
        return started

    def _respawn(self, start: Start, name: str, resolved: Resolved, tries: int) -> None:
        """Start a process again, if that is wanted, after the delay."""
        if not start.respawns or self.shutdown.has_begun():
            return
        if 0 <= start.respawn_max_retries <= tries:
            return
        run = ScheduledCall(
            partial(self._run, start, name, resolved, tries + 1), self.shutdown.has_begun
        )
        self._timeline.post(run, delay=start.respawn_delay)

    # How processes end.

    def _reap(self) -> None:
        """Take notice of the processes that have ended."""
        for process in list(self._processes.values()):
            code = process.child.poll()
            if code is not None:
                self._finish(process, code)

    def _finish(self, process: RunningProcess, code: int) -> None:
        try:  # handlers of the launch file may fail
            process.drain(partial(self._take_output, process))
            for output in process.outputs.values():
                output.finish()
                self._report_listeners(process, output, b"", is_last=True)
        finally:
            self._take_end(process, code)

    def _take_end(self, process: RunningProcess, code: int) -> None:
        causes = process.causes()
        for descriptor in process.outputs:
            self._paused.pop(descriptor, None)
            with suppress(KeyError):
                self._selector.unregister(descriptor)
        process.close()
        del self._processes[process.pid]
        self._termination.take_end(process, code, causes)
        self._asked.note_ended(process.start.node)
        process.respawn()
        is_simulator = process is self._simulator
        if is_simulator:
            self._simulator = None
        self.shutdown.take_end(process.start, process.name, code, is_simulator=is_simulator)

    def _is_running(self, process: RunningProcess) -> bool:
        return self._processes.get(process.pid) is process

    # What is waited for.

    def _is_busy(self) -> bool:
        """Whether something runs; where nothing does, the launch is shut down once."""
        if self._processes or self._coroutines or self._done:
            return True
        if not self.shutdown.has_begun():
            self.shutdown.end_idle(is_left_out=self._is_missing)
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
            if key.data is not None and key.data is self._nodes:
                self._nodes.take()  # what has ended is reaped below
                if self._nodes.descriptor is None:
                    self._selector.unregister(key.fd)
            elif key.data is self._asked:
                self._take_asked(key.fd)
            elif key.data is not None:
                self._read(key.data, key.fd)
            elif key.fd == self._wake:
                with suppress(BlockingIOError):
                    os.read(self._wake, 1 << 12)
            else:
                self._take_commands()
        self._take_done()
        self._reap()
        self.shutdown.look_for_awaited(may_come=bool(self._coroutines))

    def _post(self, event: Any) -> None:
        self._timeline.post(event)

    def _take_asked(self, descriptor: int) -> None:
        if self._asked.node is not None and not self._asked.take():
            self._selector.unregister(descriptor)

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
        self._report_listeners(process, output, data)

    def _report_listeners(
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
                self.shutdown.interrupt()
            elif word == TERMINATE:
                self.shutdown.terminate()

    def _take_signal(self, number: int, _frame: object) -> None:
        """As the same from the parent: somebody has sent the signal to this process."""
        happen = self.shutdown.interrupt if number == signal.SIGINT else self.shutdown.terminate
        self._done.append(happen)

    def _simulated_now(self) -> float | None:
        """The time of the simulation; that of the clock on the wall where nothing is simulated."""
        request = self.request
        if not (request.awaits_simulator or request.joined or self._has_simulator):
            return time.monotonic()
        return self._simulated_time.now()

"""A live run whose time passes only while somebody has it pass: for tests, and for behaviors.

The launch file runs as `wsgen launch --run` has it, in a ROS domain of its own. The simulator
stands still between two calls of `LiveSession.advance`, and so does /clock; nodes go on, and answer
what has come.
"""

from __future__ import annotations

import contextlib
import json
import math
import select
import signal
import socket
import time
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Severity, has_errors
from wsgen.errors import RequestError, SessionDiedError
from wsgen.isolation import parent
from wsgen.isolation.result import read_tail
from wsgen.launching.launch_warnings import UNUSED_ARGUMENT
from wsgen.live.journal import SIMULATOR, SPAWNER, Journal
from wsgen.live.messenger import Messenger
from wsgen.live.prepare import (
    BrokenRunError,
    Prepared,
    RunRequest,
    environment_of_launch,
    prepared_request,
)
from wsgen.live.resources import Activity, CpuTimes, take_domain
from wsgen.live.service_child import start_service
from wsgen.model.transform import Pose, rotation_of_quaternion, rpy_of_rotation
from wsgen.ros.environment import open_ros
from wsgen.ros.environment.environment import DISCOVERY_VARIABLES
from wsgen.simulation.live_runs import short_name, socket_path
from wsgen.simulation.run import check_engines
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.journal import KnownProcess
    from wsgen.live.service_child import ServiceChild
    from wsgen.model.transform import Vector
    from wsgen.model.world import Spawn
    from wsgen.pipeline.requests import SelectedLaunchFile
    from wsgen.ros.environment import RosEnvironment

CHUNK = 0.05  # s, simulated, between two looks at the state

# Of the clock on the wall, for what hangs; on a busy machine all takes long.
SECONDS_TO_START = 120.0  # until the robots are in the world
SECONDS_TO_SPAWN = 30.0  # until a robot that nodes spawn is in the world, after those have come
SECONDS_TO_APPEAR = 60.0  # until nodes are found after that; then it goes on without them
SECONDS_WITHOUT_ANSWER = 60.0  # of the simulator, which answers five times a second
SECONDS_AT_REST = 30.0  # while no time passes: the simulation is paused
SECONDS_TO_END = 8.0  # after SIGINT; nodes get SIGTERM after five
LOOK_EVERY = 0.1

# Until nodes have been found, robots hardly move, and nobody waits for ever who waits for /clock.
SLOWLY = 0.01  # s, simulated, in each `LOOK_EVERY`
LOOKS_AT_READY = 3  # as often in a row all must be ready
SECONDS_TO_BE_NODE = 5.0  # after which a process that is idle is taken for none that would appear

# In the live folder: what the launch service, and the process with rclpy, print of themselves.
ERRORS_FILE = "errors"
LAST_LINES = 30  # that are shown of what was printed


class BrokenLaunchError(Exception):
    """The launch is not started; the diagnostics say why."""

    def __init__(self, launch_file: Path, diagnostics: tuple[Diagnostic, ...]) -> None:
        super().__init__(f"{launch_file.name} has errors; nothing is started.")
        self.diagnostics = diagnostics


@dataclass(frozen=True, kw_only=True)
class LiveState:
    """How the simulation was when it stopped last."""

    seconds: float = 0.0  # simulated
    is_paused: bool = False  # by the launch file or a node
    entities: tuple[str, ...] = ()  # in the world, also what stands still
    poses: Mapping[str, Pose] = field(default_factory=dict)  # by robot: root links in the world
    quaternions: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # x, y, z, w
    joints: Mapping[str, Mapping[str, float]] = field(default_factory=dict)  # rad or m

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> LiveState:
        """The state that the simulator has sent."""
        joints = answer["joints"]
        poses = {
            entity: _numbers(pose) for entity, pose in answer["poses"].items() if entity in joints
        }
        return cls(
            seconds=answer["seconds"],
            is_paused=answer["is_paused"],
            entities=tuple(answer["entities"]),
            poses={entity: _pose(pose) for entity, pose in poses.items()},
            quaternions={entity: pose[3:] for entity, pose in poses.items()},
            joints=joints,
        )


class LiveSession:
    """A launch file that runs.

    Attributes:
        state: How the simulation is.
        entities: What the launch file spawns: robots, and what stands still.
        assumed: Robots that a node is taken to spawn, if under another name.
        journal: What the processes have done and printed.
        reported: The diagnostics of the launch file, and of what is spawned while it runs.
        spawned: What processes have spawned so far that the launch file does not name.
        wall_seconds: Of the clock, that have passed since the start.
    """

    def __init__(  # noqa: PLR0913  what it is made of
        self,
        folder: Path,
        service: ServiceChild,
        messenger: Messenger,
        *,
        entities: tuple[str, ...],
        assumed: tuple[str, ...] = (),
        may_fail: Collection[str] = (),
        reported: Sequence[Diagnostic] = (),
        spawned: Sequence[Spawn] = (),
        observe: Callable[[LiveState], None] = lambda _state: None,
        has_simulator: bool = True,
    ) -> None:
        self.reported = reported
        self.spawned = spawned
        self.state = LiveState()
        self.entities = entities
        self.assumed = assumed
        self.journal = Journal(folder)
        self.messenger = messenger
        self._folder = folder
        self._service = service
        self._may_fail = frozenset(may_fail)
        self._observe = observe
        self._has_simulator = has_simulator  # else time is that of the clock
        self._simulator: socket.socket | None = None
        self._rest = b""
        self._unanswered = 0  # requests
        self._begun = time.monotonic()
        self._activity = Activity()
        self._last_report: str | None = None
        self._not_found: tuple[str, ...] = ()  # nodes that have not appeared

    @property
    def wall_seconds(self) -> float:
        """Of the clock, that have passed since the launch was started."""
        return time.monotonic() - self._begun

    @property
    def unused_arguments(self) -> tuple[str, ...]:
        """What is said of each launch argument that was given and has no effect."""
        return tuple(
            f"{found.message} {found.hint or ''}".rstrip()
            for found in self.reported
            if _is_unused_argument(found)
        )

    def start(self) -> None:
        """Wait until the robots are in the world, and the nodes of the launch file are there.

        Robots that a node is taken to spawn are awaited when the nodes are there: the modules of a
        node may take long to import. Simulated time passes meanwhile: as on the clock while robots
        are awaited, hardly any while nodes are.

        Raises:
            SessionDiedError: A process has failed, or robots do not come.
        """
        if self._has_simulator:
            self._connect()
        end = self._begun + SECONDS_TO_START
        while missing := [one for one in self.entities if one not in self.state.entities]:
            begun = time.monotonic()
            self._check_in_time(
                end,
                f"{_named(missing)} was not spawned within {SECONDS_TO_START:g} s.",
                "Look at what the spawner prints, and whether the launch file starts one.",
            )
            self.advance(CHUNK)
            time.sleep(max(0.0, begun + CHUNK - time.monotonic()))
        self._wait_for_nodes()
        if self.assumed and not self.state.poses:
            self.wait_for_robot()
            self._wait_for_nodes()  # that are started once the spawner has ended

    def wait_for_robot(self, entity: str = "") -> None:
        """Wait until a robot is in the world that the launch file need not name.

        Args:
            entity: The robot; empty: any.

        Raises:
            SessionDiedError: A process has failed, or the robot does not come.
        """
        end = time.monotonic() + SECONDS_TO_SPAWN
        with_name = f" with the name `{entity}`" if entity else ""
        while not (entity in self.state.poses if entity else self.state.poses):
            begun = time.monotonic()
            there = _named(self.state.entities)
            self._check_in_time(
                end,
                f"No robot{f' `{entity}`' if entity else ''} was spawned within "
                f"{SECONDS_TO_SPAWN:g} s: the launch file names none, and no node has spawned "
                f"{'it' if entity else 'one'}; in the world: {there or 'nothing'}.",
                "Start the spawner in this launch file, or have a node call /spawn_entity"
                f"{with_name}.",
            )
            self.advance(CHUNK)
            time.sleep(max(0.0, begun + CHUNK - time.monotonic()))

    def advance(self, seconds: float) -> float:
        """Let simulated time pass, and look at the state; gives how much has passed.

        It is less where the simulation is paused, or slow.

        Raises:
            SessionDiedError: A process has failed, the simulator has ended or hangs.
        """
        answer = self._ask({"do": "advance", "seconds": seconds})
        self._let_nodes_work()
        self.state = LiveState.of(answer)
        self._observe(self.state)
        self.check()
        return float(answer["passed"])

    def run_for(self, seconds: float, until: Callable[[], object] = lambda: False) -> object:
        """Let so much simulated time pass, or less: until something holds, which is given then.

        Raises:
            SessionDiedError: A process has failed, the simulator has ended or hangs; no time
                passes, or too little.
        """
        if not (math.isfinite(seconds) and seconds >= 0):
            raise RequestError(
                f"{seconds!r} is not a time in seconds.", hint="Give a number from 0."
            )
        left, moved = seconds, time.monotonic()
        end = time.monotonic() + 60.0 + 20.0 * seconds
        while not (holds := until()) and left > 1e-9:  # noqa: PLR2004  what sums are off
            passed = self.advance(min(left, CHUNK))
            left -= passed
            if passed > 0:
                moved = time.monotonic()
            if self.state.is_paused:
                self._check_in_time(
                    moved + SECONDS_AT_REST,
                    f"The simulation has been paused for {SECONDS_AT_REST:g} s.",
                    "Remove `pause` from the launch file, or have a node unpause it.",
                )
            self._check_in_time(
                end,
                f"{seconds:g} simulated seconds have not passed within {60 + 20 * seconds:.0f} s.",
                "Check the load of the machine; simulate less: fewer rays, smaller pictures.",
            )
        return holds

    def check(self) -> None:
        """Look whether all that should run does.

        Raises:
            SessionDiedError: A process has failed, or the launch has ended.
        """
        self.journal.read()
        for process in self.journal.failed:
            if not self._is_allowed(process):
                raise SessionDiedError(_failure(process), hint=_last_lines(process))
        if self._service.code is not None:
            raise self._ended()

    def report(self) -> str:
        """What is known of the run: robots, processes, the last lines that say most.

        When it is closed, it is what was known before its end.
        """
        if self._last_report is not None:
            return self._last_report
        self.journal.read()
        lines = [f"after {self.state.seconds:.2f} simulated s, {self.wall_seconds:.1f} s in all"]
        lines += [f"{entity}: {shown_pose(pose)}" for entity, pose in self.state.poses.items()]
        missing = [one for one in self.entities if one not in self.state.entities]
        lines += [f"not in the world: {_named(missing)}"] if missing else []
        lines += [
            f"{found.severity.value}[{found.code}] {found.name}: {found.message}"
            for found in tuple(self.reported)  # another thread adds those of what is spawned
            if found.severity is not Severity.INFO and not _is_unused_argument(found)
        ]
        lines += [f"{what} is left out: {why}" for what, why in self.journal.left_out.items()]
        lines += [
            f"{one.name} has ended ({_how(one.code)})"
            for one in self.journal.processes.values()
            if one.code is not None and one.role != SPAWNER
        ]
        if self._not_found:
            lines.append(f"nodes that have not appeared: {', '.join(self._not_found)}")
        printed = list(self.journal.important)[-LAST_LINES:]
        return "\n".join([*lines, *(["the last lines:", *printed] if printed else [])])

    def close(self) -> None:
        """End all processes, first as Ctrl-C does."""
        self._last_report = self.report()
        if self._simulator is not None:
            self._simulator.close()
        self.messenger.close()
        self._service.interrupt()
        self._service.wait_for(SECONDS_TO_END)

    # The simulator.

    def _let_nodes_work(self) -> None:
        """Wait until they have dealt with what has come."""
        running = [one for one in self.journal.processes.values() if one.code is None]
        simulator = next((one.pid for one in running if one.role == SIMULATOR), None)
        self._activity.wait_until_idle(
            (one.pid for one in running if one.role != SIMULATOR), with_others=simulator
        )

    def _connect(self) -> None:
        self._simulator = made = socket.socket(socket.AF_UNIX)
        end = self._begun + SECONDS_TO_START
        while True:
            self.check()
            try:
                with short_name(socket_path(self._folder)) as name:
                    made.connect(name)
            except (FileNotFoundError, ConnectionRefusedError):
                self._check_in_time(
                    end,
                    f"The simulator has not started within {SECONDS_TO_START:g} s.",
                    "Look whether the launch file starts Gazebo, and when.",
                )
                time.sleep(0.02)
            else:
                return

    def _ask(self, request: Mapping[str, object]) -> dict[str, Any]:
        """What the simulator answers; without one, the time of the clock."""
        if not self._has_simulator:
            passed = request.get("seconds", 0.0)
            time.sleep(passed if isinstance(passed, float) else 0.0)
            nothing: dict[str, Any] = {
                "is_paused": False,
                "entities": [],
                "poses": {},
                "joints": {},
            }
            return {**nothing, "seconds": self.wall_seconds, "passed": passed}
        assert self._simulator is not None  # noqa: S101  `start` has connected
        end = time.monotonic() + SECONDS_WITHOUT_ANSWER
        try:
            self._simulator.sendall(json.dumps(request).encode() + b"\n")
            self._unanswered += 1
            while not self._take_answers():
                if select.select([self._simulator], [], [], LOOK_EVERY)[0]:
                    data = self._simulator.recv(1 << 20)
                    if not data:
                        raise self._lost()
                    self._rest += data
                else:
                    self.check()
                    self._check_in_time(
                        end,
                        f"The simulator has not answered for {SECONDS_WITHOUT_ANSWER:g} s.",
                        "It hangs, or a step takes as long: look for meshes of many triangles.",
                    )
        except OSError:
            raise self._lost() from None
        line, _, self._rest = self._rest.partition(b"\n")
        self._unanswered = 0
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise SessionDiedError(answer["error"], hint=answer.get("hint", ""))
        return answer

    def _take_answers(self) -> bool:
        """Whether the last request is answered; what was answered before is left out.

        Who waited for that has got an error meanwhile, such as that a process has failed.
        """
        while self._unanswered > 1 and b"\n" in self._rest:
            _, _, self._rest = self._rest.partition(b"\n")
            self._unanswered -= 1
        return b"\n" in self._rest

    def _lost(self) -> SessionDiedError:
        """The error for a simulator that is gone: launch notices that a moment later."""
        end = time.monotonic() + SECONDS_TO_END
        while time.monotonic() < end:
            self.check()
            ended = [
                one
                for one in self.journal.processes.values()
                if one.role == SIMULATOR and one.code is not None
            ]
            if ended:
                return SessionDiedError(
                    f"The simulator has ended ({_how(ended[0].code)}).", hint=_last_lines(ended[0])
                )
            time.sleep(0.02)
        return SessionDiedError("The simulator has ended.", hint="Look at what it has printed.")

    def _ended(self) -> SessionDiedError:
        errors = [line for line in self.journal.lines if line.startswith("[launch] [ERROR]")]
        return SessionDiedError(
            f"The launch has ended ({_how(self._service.code)}).",
            hint="\n".join(errors[-LAST_LINES:])
            or read_tail(self._folder / ERRORS_FILE)
            or "Look at what was printed: a node may have asked for the end of all.",
        )

    def _check_in_time(self, end: float, message: str, hint: str) -> None:
        if time.monotonic() >= end:
            raise SessionDiedError(message, hint=hint)

    def _is_allowed(self, process: KnownProcess) -> bool:
        """Whether it may fail."""
        names = {process.name, process.name.rpartition("-")[0], process.node or ""}
        names.add((process.node or "").rpartition("/")[2])
        return not self._may_fail.isdisjoint(names)

    # Nodes.

    def _wait_for_nodes(self) -> None:
        """Until those of the launch file have been found by each other; not for ever."""
        end, looks = time.monotonic() + SECONDS_TO_APPEAR, 0
        times = CpuTimes()
        first_seen: dict[str, float] = {}
        while looks < LOOKS_AT_READY and time.monotonic() < end:
            time.sleep(LOOK_EVERY)
            self.advance(SLOWLY)
            nodes = set(self.messenger.ask("nodes")["nodes"])
            running = [one for one in self.journal.processes.values() if one.code is None]
            idle = times.idle(one.pid for one in running)
            self._not_found = tuple(
                one.name
                for one in running
                if one.role != SIMULATOR
                and (one.node is None or one.node not in nodes)
                and not self._is_no_node(one, idle, first_seen)
            )
            spawns = any(one.role == SPAWNER for one in running)
            looks = 0 if self._not_found or spawns else looks + 1

    @staticmethod
    def _is_no_node(one: KnownProcess, idle: set[int], first_seen: dict[str, float]) -> bool:
        """Whether a process that has not been found waits for something, and not for its modules.

        It has no name in the launch file, or is no node.
        """
        now = time.monotonic()
        age = now - first_seen.setdefault(one.name, now)
        return one.pid in idle and age >= (1.0 if one.node is None else SECONDS_TO_BE_NODE)


@contextlib.contextmanager
def open_live(  # noqa: PLR0913  what is run, and how
    selected: SelectedLaunchFile,
    request: RunRequest,
    *,
    may_fail: Collection[str] = (),
    opened: Callable[[LiveSession], None] = lambda _session: None,
    observe: Callable[[LiveState], None] = lambda _state: None,
    listener: Listener | None = None,
    open_environment: Callable[..., RosEnvironment] = open_ros,
) -> Iterator[LiveSession]:
    """Run a launch file in a ROS domain of its own; all that it starts ends with the context.

    Args:
        selected: The launch file.
        request: How its robots are read; the rate.
        may_fail: Nodes and programs that may end with an error.
        opened: Is given the session before it starts.
        observe: Is given each state, from the first one on.
        listener: Hears of the steps.
        open_environment: As `open_ros`.

    Raises:
        BrokenLaunchError: It cannot be started.
        NotFoundError: No ROS or no engine is here for it.
        NotReadableError: Something cannot be written or started.
        RequestError: The launch file starts no simulator.
        SessionDiedError: A process has failed, or robots do not come.
    """
    check_engines(request.prepared_as.engines)
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(parent.make_scratch())
        live_folder = folder / "live"
        live_folder.mkdir()
        domain = stack.enter_context(take_domain())
        environment = _environment(selected.overlay.environment, domain.number, folder)
        # What nodes print is in the journal, which does not grow without end. Two processes add to
        # this file.
        errors = stack.enter_context((live_folder / ERRORS_FILE).open("ab")).fileno()
        service = stack.enter_context(
            start_service(
                live_folder, environment, errors=errors, held=(domain.lock,), adopts=False
            )
        )
        reported: list[Diagnostic] = []
        hear = listener or (lambda _event: None)
        try:
            prepared, to_play = stack.enter_context(
                prepared_request(
                    selected,
                    replace(request, is_stepped=True),
                    service,
                    folder,
                    environment,
                    open_ros=lambda messages: open_environment(
                        environment, messages=messages, listener=hear
                    ),
                    show=reported.extend,
                    check=partial(_check_simulated, selected, request.rate, reported),
                    listener=listener,
                )
            )
        except BrokenRunError:
            raise BrokenLaunchError(selected.file, tuple(reported)) from None
        service.go(to_play)
        variables = {**environment, **to_play.variables}
        messenger = Messenger(to_play.python, variables, live_folder / ERRORS_FILE)
        session = LiveSession(
            live_folder,
            service,
            messenger,
            entities=prepared.entities,
            assumed=prepared.assumed,
            may_fail=may_fail,
            reported=reported,
            spawned=prepared.spawned,
            observe=observe,
            has_simulator=prepared.has_simulator,
        )
        stack.callback(session.close)
        opened(session)
        session.start()
        yield session


def _check_simulated(
    selected: SelectedLaunchFile,
    rate: float | None,
    reported: Sequence[Diagnostic],
    prepared: Prepared,
) -> None:
    """Refuse a launch file without a robot, because of errors, or without simulated time.

    As fast as the clock (a `rate` of 1), time passes without a simulator, too.

    Raises:
        BrokenRunError: What is reported says why.
        RequestError: It starts no simulator.
    """
    robots = (*prepared.entities, *prepared.assumed)
    if has_errors(reported) and prepared.has_spawner and not robots:
        raise BrokenRunError
    if not prepared.has_simulator and rate != 1:
        raise RequestError(
            f"{selected.file.name} starts no simulator, so that no simulated time passes.",
            hint="Start Gazebo in it, as the launch files of `wsgen new` do, or run one "
            "that includes both. For nodes alone, have time pass by the clock: rate=1.",
        )


def _environment(overlay: Mapping[str, str], domain: int, folder: Path) -> dict[str, str]:
    """That of the launch: in its domain, on this machine, with its own logs."""
    environment = environment_of_launch(overlay)
    for name in DISCOVERY_VARIABLES:  # two machines may have the same domain
        environment.pop(name, None)
    return {**environment, "ROS_DOMAIN_ID": str(domain), "ROS_LOG_DIR": str(folder / "log")}


def _is_unused_argument(found: Diagnostic) -> bool:
    """Whether it is about an argument that was given; those of an include have a line."""
    return found.code == UNUSED_ARGUMENT.code and found.line is None


def _numbers(pose: Iterable[float]) -> tuple[float, ...]:
    return tuple(map(float, pose))


def _pose(numbers: tuple[float, ...]) -> Pose:
    x, y, z, *xyzw = numbers
    rotation: Vector = rpy_of_rotation(rotation_of_quaternion((xyzw[0], xyzw[1], xyzw[2], xyzw[3])))
    return Pose((x, y, z), rotation)


def shown_pose(pose: Pose) -> str:
    """A pose in words."""
    x, y, z = (round(number, 3) + 0.0 for number in pose.xyz)
    roll, pitch, yaw = (round(number, 3) + 0.0 for number in pose.rpy)
    return f"x {x:g}, y {y:g}, z {z:g} m, roll {roll:g}, pitch {pitch:g}, yaw {yaw:g} rad"


def _named(entities: Iterable[str]) -> str:
    return ", ".join(f"`{one}`" for one in entities)


def _how(code: int | None) -> str:
    """How a process has ended, by its exit code, or minus the number of a signal."""
    code = code or 0
    if code >= 0:
        return f"exit code {code}"
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"signal {-code}"


def _failure(process: KnownProcess) -> str:
    what = "The simulator" if process.role == SIMULATOR else f"The process {process.name}"
    return f"{what} has failed ({_how(process.code)})."


def _last_lines(process: KnownProcess) -> str:
    """What it has printed: its traceback, if there is one, and what follows."""
    lines = list(process.lines)
    starts = [number for number, line in enumerate(lines) if line.startswith("Traceback")]
    shown = lines[starts[-1] :] if starts else lines
    return "\n".join(shown[-LAST_LINES:]) or "It has printed nothing."

"""Prepare a launch file for its run: ROS for its processes, its robots, what plays it.

What processes of the run spawn and the launch file does not name is prepared here, too: the
simulator sends the text of a description by a socket in the folder of the run, and gets what an
engine takes: read, checked, lumped, its meshes converted. This process does it, because it knows
the packages and has the pipeline loaded. A connection has one request, a `NewEntity` on a line,
and one answer.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import threading
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity, has_errors
from wsgen.errors import WsgenError
from wsgen.gazebo.systems import DEFAULT_SYSTEMS
from wsgen.isolation.codec import decode, encode
from wsgen.launching import known_packages
from wsgen.launching.evaluate import DISTRO_OF_LAUNCHES
from wsgen.live.needed_ros import (
    VARIABLE,
    distro_of_nodes,
    messages_of_devices,
    messages_of_packages,
    messages_of_plan,
    messages_of_robots_to_come,
    with_distro,
)
from wsgen.live.plan_checks import (
    absent_modules,
    cannot_run,
    check_awaited,
    nothing_started,
    starts_nothing,
)
from wsgen.live.recording import Recordings
from wsgen.live.request import NodeServerRequest, ServiceRequest
from wsgen.model.plan import LaunchRequest
from wsgen.model.world import Spawn
from wsgen.packages.workspace.layout import find_packages
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.changed_since_build import shares_of
from wsgen.pipeline.package_validation import Validation, may_come_later
from wsgen.pipeline.prepare import KnownRobots
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.pipeline.validate import selected_package, with_failures_before
from wsgen.ros.environment import paths_with_all_messages, variables_of_nodes
from wsgen.simulation.live_runs import (
    DOMAIN,
    SCENE_FILE,
    LiveScene,
    NewEntity,
    PreparedEntity,
    distro_of_run,
    find_live_folder,
    launched_in,
    preparer_path,
    short_name,
)
from wsgen.simulation.scene import Scene
from wsgen.text.files import write_file
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.service_child import ServiceChild
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import World
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest
    from wsgen.pipeline.started import Started
    from wsgen.ros.environment import RosEnvironment


@dataclass(frozen=True, kw_only=True)
class RunRequest:
    """How a launch file is run."""

    prepared_as: ValidateRequest  # how its robots are read: arguments, answers, engine
    rate: float | None = 1.0  # simulated seconds a second; None: as many as possible
    seconds: float | None = None  # simulated; None: without end
    until_exit: str | None = None  # the node or process whose end ends the run
    is_strict: bool = False  # what cannot run here is an error
    is_colored: bool = False
    recordings: Recordings = Recordings()
    is_stepped: bool = (
        False  # time passes only while somebody has it pass, see `wsgen.live.session`
    )


class BrokenRunError(Exception):
    """The launch is not started; what was shown says why."""


@contextlib.contextmanager
def prepared_request(  # noqa: PLR0913  what to prepare, where, how
    selected: SelectedLaunchFile,
    request: RunRequest,
    service: ServiceChild,
    folder: Path,
    environment: Mapping[str, str],
    *,
    open_ros: Callable[[Collection[str]], RosEnvironment],
    show: Callable[[Iterable[Diagnostic]], None],
    check: Callable[[Prepared], None],
    listener: Listener | None = None,
) -> Iterator[tuple[Prepared, ServiceRequest]]:
    """Prepare a launch, and what is spawned while it runs until the context ends.

    Args:
        selected: The launch file.
        request: How it is run.
        service: What will play it.
        folder: With `live`, the folder of the run; for files that engines read.
        environment: That the launch file is evaluated in.
        open_ros: As for `run_launch`.
        show: Is given what is reported.
        check: Raises an error where what is prepared cannot be run so.
        listener: Hears of the steps.

    Raises:
        BrokenRunError: Something keeps the launch from being started.
        RequestError: The launch file does not start what is waited for.
    """
    live_folder = folder / "live"
    answers = Answers(request.prepared_as.answers)
    prepared_as = replace(request.prepared_as, answers=answers, is_live=True)
    request = replace(request, prepared_as=prepared_as)
    prepared = prepare(
        selected,
        request,
        live_folder,
        folder,
        open_ros=open_ros,
        expect=partial(prepare_nodes, service, prepared_as.engines[0], environment),
        show=show,
        listener=listener,
    )
    check(prepared)
    with preparing_more(prepared, live_folder, folder, show):
        yield (
            prepared,
            service_request(
                selected,
                request,
                prepared,
                live_folder=live_folder,
                environment=environment,
                answers=answers.given,
            ),
        )


def prepare_nodes(
    service: ServiceChild, engine: str, environment: Mapping[str, str], ros: RosEnvironment
) -> None:
    """Have programs of wsgen prepared while all else is."""
    service.prepare_nodes(
        NodeServerRequest(
            python=ros.python,
            environment={**environment, **_with_shim(ros, environment)},
            paths=paths_with_all_messages(ros, environment),
            engine=engine,
        )
    )


def preparing_more(
    prepared: Prepared,
    live_folder: Path,
    folder: Path,
    show: Callable[[Iterable[Diagnostic]], None],
) -> AbstractContextManager[None]:
    """While it is open, what the launch file does not name is prepared when it is spawned."""
    if prepared.subject is None:
        return contextlib.nullcontext()
    preparer = Preparer(prepared.subject, folder, show, prepared.spawned.append)
    return serve(live_folder, preparer.prepare)


class Answers:
    """The answers to the questions of the launch file, which it asks of the launch service, too."""

    def __init__(self, answers: Callable[[], Sequence[str]]) -> None:
        self._answers = answers
        self.given: tuple[str, ...] = ()

    def __call__(self) -> Sequence[str]:
        """Those that the user gives, who is asked where they are needed."""
        self.given = tuple(self._answers())
        return self.given


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """What a live run needs, found."""

    ros: RosEnvironment
    has_simulator: bool  # the launch file starts one; robots may wait for that of another one
    packages: tuple[str, ...] = ()  # of the workspace
    sources: Mapping[str, Path] = field(default_factory=dict)  # of them, by their share folders
    entities: tuple[str, ...] = ()  # of the robots that it spawns, sooner or later
    # Of those that a node is taken to spawn, under a name that is not known.
    assumed: tuple[str, ...] = ()
    has_spawner: bool = False  # it names robots, if with mistakes; nodes may spawn others
    set_by_launch: Mapping[str, str] = field(default_factory=dict)  # where its nodes are found
    subject: Validation | None = None  # what has read the launch file, where something is simulated
    spawned: list[Spawn] = field(default_factory=list)  # while it runs, beside what it names


def prepare(  # noqa: PLR0913  what to prepare, where, how
    selected: SelectedLaunchFile,
    request: RunRequest,
    live_folder: Path,
    folder: Path,
    *,
    open_ros: Callable[[Collection[str]], RosEnvironment],
    expect: Callable[[RosEnvironment], None],
    show: Callable[[Iterable[Diagnostic]], None],
    listener: Listener | None = None,
) -> Prepared:
    """Write what the simulator of a live run reads.

    Args:
        selected: The launch file.
        request: How it is run.
        live_folder: For the scene.
        folder: For files that engines read; there until the run is over.
        open_ros: As for `run_launch`.
        expect: Is given what processes run with as soon as it is known but for messages.
        show: Is given what is reported.
        listener: Hears of the steps.

    Raises:
        BrokenRunError: Something keeps the launch from being started.
        RequestError: The launch file does not start what is waited for.
    """
    package = selected_package(
        selected.file, selected.package, selected.overlay, selected.workspace
    )
    packages = find_packages(selected.workspace) if selected.workspace else ()
    messages = messages_of_packages(packages)
    ros = open_ros(messages)  # without it, all else is in vain
    expect(ros)
    subject = Validation(
        package, selected.overlay, request.prepared_as, listener, known=KnownRobots()
    )
    world, robots = subject.read(folder)
    started = subject.started
    if started is None or not started.is_evaluated:
        found = subject.reported()
        if started is not None:
            found = with_failures_before(found, started.plan, selected.package, selected.overlay)
        show(found)
        raise BrokenRunError
    if request.until_exit is not None:
        check_awaited(request.until_exit, started.plan)
    more = _messages_of_robots(subject, started, robots, packages)
    if not more <= messages:
        ros = open_ros(messages | more)
    has_simulation = started.simulator is not None or bool(robots)
    found = tuple(_found(subject, started, has_simulation=has_simulation))
    absent = tuple(absent_modules(started.plan, [one.name for one in packages]))
    if starts_nothing(started.plan) and not has_simulation:
        absent = (nothing_started(started.plan, absent),)
    elif request.is_strict:
        found += tuple(cannot_run(started.plan, is_sourced=ros.is_sourced))
        absent = tuple(replace(one, severity=Severity.ERROR) for one in absent)
    found += tuple(subject.named(absent))
    found = with_failures_before(found, started.plan, selected.package, selected.overlay)
    show(found)
    is_stopped = request.is_strict and has_errors(found)
    is_broken = not all(robot.can_run for robot in robots)
    if is_broken or is_stopped or (has_simulation and world is None):
        raise BrokenRunError
    prepared = Prepared(
        ros=with_distro(ros, _distro(subject, packages, ros)),
        has_simulator=False,
        packages=tuple(one.name for one in packages),
        sources={
            str(share): source for share, source in shares_of(packages, selected.overlay).items()
        },
        # The nodes of a session are in its own domain.
        set_by_launch={} if request.is_stepped else _of_domain(started.plan),
    )
    if not has_simulation or world is None:
        return prepared
    live = _live_scene(subject, started, world, robots, request)
    write_file(live_folder / SCENE_FILE, encode(live))
    entities = [robot.entity for robot in robots if not robot.is_static_model]
    assumed = {spawn.entity for spawn in started.spawns if spawn.is_assumed}
    return replace(
        prepared,
        has_simulator=started.simulator is not None,
        entities=tuple(entity for entity in entities if entity not in assumed),
        assumed=tuple(entity for entity in entities if entity in assumed),
        has_spawner=started.has_spawner,
        subject=subject,
    )


def _messages_of_robots(
    subject: Validation,
    started: Started,
    robots: Iterable[PreparedRobot],
    packages: Iterable[PackageFolder],
) -> frozenset[str]:
    """The packages of messages that the plan and its robots need; also robots that may come."""
    devices = [one for one in (subject.world_devices, *(r.devices for r in robots)) if one]
    kind = _kind_of(subject)
    found = messages_of_plan(started.plan) | messages_of_devices(devices, kind)
    if started.simulator is not None and not started.has_spawner:
        found |= messages_of_robots_to_come(packages, kind)
    return found


def _found(subject: Validation, started: Started, *, has_simulation: bool) -> Iterable[Diagnostic]:
    """What is reported of the launch file, as far as it matters to the run."""
    if not has_simulation:
        return (*subject.named(started.plan.diagnostics), *subject.changed())
    found = subject.reported()
    if started.simulator is not None and not started.has_spawner:
        return map(may_come_later, found)
    return found


def _distro(subject: Validation, packages: Collection[PackageFolder], ros: RosEnvironment) -> str:
    """The distribution that nodes see."""
    source = subject.selected.source
    return distro_of_nodes(
        next((one.manifest for one in packages if one.path == source), None),
        simulator=subject.simulator_kind,
        installed=ros.distro,
        set_by_user=subject.overlay.environment.get(VARIABLE),
        recorded=read_settings(source)[0].distro if source else None,
        workspace=tuple(one.name for one in packages),
    )


def _live_scene(
    subject: Validation,
    started: Started,
    world: World,
    robots: Sequence[PreparedRobot],
    request: RunRequest,
) -> LiveScene:
    """What the simulator reads."""
    engine = request.prepared_as.engines[0]
    if request.prepared_as.physics is not None:
        world = replace(world, simulator=request.prepared_as.physics)
    return LiveScene(
        scene=Scene(world=world, robots=spawned_robots(robots), engine=engine),
        simulator=_kind_of(subject),
        world=world.name,
        devices={robot.entity: robot.devices for robot in robots if robot.devices is not None},
        world_devices=subject.world_devices,
        systems=_systems_of(subject),
        in_world=tuple(_in_world(robots, started.spawns)),
        descriptions={
            robot.entity: robot.description for robot in robots if robot.description is not None
        },
        rate=request.rate,
        seconds=request.seconds,
        logs_poses=request.recordings.video is not None,
        is_recorded=request.recordings.mcap is not None,
        is_stepped=request.is_stepped,
    )


def _systems_of(subject: Validation) -> tuple[str, ...] | None:
    """The systems that the world has; None where they are not known, as in Gazebo Classic."""
    systems = None if subject.started_world is None else subject.started_world.systems()
    if systems is None:
        return None
    # Whether the default ones are added is not known: they may be.
    return tuple(sorted(systems.loaded | set(DEFAULT_SYSTEMS if systems.may_merge else ())))


def _kind_of(subject: Validation) -> str:
    """The simulator that is stood in for."""
    return subject.simulator_kind or "gz"


def _of_domain(plan: LaunchPlan) -> dict[str, str]:
    """The domain of ROS that a launch file has its nodes in, if it chooses one."""
    return {DOMAIN: plan.environment[DOMAIN]} if DOMAIN in plan.environment else {}


def _in_world(robots: Iterable[PreparedRobot], spawns: Iterable[Spawn]) -> Iterator[str]:
    """What is in the world from the beginning: what no process spawns."""
    spawned = {spawn.entity for spawn in spawns if spawn.process is not None}
    return (robot.entity for robot in robots if robot.entity not in spawned)


def service_request(  # noqa: PLR0913  what is played, and with what
    selected: SelectedLaunchFile,
    request: RunRequest,
    prepared: Prepared,
    *,
    live_folder: Path,
    environment: Mapping[str, str],
    answers: tuple[str, ...],
) -> ServiceRequest:
    """What the launch service is given to play a launch file whose robots are prepared.

    `answers` are those to the questions of the launch file.
    """
    variables = _with_shim(prepared.ros, environment)
    nodes = {**environment, **variables, **prepared.set_by_launch}
    other = None if request.is_stepped else find_live_folder(nodes)
    joined = None if prepared.has_simulator else other
    if joined is not None and not prepared.ros.is_sourced:
        variables[VARIABLE] = distro_of_run(joined) or variables[VARIABLE]
    return ServiceRequest(
        launch=LaunchRequest(
            launch_file=selected.file.absolute(),
            package=selected.package,
            arguments=dict(request.prepared_as.launch_arguments),
            answers=answers,
        ),
        folder=live_folder,
        python=prepared.ros.python,
        is_sourced=prepared.ros.is_sourced,
        distro=prepared.ros.distro,
        environment=environment,
        variables=variables,
        packages=prepared.packages,
        sources=prepared.sources,
        beside=launched_in(other) if other is not None and prepared.has_simulator else None,
        joined=joined,
        is_colored=request.is_colored,
        is_strict=request.is_strict,
        until_exit=request.until_exit,
        seconds=request.seconds,
        is_watched=request.is_stepped,
        awaits_simulator=prepared.has_simulator,
    )


def environment_of_launch(overlay: Mapping[str, str]) -> dict[str, str]:
    """The environment that the launch file is evaluated in: that of its plan."""
    return {
        "ROS_DISTRO": DISTRO_OF_LAUNCHES,
        "ROS_VERSION": "2",
        "ROS_PYTHON_VERSION": "3",
        **overlay,
    }


def _with_shim(ros: RosEnvironment, environment: Mapping[str, str]) -> dict[str, str]:
    """What processes have in their environment beside what the launch has."""
    variables = variables_of_nodes(ros, environment)
    if ros.is_sourced:
        return variables
    stub = known_packages.prefix()
    prefixes = variables.get("AMENT_PREFIX_PATH", environment.get("AMENT_PREFIX_PATH", ""))
    kept = [one for one in prefixes.split(os.pathsep) if one and one != stub]
    variables["AMENT_PREFIX_PATH"] = os.pathsep.join(kept)
    return variables


SECONDS_TO_END = 2.0  # wall-clock, for what is being prepared when the run ends


class Preparer:
    """Prepares entities for the simulator of a run."""

    def __init__(
        self,
        subject: Validation,
        folder: Path,
        show: Callable[[Iterable[Diagnostic]], None],
        note: Callable[[Spawn], None] = lambda _spawn: None,
    ) -> None:
        """Prepare as `subject` has prepared the robots of the launch file.

        Args:
            subject: What has read the launch file.
            folder: For files that engines read; there until the run is over.
            show: Is given what is reported, each once, where anything is.
            note: Is given each entity that is asked for.
        """
        self._subject = subject
        self._folder = folder
        self._show = show
        self._note = note
        self._shown: set[Diagnostic] = set()
        self._count = 0

    def prepare(self, new: NewEntity) -> PreparedEntity:
        """Make of a description what an engine takes."""
        self._count += 1
        folder = self._folder / f"later{self._count}"
        folder.mkdir()
        spawn = Spawn(
            entity=new.entity,
            description=new.text,
            description_file=new.file,
            model_uri=new.model_uri,
            pose_in_world=new.pose_in_world,
        )
        self._note(spawn)
        prepared, found = self._subject.prepare_later(spawn, folder)
        reported = (one for one in found if one.severity is not Severity.INFO)
        fresh = [one for one in reported if one not in self._shown]
        self._shown.update(fresh)
        if fresh:
            self._show(fresh)
        if prepared is None or not prepared.can_run:
            errors = (one for one in found if one.severity is Severity.ERROR)
            error = next(errors, next(iter(found), None))
            if error is None:
                return PreparedEntity(
                    problem="The description has no robot.",
                    hint="Give the text of a URDF with <robot>, or of an SDF with <model>.",
                )
            return PreparedEntity(problem=error.message, hint=error.hint or "")
        (robot,) = spawned_robots((prepared,))
        return PreparedEntity(
            robot=robot, devices=prepared.devices, description=prepared.description
        )


@contextlib.contextmanager
def serve(folder: Path, prepare: Callable[[NewEntity], PreparedEntity]) -> Iterator[None]:
    """Answer requests in a thread, one after the other, until the context ends.

    Args:
        folder: Of the live run.
        prepare: What answers them.
    """
    listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with short_name(preparer_path(folder)) as name:
        listening.bind(name)
    listening.listen()
    thread = threading.Thread(target=_accept, args=(listening, prepare), daemon=True)
    thread.start()
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            listening.shutdown(socket.SHUT_RDWR)  # the thread waits for a connection
        thread.join(SECONDS_TO_END)
        listening.close()


def _accept(listening: socket.socket, prepare: Callable[[NewEntity], PreparedEntity]) -> None:
    while True:
        try:
            client, _ = listening.accept()
        except OSError:  # the run is over
            return
        with contextlib.suppress(OSError), client, client.makefile("rwb") as stream:
            line = stream.readline()
            if line:
                stream.write(encode(_answer(line, prepare)).encode() + b"\n")


def _answer(line: bytes, prepare: Callable[[NewEntity], PreparedEntity]) -> PreparedEntity:
    """What is prepared; an error is a problem of that entity, not of the run."""
    try:
        return prepare(decode(json.loads(line), NewEntity))
    except WsgenError as error:
        return PreparedEntity(problem=error.message, hint=error.hint)
    except Exception as error:  # noqa: BLE001  the simulator waits for an answer
        return PreparedEntity(
            problem=f"The description cannot be read: {type(error).__name__}: {error}.",
            hint="Report it with the description: it is a bug in wsgen.",
        )

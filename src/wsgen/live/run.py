"""Run a launch file: its robots prepared, its processes started and ended."""

from __future__ import annotations

import contextlib
import json
import os
import signal
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING

from wsgen.diagnostics import has_errors
from wsgen.errors import NotReadableError, RequestError, SessionDiedError
from wsgen.files import write_file
from wsgen.isolation import parent
from wsgen.isolation.codec import encode
from wsgen.launch import known_packages
from wsgen.launch.evaluate import DISTRO_OF_LAUNCHES
from wsgen.live.awaited import check_awaited
from wsgen.live.distribution import VARIABLE, distro_of_nodes, with_distro
from wsgen.live.failures import FailedProgram, read_failures
from wsgen.live.messages import (
    messages_of_devices,
    messages_of_packages,
    messages_of_plan,
    messages_of_robots_to_come,
)
from wsgen.live.missing_programs import cannot_run
from wsgen.live.preparer import Preparer, serve
from wsgen.live.program import DOMAIN, distro_of_run, find_live_folder, launched_in
from wsgen.live.recording import Recorded, Recordings, recording_topics
from wsgen.live.request import ENDED_FILE, STARTING_FILE, NodeServerRequest, ServiceRequest
from wsgen.live.service_child import start_service
from wsgen.live.video import draw_video
from wsgen.model.plan import LaunchRequest
from wsgen.pipeline.changed_since_build import shares_of
from wsgen.pipeline.package_validation import Validation, may_come_later
from wsgen.pipeline.prepare import KnownRobots
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.pipeline.validate import selected_package
from wsgen.ros_environment import paths_with_all_messages, variables_of_nodes
from wsgen.simulation.live_scene import SCENE_FILE, UNHEARD_FILE, LiveScene
from wsgen.simulation.pose_log import POSE_LOG_FILE
from wsgen.simulation.scene import Scene
from wsgen.values import dataclass
from wsgen.workspace.layout import find_packages
from wsgen.workspace.settings import read_settings

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.service_child import ServiceChild
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import Spawn
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest
    from wsgen.ros_environment import RosEnvironment


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


@dataclass(frozen=True, kw_only=True)
class RunEnd:
    """What is known of a run that has ended well."""

    has_simulator: bool
    # The topics that could have driven its robots, and their types, where nobody has sent anything
    # and no node would.
    unheard: Mapping[str, str] = field(default_factory=dict)
    failed: tuple[FailedProgram, ...] = ()  # that have died by themselves


class BrokenRunError(Exception):
    """The launch is not started; what was shown says why."""


def run_launch(  # noqa: PLR0913  what to run, and who hears of it
    selected: SelectedLaunchFile,
    request: RunRequest,
    open_ros: Callable[[Collection[str]], RosEnvironment],
    *,
    show: Callable[[Iterable[Diagnostic]], None],
    finish: Callable[[Callable[[Listener | None], Iterable[Diagnostic]]], None],
    beside: Callable[[Path], AbstractContextManager[object]] | None = None,
    recorded: Callable[[Recorded], None] = lambda _recorded: None,
    unfinished: Callable[[Path], None] = lambda _file: None,
    ended: Callable[[RunEnd], None] = lambda _end: None,
    listener: Listener | None = None,
) -> int:
    """Run a launch file until it ends, or the user ends it; gives the exit code of `ros2 launch`.

    The process of the launch service starts while the robots are prepared. `show` is given what is
    reported of them before the launch begins; with errors that keep a robot from being simulated,
    the launch is not started. `finish` is given what remains to be done when it has ended, which
    takes a listener and gives what is to be reported. `open_ros` gives what processes run with, for
    the packages of messages that it is given. `beside`, which shows the run of the folder that it
    is given, is open from before the launch begins until it has ended. `recorded` is told of each
    recording that is complete, `unfinished` of a video that a signal keeps from being drawn.
    `ended` is told of a run that has ended well, when all else is done.

    Raises:
        NotFoundError: The engine is not installed.
        NotReadableError: A file cannot be written, or a process not be started.
        RequestError: The launch file does not start what is waited for, or nothing to be shown.
        SessionDiedError: A signal has ended the launch service.
    """
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(parent.make_scratch())
        live_folder = folder / "live"
        live_folder.mkdir()
        environment = environment_of_launch(selected.overlay.environment)
        note_start(live_folder, selected, environment)
        service = stack.enter_context(start_service(live_folder, environment))
        try:
            prepared, to_play = stack.enter_context(
                prepared_request(
                    selected,
                    request,
                    service,
                    folder,
                    environment,
                    open_ros=open_ros,
                    show=show,
                    check=partial(_check_shown, selected, request, is_viewed=beside is not None),
                    listener=listener,
                )
            )
        except BrokenRunError:
            return 1
        with (
            drawing(request.recordings.video, live_folder, finish, recorded, unfinished),
            recording_topics(
                request.recordings.mcap,
                to_play.python,
                {**environment, **to_play.variables, **prepared.set_by_launch},
                use_sim_time=prepared.has_simulator,
                live_folder=live_folder if prepared.has_simulator else None,
                recorded=recorded,
            ),
            contextlib.nullcontext() if beside is None else beside(live_folder),
        ):
            service.go(to_play)
            code = service.wait()
            note_end(live_folder, request.recordings.video)
        if code == 0:
            ended(
                RunEnd(
                    has_simulator=prepared.has_simulator,
                    unheard=_unheard(live_folder),
                    failed=read_failures(live_folder),
                )
            )
    if code < 0:
        raise SessionDiedError(
            f"The launch service was ended by {signal.Signals(-code).name}.",
            hint="All that it had started was ended, too. Look for what ends processes: memory "
            "that runs out, or a kill of somebody.",
        )
    return code


def _unheard(live_folder: Path) -> dict[str, str]:
    """What the simulator has left, where no message of ROS has come to it."""
    try:
        text = (live_folder / UNHEARD_FILE).read_text(encoding="utf-8")
        return {str(topic): str(kind) for topic, kind in json.loads(text).items()}
    except (OSError, ValueError):
        return {}


def _check_shown(
    selected: SelectedLaunchFile, request: RunRequest, prepared: Prepared, *, is_viewed: bool
) -> None:
    """Refuse to show a run in which nothing is simulated."""
    if is_viewed and not prepared.has_simulator:
        raise RequestError(
            f"{selected.file.name} starts no simulator, and --view shows what is simulated.",
            hint="Remove --view, or give it to the launch that starts Gazebo.",
        )
    if request.recordings.video is not None and not prepared.has_simulator:
        raise RequestError(
            f"{selected.file.name} starts no simulator, and a video shows what is simulated.",
            hint="Record an .mcap of its topics, or a video of the launch that starts Gazebo.",
        )


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


def note_start(
    live_folder: Path, selected: SelectedLaunchFile, environment: Mapping[str, str]
) -> None:
    """Let others know of a launch that is prepared: its nodes are not there yet."""
    launched = f"{selected.package} {selected.file.name}" if selected.package else selected.file
    starting = {"domain": environment.get(DOMAIN) or "0", "launched": str(launched)}
    with contextlib.suppress(NotReadableError):  # what they are told is all that depends on it
        write_file(live_folder / STARTING_FILE, json.dumps(starting))


def note_end(live_folder: Path, video: Path | None) -> None:
    """Let others know that a launch has ended, while its folder is there for its video."""
    with contextlib.suppress(NotReadableError):  # what they are told is all that depends on it
        write_file(live_folder / ENDED_FILE, video.name if video is not None else "")


@contextlib.contextmanager
def drawing(
    video: Path | None,
    live_folder: Path,
    finish: Callable[[Callable[[Listener | None], Iterable[Diagnostic]]], None],
    recorded: Callable[[Recorded], None] = lambda _recorded: None,
    unfinished: Callable[[Path], None] = lambda _file: None,
) -> Iterator[None]:
    """Draw the video of a run that is over, also where its topics could not be recorded.

    `unfinished` is told of it when a signal ends wsgen before it is drawn.
    """
    if video is None:
        yield
        return
    done: list[Recorded] = []

    def tell(one: Recorded) -> None:
        done.append(one)
        recorded(one)

    try:
        try:
            yield
        except SessionDiedError:
            if (live_folder / POSE_LOG_FILE).exists():
                finish(partial(draw_video, live_folder, video, tell))
            raise
        finish(partial(draw_video, live_folder, video, tell))
    except (KeyboardInterrupt, SystemExit):  # what handlers of signals raise
        if not done:
            unfinished(video)
        raise


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
    workspace = selected.workspace
    packages = find_packages(workspace) if workspace else ()
    messages = messages_of_packages(packages)
    ros = open_ros(messages)  # without it, all else is in vain
    expect(ros)
    names = tuple(package.name for package in packages)
    shares = shares_of(packages, selected.overlay)
    sources = {str(share): source for share, source in shares.items()}
    subject = Validation(
        package, selected.overlay, request.prepared_as, listener, known=KnownRobots()
    )
    world, robots = subject.read(folder)
    started = subject.started
    if started is None or not started.is_evaluated:
        show(subject.reported())
        raise BrokenRunError
    if request.until_exit is not None:
        check_awaited(request.until_exit, started.plan)
    devices = [one for one in (subject.world_devices, *(r.devices for r in robots)) if one]
    more = messages_of_plan(started.plan)
    kind = subject.simulator_kind or "gz"
    more |= messages_of_devices(devices, kind)
    if started.simulator is not None and not started.has_spawner:
        more |= messages_of_robots_to_come(packages, kind)
    if not more <= messages:
        ros = open_ros(messages | more)
    has_simulation = started.simulator is not None or bool(robots)
    if has_simulation:
        found = subject.reported()
    else:
        found = (*subject.named(started.plan.diagnostics), *subject.changed())
    if started.simulator is not None and not started.has_spawner:
        found = tuple(map(may_come_later, found))
    if request.is_strict:
        found = (*found, *cannot_run(started.plan, is_sourced=ros.is_sourced))
    show((*found, *selected.overlay.not_built()))
    manifests = (one.manifest for one in packages if one.path == package.source)
    distro = distro_of_nodes(
        next(manifests, None),
        simulator=subject.simulator_kind,
        installed=ros.distro,
        set_by_user=selected.overlay.environment.get(VARIABLE),
        recorded=read_settings(package.source)[0].distro if package.source else None,
        workspace=names,
    )
    ros = with_distro(ros, distro)
    # The nodes of a session are in its own domain.
    set_by_launch = {} if request.is_stepped else _of_domain(started.plan)
    broken = [robot for robot in robots if not robot.can_run]
    is_stopped = request.is_strict and has_errors(found)
    if broken or is_stopped or (has_simulation and world is None):
        raise BrokenRunError
    if not has_simulation or world is None:
        return Prepared(
            ros=ros,
            has_simulator=False,
            packages=names,
            sources=sources,
            set_by_launch=set_by_launch,
        )
    scene = Scene(world=world, robots=spawned_robots(robots), engine=request.prepared_as.engines[0])
    live = LiveScene(
        scene=scene,
        simulator=kind,
        world=world.name,
        devices={robot.entity: robot.devices for robot in robots if robot.devices is not None},
        world_devices=subject.world_devices,
        in_world=tuple(_in_world(robots, started.spawns)),
        descriptions={
            robot.entity: robot.description for robot in robots if robot.description is not None
        },
        rate=request.rate,
        seconds=request.seconds,
        logs_poses=request.recordings.video is not None,
        is_stepped=request.is_stepped,
    )
    write_file(live_folder / SCENE_FILE, encode(live))
    entities = [robot.entity for robot in robots if not robot.is_static_model]
    assumed = {spawn.entity for spawn in started.spawns if spawn.is_assumed}
    return Prepared(
        ros=ros,
        has_simulator=started.simulator is not None,
        entities=tuple(entity for entity in entities if entity not in assumed),
        assumed=tuple(entity for entity in entities if entity in assumed),
        has_spawner=started.has_spawner,
        subject=subject,
        packages=names,
        sources=sources,
        set_by_launch=set_by_launch,
    )


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

"""Run a launch file: its robots prepared, its processes started and ended."""

from __future__ import annotations

import contextlib
import os
import signal
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from wsgen.diagnostics import has_errors
from wsgen.errors import SessionDiedError
from wsgen.files import write_file
from wsgen.isolation import parent
from wsgen.isolation.codec import encode
from wsgen.launch import known_packages
from wsgen.launch.evaluate import DISTRO_OF_LAUNCHES
from wsgen.live.awaited import check_awaited
from wsgen.live.film import draw_film
from wsgen.live.messages import messages_of_devices, messages_of_packages, messages_of_plan
from wsgen.live.missing_programs import cannot_run
from wsgen.live.recording import Recordings, recording_topics
from wsgen.live.request import ServiceRequest
from wsgen.live.service_child import start_service
from wsgen.model.plan import LaunchRequest
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.pipeline.validate import selected_package
from wsgen.ros_environment import variables_of_nodes
from wsgen.simulation.live_scene import SCENE_FILE, LiveScene
from wsgen.simulation.scene import Scene
from wsgen.values import dataclass
from wsgen.workspace.layout import find_packages

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.world import Spawn
    from wsgen.pipeline.plan_launch import SelectedLaunchFile
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.selection import ValidateRequest
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


class BrokenRunError(Exception):
    """The launch is not started; what was shown says why."""


def run_launch(  # noqa: PLR0913  what to run, and who hears of it
    selected: SelectedLaunchFile,
    request: RunRequest,
    open_ros: Callable[[Collection[str]], RosEnvironment],
    *,
    show: Callable[[Iterable[Diagnostic]], None],
    finish: Callable[[Callable[[Listener | None], Iterable[Diagnostic]]], None],
    listener: Listener | None = None,
) -> int:
    """Run a launch file until it ends, or the user ends it; gives the exit code of `ros2 launch`.

    The process of the launch service starts while the robots are prepared. `show` is given what is
    reported of them before the launch begins; with errors that keep a robot from being simulated,
    the launch is not started. `finish` is given what remains to be done when it has ended, which
    takes a listener and gives what is to be reported. `open_ros` gives what processes run with, for
    the packages of messages that it is given.

    Raises:
        NotFoundError: The engine is not installed.
        NotReadableError: A file cannot be written, or a process not be started.
        RequestError: The launch file does not start what is waited for.
        SessionDiedError: A signal has ended the launch service.
    """
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(parent.make_scratch())
        live_folder = folder / "live"
        live_folder.mkdir()
        answers = _Answers(request.prepared_as.answers)
        prepared_as = replace(request.prepared_as, answers=answers, is_live=True)
        request = replace(request, prepared_as=prepared_as)
        environment = _environment(selected.overlay.environment)
        service = stack.enter_context(start_service(live_folder, environment))
        try:
            prepared = prepare(
                selected,
                request,
                live_folder,
                folder,
                open_ros=open_ros,
                show=show,
                listener=listener,
            )
        except BrokenRunError:
            return 1
        ros = prepared.ros
        launch = LaunchRequest(
            launch_file=selected.file.absolute(),
            package=selected.package,
            arguments=dict(request.prepared_as.launch_arguments),
            answers=answers.given,
        )
        variables = _with_shim(ros, environment)
        with recording_topics(
            request.recordings.mcap,
            ros.python,
            environment | variables,
            use_sim_time=prepared.has_simulator,
        ):
            service.go(
                ServiceRequest(
                    launch=launch,
                    folder=live_folder,
                    python=ros.python,
                    is_sourced=ros.is_sourced,
                    environment=environment,
                    variables=variables,
                    is_colored=request.is_colored,
                    is_strict=request.is_strict,
                    until_exit=request.until_exit,
                    seconds=request.seconds,
                    awaits_simulator=prepared.has_simulator,
                )
            )
            code = service.wait()
        if request.recordings.video is not None:
            finish(partial(draw_film, live_folder, request.recordings.video))
    if code < 0:
        raise SessionDiedError(
            f"The launch service was ended by {signal.Signals(-code).name}.",
            hint="All that it had started was ended, too. Look for what ends processes: memory "
            "that runs out, or a kill of somebody.",
        )
    return code


class _Answers:
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


def prepare(  # noqa: PLR0913  what to prepare, where, how
    selected: SelectedLaunchFile,
    request: RunRequest,
    live_folder: Path,
    folder: Path,
    *,
    open_ros: Callable[[Collection[str]], RosEnvironment],
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
    messages = messages_of_packages(find_packages(workspace) if workspace else ())
    ros = open_ros(messages)  # without it, all else is in vain
    subject = Validation(package, selected.overlay, request.prepared_as, listener)
    world, robots = subject.read(folder)
    started = subject.started
    if started is None or not started.is_evaluated:
        show(subject.reported())
        raise BrokenRunError
    if request.until_exit is not None:
        check_awaited(request.until_exit, started.plan)
    devices = [one for one in (subject.world_devices, *(r.devices for r in robots)) if one]
    more = messages_of_plan(started.plan)
    more |= messages_of_devices(devices, subject.simulator_kind or "gz")
    if not more <= messages:
        ros = open_ros(messages | more)
    has_simulation = started.simulator is not None or bool(robots)
    found = subject.reported() if has_simulation else subject.named(started.plan.diagnostics)
    if request.is_strict:
        found = (*found, *cannot_run(started.plan, is_sourced=ros.is_sourced))
    show((*found, *selected.overlay.not_built()))
    broken = [robot for robot in robots if not robot.can_run]
    is_stopped = request.is_strict and has_errors(found)
    if broken or is_stopped or (has_simulation and world is None):
        raise BrokenRunError
    if not has_simulation or world is None:
        return Prepared(ros=ros, has_simulator=False)
    scene = Scene(world=world, robots=spawned_robots(robots), engine=request.prepared_as.engines[0])
    live = LiveScene(
        scene=scene,
        simulator=subject.simulator_kind or "gz",
        world=world.name,
        devices={robot.entity: robot.devices for robot in robots if robot.devices is not None},
        world_devices=subject.world_devices,
        in_world=tuple(_in_world(robots, started.spawns)),
        descriptions={
            robot.entity: robot.description for robot in robots if robot.description is not None
        },
        rate=request.rate,
        seconds=request.seconds,
        is_filmed=request.recordings.video is not None,
    )
    write_file(live_folder / SCENE_FILE, encode(live))
    return Prepared(ros=ros, has_simulator=started.simulator is not None)


def _in_world(robots: Iterable[PreparedRobot], spawns: Iterable[Spawn]) -> Iterator[str]:
    """What is in the world from the beginning: what no process spawns."""
    spawned = {spawn.entity for spawn in spawns if spawn.process is not None}
    return (robot.entity for robot in robots if robot.entity not in spawned)


def _environment(overlay: Mapping[str, str]) -> dict[str, str]:
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

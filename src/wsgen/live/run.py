"""Run a launch file: its robots prepared, its processes started and ended."""

from __future__ import annotations

import contextlib
import json
import signal
from dataclasses import field
from functools import partial
from typing import TYPE_CHECKING, Any

from wsgen.errors import NotReadableError, RequestError, SessionDiedError
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died
from wsgen.live.journal import FailedProgram, read_failures
from wsgen.live.prepare import BrokenRunError, environment_of_launch, prepared_request
from wsgen.live.recording import Recorded, recording_topics
from wsgen.live.service_child import start_service
from wsgen.pipeline.clock import DRAW, Clock
from wsgen.simulation.live_runs import (
    DOMAIN,
    ENDED_FILE,
    NO_ROBOT,
    POSE_LOG_FILE,
    SCENE_FILE,
    STARTING_FILE,
    UNHEARD_FILE,
    LiveScene,
)
from wsgen.simulation.run import no_video
from wsgen.simulation.scene import NotDrawn, Video
from wsgen.text.files import write_file
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
    from contextlib import AbstractContextManager
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.live.prepare import Prepared, RunRequest
    from wsgen.pipeline.requests import SelectedLaunchFile
    from wsgen.ros.environment import RosEnvironment


TASK = "wsgen.pipeline.tasks.video:draw"
PROGRESS_FILE = "drawn"  # in the live folder: how far the drawing is
LONGER = (
    "Have the run go on until a spawner has put a robot into the world: its output above says what "
    "it waits for."
)


def draw_video(
    folder: Path, file: Path, recorded: Callable[[Recorded], None], listener: Listener | None
) -> tuple[Diagnostic, ...]:
    """Draw what the simulator has left in the folder of its run; gives why it cannot be drawn.

    `recorded` is called when the file is complete. The files of the robots' meshes must be there.
    """
    if not (folder / POSE_LOG_FILE).exists():
        return (no_video(NO_ROBOT, LONGER),)
    clock = Clock("launch", listener)
    with (
        clock.step(DRAW, file.name, takes_long=True) as step,
        clock.watch(DRAW, folder / PROGRESS_FILE),
    ):
        drawn = _draw(folder, file)
        step.succeeded = isinstance(drawn, Video)
    if not isinstance(drawn, Video):
        return (no_video(drawn.problem, LONGER if drawn.problem == NO_ROBOT else None),)
    recorded(Recorded(file, drawn.frames / drawn.frames_per_second))
    return ()


def _draw(folder: Path, file: Path) -> Video | NotDrawn:
    live = decode(json.loads((folder / SCENE_FILE).read_text(encoding="utf-8")), LiveScene)
    outcome = parent.run(TASK, live.scene, folder / POSE_LOG_FILE, file, folder / PROGRESS_FILE)
    if isinstance(outcome, Died):
        return NotDrawn(problem=f"the renderer {outcome.reason} while it was {outcome.step}")
    kind: Any = Video | NotDrawn
    drawn: Video | NotDrawn = decode(outcome.value, kind)
    return drawn


@dataclass(frozen=True, kw_only=True)
class RunEnd:
    """What is known of a run that has ended well."""

    has_simulator: bool
    # The topics that could have driven its robots, and their types, where nobody has sent anything
    # and no node would.
    unheard: Mapping[str, str] = field(default_factory=dict)
    failed: tuple[FailedProgram, ...] = ()  # that have died by themselves


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
    is given, is open from before the launch begins until it has ended. `recorded` is called for
    each complete recording, `unfinished` for a video that a signal keeps from being drawn.
    `ended` is called for a run that has ended well, when all else is done.

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
            hint="Look for what ends processes: memory that runs out, or a `kill`. All that it "
            "had started was ended, too.",
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


def note_start(
    live_folder: Path, selected: SelectedLaunchFile, environment: Mapping[str, str]
) -> None:
    """Let others know of a launch that is prepared: its nodes are not there yet."""
    launched = f"{selected.package} {selected.file.name}" if selected.package else selected.file
    starting = {"domain": environment.get(DOMAIN) or "0", "launched": str(launched)}
    with contextlib.suppress(NotReadableError):  # only their messages depend on it
        write_file(live_folder / STARTING_FILE, json.dumps(starting))


def note_end(live_folder: Path, video: Path | None) -> None:
    """Let others know that a launch has ended, while its folder is there for its video."""
    with contextlib.suppress(NotReadableError):  # only their messages depend on it
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

    `unfinished` is called for it when a signal ends wsgen before it is drawn.
    """
    if video is None:
        yield
        return
    done: list[Recorded] = []

    def notify(one: Recorded) -> None:
        done.append(one)
        recorded(one)

    try:
        try:
            yield
        except SessionDiedError:
            if (live_folder / POSE_LOG_FILE).exists():
                finish(partial(draw_video, live_folder, video, notify))
            raise
        finish(partial(draw_video, live_folder, video, notify))
    except (KeyboardInterrupt, SystemExit):  # what handlers of signals raise
        if not done:
            unfinished(video)
        raise

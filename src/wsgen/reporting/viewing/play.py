"""Run a simulation in real time, as far as the engine is fast enough, and show it on a page."""

from __future__ import annotations

import time
from collections import deque
from functools import partial
from queue import Empty
from typing import TYPE_CHECKING, NamedTuple, Protocol

from wsgen.errors import RequestError, SessionDiedError
from wsgen.reporting.viewing.drawing import draw_one, draw_simulated
from wsgen.reporting.viewing.view import diagnostics_list, links_table, plain, summary

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from queue import SimpleQueue

    from wsgen.model.transform import Pose, Vector
    from wsgen.pipeline.describe import DescribedScene
    from wsgen.reporting.viewing.drawing import DrawnRobot
    from wsgen.simulation.session import Session


RATE_OVER = 1.0  # s, wall-clock


class Push(NamedTuple):
    """A force that is to act on a robot."""

    entity: str
    link: str | None  # of those that are simulated; None: the root
    force: Vector  # N, in the world
    seconds: float  # simulated


class Step(NamedTuple):
    """So much simulated time is to pass, and then no more."""

    seconds: float


class SetRunning(NamedTuple):
    """The simulation is to go on, or to wait."""

    is_running: bool


class Reset(NamedTuple):
    """Everything is to be as it was at the beginning."""


Command = Push | Step | SetRunning | Reset


class Speedometer:
    """Measures simulated time against that of a clock, over the last second."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._moments: deque[tuple[float, float]] = deque()  # wall-clock and simulated s

    def begin(self) -> None:
        """Forget what was: the simulation stood still, or has begun again."""
        self._moments.clear()

    def describe(self, simulated: float, *, is_running: bool) -> str:
        """Say in Markdown how far it is and how fast it runs now."""
        return f"**{simulated:.2f} s** simulated{self._rate(simulated, is_running=is_running)}"

    def _rate(self, simulated: float, *, is_running: bool) -> str:
        if not is_running:
            self.begin()
            return ", paused"
        now = self._clock()
        if self._moments and simulated < self._moments[-1][1]:  # it was reset
            self.begin()
        self._moments.append((now, simulated))
        while len(self._moments) > 2 and now - self._moments[1][0] > RATE_OVER:  # noqa: PLR2004
            self._moments.popleft()
        began, before = self._moments[0]
        if now - began < RATE_OVER / 2:
            return ""
        return f", {(simulated - before) / (now - began):.2g} × real time"


FRAME = 1 / 30  # s, wall-clock, between two looks at the robots
MOST_BEHIND = 0.1  # s of simulated time in a frame, however late it is


class SimulationViewer(Protocol):
    """What shows the simulation: `wsgen.reporting.viewing.simulation_page.SimulationPage`."""

    commands: SimpleQueue[Command]

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        """Show robots instead of those before."""

    def report(self, *, summary: str, diagnostics: str) -> None:
        """Show what is reported."""

    def put(self, poses: Mapping[str, Mapping[str, Pose]]) -> None:
        """Put links to poses in the world, by entity and link."""

    def notify(self, text: str, *, is_running: bool) -> None:
        """Show how far it is."""


class Player:
    """A simulation, and the page that shows it.

    `start` opens a session of the scene; it is called again after an engine has died.
    """

    def __init__(
        self,
        found: DescribedScene,
        start: Callable[[], Session],
        viewer: SimulationViewer,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._start = start
        self._viewer = viewer
        self._clock = clock
        self._session: Session | None = None
        self._is_running = True
        self._problem = ""
        self._speed = Speedometer(clock)
        self._owed = 0.0  # s of simulated time that are due, less than a step of the engine
        self._open()
        robots = list(self._drawn(found))
        robots.sort(key=lambda robot: robot.is_static_model)
        viewer.show(robots, links=links_table(robots))
        viewer.report(
            summary=summary(found.name, found.launch_file, robots, found.diagnostics),
            diagnostics=diagnostics_list(found.diagnostics),
        )
        self._show()

    def _drawn(self, found: DescribedScene) -> Iterator[DrawnRobot]:
        """What the engine has; the rest where it would be, as models of the world may be."""
        session, surfaces = self._session, found.collision_surfaces
        poses: Mapping[str, Pose] = {} if session is None else session.spawn_poses
        for one in found.robots:
            if one.entity in poses:
                yield draw_simulated(
                    one.lumped,
                    poses[one.entity],
                    surfaces,
                    entity=one.entity,
                    is_static_model=one.is_static_model,
                )
            else:
                drawn = draw_one(one, surfaces)
                if drawn is not None:
                    yield drawn

    def close(self) -> None:
        """End the engine."""
        if self._session is not None:
            self._session.close()

    def run(self, *, is_over: Callable[[], bool] = lambda: False) -> None:
        """Let time pass and do what the user wants, until it is over."""
        last = self._clock()
        while not is_over():
            self._obey()
            now = self._clock()
            if self._is_running:
                self._advance(min(now - last, MOST_BEHIND))
            last = now
            self._show()
            time.sleep(max(0.0, FRAME - (self._clock() - now)))

    def _obey(self) -> None:
        while True:
            try:
                command = self._viewer.commands.get_nowait()
            except Empty:
                return
            if isinstance(command, SetRunning):
                self._is_running = command.is_running and not self._problem
                self._speed.begin()
            elif isinstance(command, Reset):
                self._reset()
            elif isinstance(command, Step):
                self._is_running = False
                self._owed = 0.0
                self._guarded(partial(self._step, command.seconds))
            else:
                self._guarded(partial(self._push, command))

    def _open(self) -> None:
        try:
            self._session = self._start()
        except SessionDiedError as error:
            self._fail(error.message)

    def _reset(self) -> None:
        self._problem, self._is_running, self._owed = "", True, 0.0
        self._speed.begin()
        if self._session is not None:
            self._guarded(self._session.reset)
        if self._problem or self._session is None:  # the engine has died
            self.close()
            self._problem, self._is_running = "", True
            self._open()

    def _push(self, push: Push) -> None:
        if self._session is not None:
            self._session.push(push.entity, push.force, push.seconds, push.link)

    def _step(self, seconds: float) -> None:
        session = self._session
        if session is None:
            return
        session.step(seconds)
        lost = [state.entity for state in session.states.values() if not state.is_finite]
        if lost:
            self._fail(f"The state of {', '.join(lost)} is not finite any more.")

    def _advance(self, seconds: float) -> None:
        """Let simulated time pass, in whole steps of the engine."""
        session = self._session
        if session is None or self._problem:
            return
        self._owed += seconds
        steps = int(self._owed / session.step_seconds + 1e-6)
        if steps:
            self._owed -= steps * session.step_seconds
            self._guarded(partial(self._step, steps * session.step_seconds))

    def _guarded(self, call: Callable[[], object]) -> None:
        try:
            call()
        except (SessionDiedError, RequestError) as error:
            self._fail(error.message)

    def _fail(self, problem: str) -> None:
        self._problem, self._is_running = problem, False

    def _show(self) -> None:
        session = self._session
        if session is None:
            self._viewer.notify(f"**{plain(self._problem)}**", is_running=False)
            return
        self._viewer.put({entity: state.links for entity, state in session.states.items()})
        lines = [self._speed.describe(session.seconds, is_running=self._is_running)]
        lines += [
            f"{plain(entity)} is not simulated: {plain(refused.reason.rstrip('.'))}."
            for entity, refused in session.refused.items()
        ]
        if self._problem:
            lines.append(f"**{plain(self._problem)}** Reset to begin again.")
        self._viewer.notify("  \n".join(lines), is_running=self._is_running)

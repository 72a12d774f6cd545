"""Show a live run on a page while it goes on, as its simulator says.

The simulator is asked for each frame of the page, and seldom while no browser has it open. It
answers between two steps.
"""

from __future__ import annotations

import json
import threading
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from wsgen.descriptions.meshes.inspection import read_surfaces
from wsgen.isolation.codec import decode
from wsgen.model.robot import Mesh
from wsgen.model.transform import IDENTITY, Pose
from wsgen.reporting.viewing.drawing import draw_simulated
from wsgen.reporting.viewing.play import Reset, SetRunning, SimulationViewer, Speedometer, Step
from wsgen.reporting.viewing.view import diagnostics_list, links_table, plain, summary
from wsgen.simulation.live_runs import (
    SCENE_FILE,
    LiveScene,
    SimulatorClient,
    SimulatorEndedError,
    SimulatorError,
)
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.reporting.viewing.drawing import DrawnRobot
    from wsgen.reporting.viewing.play import Command


FRAME = 1 / 30  # s, wall-clock, between two looks at the robots
UNSEEN = 0.5  # s, the same while no browser has the page open
WAITING = "Waiting for the simulator of the launch file."


class Launched(NamedTuple):
    """What is run."""

    name: str  # of the package, or of the file
    launch_file: Path | None  # of a package
    diagnostics: Sequence[Diagnostic]  # that were reported before the run


class RunViewer(SimulationViewer, Protocol):
    """What shows the run: `wsgen.reporting.viewing.simulation_page.RunPage`."""

    @property
    def is_open(self) -> bool:
        """Whether somebody sees it."""

    def finish(self, text: str) -> None:
        """Show that no more will come."""

    def stop(self) -> None:
        """Show it no longer."""


class RunView:
    """A live run, and the page that shows it."""

    def __init__(
        self,
        folder: Path,
        viewer: RunViewer,
        launched: Launched,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Show that nothing is there yet.

        Args:
            folder: Of the live run; what is read of meshes is put there.
            viewer: The page.
            launched: What is run.
            clock: s, wall-clock.
        """
        self._folder = folder
        self._viewer = viewer
        self._launched = launched
        self._clock = clock
        self._speed = Speedometer(clock)
        self._client = SimulatorClient(folder)
        self._is_connected = False
        self._seconds: float | None = None  # simulated, at the last look
        self._problem: str | None = None  # why the last command was not done
        self._known: Mapping[str, SpawnedRobot] = {}  # by entity; all that may come
        self._surfaces: dict[str, str] = {}  # of meshes of collisions
        self._read: set[str] = set()  # their paths
        self._numbers: Mapping[str, int] = {}  # by entity; the simulator's, of those that are there
        self._drawn: dict[str, tuple[int, DrawnRobot]] = {}  # by entity; with that number
        self._report()
        viewer.notify(WAITING, is_running=True)

    def run(self, over: threading.Event) -> None:
        """Show the run until it is over."""
        try:
            while not over.is_set():
                began = self._clock()
                self._look()
                frame = FRAME if self._is_connected and self._viewer.is_open else UNSEEN
                if not self._is_connected and self._seconds is None:
                    frame = FRAME  # it is about to begin
                over.wait(max(0.0, frame - (self._clock() - began)))
        finally:
            self._client.close()
        when = "" if self._seconds is None else f" after {self._seconds:.2f} s of simulated time"
        self._viewer.finish(f"**The run has ended**{when}.")

    def interrupt(self) -> None:
        """Let the thread of `run` wait no longer for the simulator."""
        self._client.interrupt()

    def _look(self) -> None:
        if not self._is_connected:
            self._is_connected = self._client.connect(0.0)
            self._speed.begin()
        commands = list(self._commands())
        if not self._is_connected:
            return
        try:
            for command in commands:
                self._problem = self._notify(command)
            self._show(self._client.ask("poses"))
        except SimulatorEndedError as error:
            self._is_connected = False
            self._client.close()
            self._viewer.notify(f"**{error.message}**", is_running=False)

    def _commands(self) -> Iterator[Command]:
        commands = self._viewer.commands
        while not commands.empty():
            yield commands.get_nowait()

    def _notify(self, command: Command) -> str | None:
        """Have the simulator do what the user of the page wants; gives why it does not."""
        self._speed.begin()
        try:
            if isinstance(command, SetRunning):
                self._client.ask("unpause" if command.is_running else "pause")
            elif isinstance(command, Reset):
                self._client.ask("reset")
            elif isinstance(command, Step):
                self._client.ask("step", seconds=command.seconds)
        except SimulatorEndedError:
            raise
        except SimulatorError as error:
            return error.message
        return None

    def _show(self, answer: Mapping[str, Any]) -> None:
        poses = {
            entity: {link: Pose((x, y, z), (a, b, c)) for link, (x, y, z, a, b, c) in links.items()}
            for entity, links in answer["links"].items()
        }
        if self._numbers != answer["robots"]:
            self._numbers = answer["robots"]
            self._draw(poses, answer["others"])
        self._viewer.put(poses)
        self._seconds = float(answer["seconds"])
        is_running = not answer["is_paused"]
        lines = [self._speed.describe(self._seconds, is_running=is_running)]
        if all(robot.is_static_model for _, robot in self._drawn.values()):
            lines.append("No robot is in the world.")
        if self._problem is not None:
            lines.append(f"**{plain(self._problem)}**")
        self._viewer.notify("  \n".join(lines), is_running=is_running)

    def _draw(self, poses: Mapping[str, Mapping[str, Pose]], others: Collection[str]) -> None:
        """Draw the robots that have come, and no more those that have gone."""
        if not self._known:
            text = (self._folder / SCENE_FILE).read_text(encoding="utf-8")
            scene = decode(json.loads(text), LiveScene).scene
            self._known = {robot.entity: robot for robot in scene.robots}
        drawn = {}
        for entity, number in self._numbers.items():
            before = self._drawn.get(entity)
            if before is not None and before[0] == number:
                drawn[entity] = before
            else:
                spawned = self._ask_for(entity) if entity in others else self._known[entity]
                if spawned is not None:
                    drawn[entity] = number, self._draw_one(spawned, poses.get(entity, {}))
        self._drawn = drawn
        robots = sorted((one for _, one in drawn.values()), key=lambda one: one.is_static_model)
        self._viewer.show(robots, links=links_table(robots))
        self._report()

    def _ask_for(self, entity: str) -> SpawnedRobot | None:
        """A robot that came otherwise than the launch file says; None if it has gone."""
        try:
            text = self._client.ask("robot", entity=entity)["robot"]
        except SimulatorEndedError:
            raise
        except SimulatorError:
            return None
        return decode(json.loads(text), SpawnedRobot)

    def _draw_one(self, spawned: SpawnedRobot, poses: Mapping[str, Pose]) -> DrawnRobot:
        robot = spawned.robot
        meshes = {
            collision.geometry.path
            for link in robot.links
            for collision in link.collisions
            if isinstance(collision.geometry, Mesh) and collision.geometry.path is not None
        }
        if new := meshes - self._read:
            self._read |= new
            self._surfaces |= read_surfaces(sorted(new), folder=self._folder)
        return draw_simulated(
            robot,
            poses.get(robot.root, IDENTITY),
            self._surfaces,
            entity=spawned.entity,
            is_static_model=spawned.is_static_model,
        )

    def _report(self) -> None:
        name, launch_file, diagnostics = self._launched
        robots = [robot for _, robot in self._drawn.values()]
        self._viewer.report(
            summary=summary(name, launch_file, robots, diagnostics),
            diagnostics=diagnostics_list(diagnostics),
        )


@contextmanager
def showing_run(
    folder: Path,
    open_page: Callable[[], RunViewer],
    launched: Launched,
    report_failure: Callable[[BaseException], None],
) -> Iterator[None]:
    """Show the live run of a folder while the context is open, from when the page is.

    A thread does it, because signals are for who waits for the run. It calls `open_page`, and
    `report_failure` as soon as something ends it before the run is over; for the rest, see
    `RunView`.

    Raises:
        Exception: What has kept the page from being opened, or what has ended the thread, when the
            context closes.
    """
    over, is_decided = threading.Event(), threading.Event()
    views: list[RunView] = []
    failures: list[BaseException] = []

    def work() -> None:
        try:
            page = open_page()
            try:
                views.append(RunView(folder, page, launched))
                is_decided.set()
                views[0].run(over)
            finally:
                page.stop()
        except BaseException as error:  # noqa: BLE001  it is raised where the run is waited for
            failures.append(error)
            if is_decided.is_set():
                report_failure(error)
        finally:
            is_decided.set()

    thread = threading.Thread(target=work, name="view")
    thread.start()
    try:
        is_decided.wait()
        if views:
            yield
    finally:
        over.set()
        for view in views:
            view.interrupt()
        thread.join()
    for failure in failures:
        raise failure

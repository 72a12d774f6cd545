"""The view of a live run: what it asks of the simulator, and what it shows."""

from __future__ import annotations

import re
import threading
import time
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import (
    ROVER,
    install_messages,
    live_scene,
    rover_engine,
    simulation_of,
    still_at,
)
from reporting.viewing.robots import FakeViewer
from wsgen.isolation.codec import encode
from wsgen.model.robot import Box, Collision, Link, Robot
from wsgen.reporting.viewing import live_run
from wsgen.reporting.viewing.live_run import Launched, RunView, showing_run
from wsgen.reporting.viewing.play import Command, Push, Reset, SetRunning, Step
from wsgen.simulation.live_runs import SCENE_FILE, SimulatorError
from wsgen.simulation.scene import SpawnedRobot
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.simulation.engine import State

SECONDS = 300.0  # on a busy machine
WALL = Robot(
    name="wall",
    root="wall",
    links=(Link(name="wall", collisions=(Collision(geometry=Box(size=(0.1, 4.0, 1.0))),)),),
    is_static=True,
)


def _fail(error: BaseException) -> None:
    pytest.fail(f"the view has ended: {error}")


LAUNCHED = Launched("rover", Path("launch/drive.launch.py"), ())


class Viewer(FakeViewer):
    """A page that one browser has open, if the test says so."""

    def __init__(self) -> None:
        super().__init__()
        self.commands: SimpleQueue[Command] = SimpleQueue()
        self.is_open = True
        self.end = ""
        self.is_stopped = False

    def finish(self, text: str) -> None:
        self.end = text

    def stop(self) -> None:
        self.is_stopped = True

    @property
    def text(self) -> str:
        """What is shown, without the escapes of Markdown."""
        return re.sub(r"\\(.)", r"\1", self.reported[-1][0])

    @property
    def entities(self) -> list[str]:
        """What is shown."""
        return [robot.entity for robot in self.robots[-1]] if self.robots else []


class Run:
    """A simulator with a rover and a wall, and the view of it."""

    def __init__(self, folder: Path, motion: Callable[[float], State] | None = None) -> None:
        from wsgen.live.nodes.simulator.commands import CommandServer  # noqa: PLC0415

        live = live_scene()
        wall = SpawnedRobot(entity="wall", robot=WALL, is_static_model=True)
        live = replace(live, scene=replace(live.scene, robots=(*live.scene.robots, wall)))
        write_file(folder / SCENE_FILE, encode(live))
        self.folder = folder
        self.simulation, _ = simulation_of(live, rover_engine(motion))
        self.server: Any = CommandServer(folder, self.simulation)
        self.viewer = Viewer()
        self.took_time = 0
        self.over = threading.Event()
        self.view = RunView(folder, self.viewer, LAUNCHED)
        self.thread = threading.Thread(target=lambda: self.view.run(self.over))

    def until(self, holds: Callable[[], Any]) -> None:
        """Answer what is asked until something holds."""
        last = time.monotonic() + SECONDS
        while not holds():
            assert time.monotonic() < last, self.viewer.reported[-1]
            self.took_time += self.server.answer()
            time.sleep(0.001)

    def looks(self, count: int = 2) -> None:
        """Wait until it has looked so many more times."""
        wanted = len(self.viewer.poses) + count
        self.until(lambda: len(self.viewer.poses) >= wanted)

    def end(self) -> None:
        """End the simulator, and then the run."""
        self.server.close()
        self.over.set()
        self.view.interrupt()
        self.thread.join()


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Run]]:
    install_messages(monkeypatch)
    monkeypatch.setattr(live_run, "FRAME", 0.001)
    runs: list[Run] = []

    def make(*, is_started: bool = True, **options: Any) -> Run:
        runs.append(Run(tmp_path, **options))
        if is_started:
            runs[-1].thread.start()
        return runs[-1]

    yield make
    for run in runs:
        if run.thread.is_alive():
            run.end()


def test_robots_come_move_and_go(start: Callable[..., Run]) -> None:
    run = start(motion=lambda seconds: still_at(x=seconds)(seconds))
    viewer = run.viewer
    run.until(lambda: viewer.entities == ["wall"])
    run.looks()
    assert "No robot is in the world." in viewer.text
    wall = viewer.robots[-1][0]
    run.simulation.spawn("rover")
    run.until(lambda: viewer.entities == ["rover", "wall"])
    assert viewer.robots[-1][1] is wall  # it is not drawn again
    assert "rover: 7 kg, 3 links, 2 movable joints" in re.sub(r"\\(.)", r"\1", viewer.summary)
    assert "1 model of the world" in viewer.summary
    before = viewer.robots[-1][0]
    run.looks()
    run.simulation.advance(0.5)
    run.until(lambda: viewer.text.startswith("**0.50 s** simulated"))
    assert viewer.poses[-1]["rover"]["base"].xyz == pytest.approx((0.5, 0.0, 0.1))
    assert "wall" not in viewer.poses[-1]  # it stands still
    assert "No robot" not in viewer.text

    run.simulation.delete("rover")
    run.until(lambda: viewer.entities == ["wall"])
    run.simulation.spawn("rover")
    run.until(lambda: viewer.entities == ["rover", "wall"])
    assert viewer.robots[-1][0] is not before
    # Another one of that name, between two looks.
    before = viewer.robots[-1][0]
    run.simulation.delete("rover")
    run.simulation.spawn("rover")
    run.until(lambda: viewer.robots[-1][0] is not before)
    assert viewer.entities == ["rover", "wall"]
    assert run.took_time == 0  # a view lets the simulator make up for lost time


def test_a_robot_that_the_scene_does_not_have_is_asked_for(start: Callable[..., Run]) -> None:
    run = start()
    run.until(lambda: run.viewer.entities == ["wall"])
    other = SpawnedRobot(entity="guest", robot=replace(ROVER, name="guest"))
    run.simulation._known["guest"] = other
    run.simulation.spawn("guest")
    run.simulation.spawn("rover")
    run.until(lambda: run.viewer.entities == ["guest", "rover", "wall"])
    assert run.viewer.robots[-1][0].robot == other.robot


def test_a_robot_that_goes_while_it_is_asked_for_is_not_shown(tmp_path: Path) -> None:
    class Client:
        def ask(self, _do: str, **_values: Any) -> Any:
            raise SimulatorError("No entity `guest` is in the world.", "")

    view = RunView(tmp_path, Viewer(), LAUNCHED)
    view._client = Client()  # type: ignore[assignment]
    assert view._ask_for("guest") is None


def test_a_model_that_stands_still_is_shown_when_it_is_put_elsewhere(
    start: Callable[..., Run],
) -> None:
    from wsgen.model.transform import Pose  # noqa: PLC0415

    run = start()
    run.until(lambda: any("wall" in poses for poses in run.viewer.poses))
    run.looks()
    count = len(run.viewer.poses)
    run.simulation.host.robots["wall"].place(Pose((2.0, 0.0, 0.0)))
    run.looks(3)
    assert sum("wall" in poses for poses in run.viewer.poses[count:]) == 1


def test_the_buttons_do_what_the_services_of_the_simulator_do(start: Callable[..., Run]) -> None:
    run = start()
    run.simulation.spawn("rover")
    run.simulation.advance(2.0)
    control = run.simulation.control
    run.looks()
    assert run.viewer.reported[-1][1]
    run.viewer.commands.put(SetRunning(False))
    run.until(lambda: control.is_paused)
    run.until(lambda: run.viewer.text.endswith(", paused"))
    assert not run.viewer.reported[-1][1]
    run.viewer.commands.put(Step(0.25))
    run.until(lambda: control.seconds == pytest.approx(0.25))
    assert control.passes
    run.viewer.commands.put(SetRunning(True))
    run.until(lambda: not control.is_paused)
    run.viewer.commands.put(Reset())
    run.until(lambda: run.viewer.text.startswith("**0.00 s**"))
    run.viewer.commands.put(Push("rover", None, (1.0, 0.0, 0.0), 1.0))  # it has no such button
    run.viewer.commands.put(Step(1e9))
    run.until(lambda: "cannot step by 1000000000.0 s" in run.viewer.text)


def test_it_says_what_it_waits_for_and_how_it_ended(start: Callable[..., Run]) -> None:
    run = start(is_started=False)
    assert run.viewer.text == live_run.WAITING
    run.thread.start()
    run.simulation.advance(1.5)
    run.looks()
    run.server.close()
    run.view.interrupt()  # as the end of the simulator's process does
    run.until(lambda: "The simulator has ended." in run.viewer.text)
    run.end()
    assert run.viewer.end == "**The run has ended** after 1.50 s of simulated time."


def test_a_run_that_ends_before_its_simulator_begins(tmp_path: Path) -> None:
    viewer = Viewer()
    with showing_run(tmp_path, lambda: viewer, LAUNCHED, _fail):
        pass
    assert viewer.end == "**The run has ended**."
    assert viewer.is_stopped


def test_a_simulator_that_does_not_answer_keeps_nobody_waiting(start: Callable[..., Run]) -> None:
    run = start()
    viewer = Viewer()
    with showing_run(run.folder, lambda: viewer, LAUNCHED, _fail):
        time.sleep(0.05)  # nobody answers it
    assert viewer.is_stopped


def test_it_looks_seldom_while_nobody_does(
    start: Callable[..., Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_run, "UNSEEN", 30.0)
    run = start(is_started=False)
    run.viewer.is_open = False
    run.thread.start()
    run.looks(1)
    end = time.monotonic() + 0.1
    while time.monotonic() < end:
        run.server.answer()
    assert len(run.viewer.poses) == 1


def test_without_a_page_nothing_is_run(tmp_path: Path) -> None:
    def fail() -> Viewer:
        raise ValueError("no page")

    reported: list[BaseException] = []
    with (
        pytest.raises(ValueError, match="no page"),
        showing_run(tmp_path, fail, LAUNCHED, reported.append),
    ):
        pytest.fail("it is run")
    assert not reported


def test_what_ends_the_view_is_reported_at_once_and_the_run_goes_on(tmp_path: Path) -> None:
    viewer = Viewer()
    del viewer.commands  # which it looks at
    reported = threading.Event()
    ended: list[str] = []

    def run() -> None:
        with showing_run(tmp_path, lambda: viewer, LAUNCHED, lambda _: reported.set()):
            assert reported.wait(SECONDS)
            ended.append("by itself")

    with pytest.raises(AttributeError, match="commands"):
        run()
    assert ended == ["by itself"]
    assert viewer.is_stopped

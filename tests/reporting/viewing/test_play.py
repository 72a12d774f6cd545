"""The player of a simulation: real time, pause, step, reset, a push, and an engine that dies."""

from __future__ import annotations

import re
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import pytest

from reporting.viewing.robots import FakeViewer
from wsgen.errors import RequestError, SessionDiedError
from wsgen.model.robot import Box, Collision, Inertial, Link, Robot
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.pipeline.describe import DescribedScene
from wsgen.pipeline.prepare import PreparedRobot
from wsgen.reporting.viewing.play import Command, Player, Push, Reset, SetRunning, Step
from wsgen.simulation.engine import Refused
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.simulation.session import Session

if TYPE_CHECKING:
    from collections.abc import Mapping

BOX = Robot(
    name="box",
    root="base",
    links=(
        Link(
            name="base",
            inertial=Inertial(mass=1.0, inertia=(0.01, 0.0, 0.0, 0.01, 0.0, 0.01)),
            collisions=(Collision(geometry=Box(size=(0.2, 0.2, 0.2))),),
        ),
    ),
)
FOUND = DescribedScene(
    name="box",
    launch_file=None,
    world=World(name="w", has_ground_plane=True),
    robots=(PreparedRobot(entity="box", written=BOX, lumped=BOX),),
    diagnostics=(),
    collision_surfaces={},
    files=(),
)


class State:
    def __init__(self, x: float, *, is_finite: bool = True) -> None:
        self.entity, self.is_finite = "box", is_finite
        self.links: Mapping[str, Pose] = {"base": Pose((x, 0.0, 0.0))}


class FakeSession:
    """A box that moves by a meter a second, or that breaks."""

    step_seconds = 0.001

    def __init__(self, *, dies: bool = False) -> None:
        self.spawn_poses = {"box": Pose((0.0, 0.0, 1.0))}
        self.refused: Mapping[str, Any] = {}
        self.dies = dies
        self.pushes: list[Any] = []
        self.is_closed = False
        self.explodes_at = 1e9
        self.reset()

    def reset(self) -> None:
        if self.dies:
            raise SessionDiedError("The engine died.", hint="")
        self.seconds = 0.0
        self.states = {"box": State(0.0)}

    def step(self, seconds: float) -> None:
        if self.dies:
            raise SessionDiedError("The engine died.", hint="")
        self.seconds += seconds
        self.states = {"box": State(self.seconds, is_finite=self.seconds < self.explodes_at)}

    def push(self, *arguments: Any) -> None:
        if arguments[0] == "nobody":
            raise RequestError("The engine simulates no robot `nobody`.", hint="")
        self.pushes.append(arguments)

    def close(self) -> None:
        self.is_closed = True


class Viewer(FakeViewer):
    def __init__(self) -> None:
        super().__init__()
        self.commands: SimpleQueue[Command] = SimpleQueue()


class Game:
    """A player with a session and a clock that the test has in its hands."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 0.0
        monkeypatch.setattr("wsgen.reporting.viewing.play.time.sleep", self.sleep)
        self.viewer = Viewer()
        self.sessions: list[FakeSession] = []
        self.player = Player(FOUND, self.start, self.viewer, clock=lambda: self.now)  # type: ignore[arg-type]

    def start(self) -> FakeSession:
        self.sessions.append(FakeSession())
        return self.sessions[-1]

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def play(self, seconds: float, *commands: Command) -> None:
        for command in commands:
            self.viewer.commands.put(command)
        end = self.now + seconds
        self.player.run(is_over=lambda: self.now >= end)

    @property
    def text(self) -> str:
        """What is shown, without the escapes of Markdown."""
        return re.sub(r"\\(.)", r"\1", self.viewer.reported[-1][0])


@pytest.fixture
def game(monkeypatch: pytest.MonkeyPatch) -> Game:
    return Game(monkeypatch)


def test_time_passes_as_fast_as_it_does(game: Game) -> None:
    game.play(2.0)
    assert game.sessions[0].seconds == pytest.approx(2.0, abs=0.05)
    assert game.text.endswith("simulated, 1 × real time")
    assert game.viewer.poses[-1]["box"]["base"].xyz[0] == pytest.approx(2.0, abs=0.05)


def test_a_slow_engine_is_shown_as_slow(game: Game) -> None:
    step = game.sessions[0].step

    def slow(seconds: float) -> None:
        game.now += 4 * seconds
        step(seconds)

    game.sessions[0].step = slow  # type: ignore[method-assign]
    game.play(4.0)
    assert "0.25 × real time" in game.text


def test_paused_it_stands_still_and_goes_on_later(game: Game) -> None:
    game.play(1.0)
    game.play(1.0, SetRunning(is_running=False))
    before = game.sessions[0].seconds
    assert before == pytest.approx(1.0, abs=0.05)
    assert game.text.endswith(", paused")
    assert game.viewer.reported[-1][1] is False
    game.play(1.0, SetRunning(is_running=True))
    assert game.sessions[0].seconds == pytest.approx(before + 1.0, abs=0.05)


def test_a_step_pauses_and_takes_its_time(game: Game) -> None:
    game.play(0.5, SetRunning(is_running=False), Step(0.01), Step(0.02))
    assert game.sessions[0].seconds == pytest.approx(0.03)


def test_a_push_goes_to_the_session(game: Game) -> None:
    game.play(0.1, Push("box", "base", (1.0, 2.0, 3.0), 0.2))
    assert game.sessions[0].pushes == [("box", (1.0, 2.0, 3.0), 0.2, "base")]


def test_reset_begins_again(game: Game) -> None:
    game.play(1.0)
    game.play(0.2, Reset())
    assert game.sessions[0].seconds == pytest.approx(0.2, abs=0.05)
    assert len(game.sessions) == 1


def test_a_robot_that_explodes_stops_it_until_reset(game: Game) -> None:
    game.sessions[0].explodes_at = 0.5
    game.play(2.0)
    assert game.sessions[0].seconds == pytest.approx(0.5, abs=0.05)
    assert "The state of box is not finite any more.** Reset" in game.text
    game.sessions[0].explodes_at = 1e9
    game.play(0.5, Reset())
    assert game.sessions[0].seconds == pytest.approx(0.5, abs=0.05)


def test_an_engine_that_dies_is_started_again_by_reset(game: Game) -> None:
    game.sessions[0].dies = True
    game.play(0.5)
    assert "The engine died." in game.text
    game.play(0.5, SetRunning(is_running=True))  # which does not help
    assert game.viewer.reported[-1][1] is False
    game.play(0.5, Reset())
    assert game.sessions[0].is_closed
    assert game.sessions[1].seconds == pytest.approx(0.5, abs=0.05)
    game.player.close()
    assert game.sessions[1].is_closed


def test_a_push_of_what_is_not_simulated_is_reported(game: Game) -> None:
    game.play(0.1, Push("nobody", None, (1.0, 0.0, 0.0), 0.2))
    assert "no robot `nobody`" in game.text


def test_a_robot_that_the_engine_refuses_is_reported(game: Game) -> None:
    game.sessions[0].refused = {"cart": Refused("it has 200 links", "Take fewer.")}
    game.play(0.1)
    assert "cart is not simulated: it has 200 links." in game.text


def test_what_users_write_is_no_markup(game: Game) -> None:
    game.sessions[0].refused = {"<img src=x>": Refused("`*a*` is <b>", "")}
    game.sessions[0].states = {}
    game.player._fail("The robot `<script>` {died}")
    game.play(0.1)
    shown = game.viewer.reported[-1][0]
    assert not re.search(r"(?<!\\)[<>`{}]", shown), shown


def test_a_model_that_is_not_simulated_is_where_it_is_placed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wall = PreparedRobot(
        entity="wall",
        written=BOX,
        lumped=BOX,
        readable=BOX,
        spawn_pose=Pose((3.0, 0.0, 0.0)),
        is_static_model=True,
        can_run=False,
    )
    viewer = Viewer()
    Player(FOUND._replace(robots=(wall, *FOUND.robots)), FakeSession, viewer)  # type: ignore[arg-type]
    ((box, shown),) = viewer.robots
    assert (box.entity, shown.entity) == ("box", "wall")
    assert shown.pose_in_world.xyz == (3.0, 0.0, 0.0)


def test_what_is_drawn_is_what_is_simulated(game: Game) -> None:
    ((robot,),) = game.viewer.robots
    assert [link.name for link in robot.links] == ["base"]
    assert robot.low[2] == pytest.approx(0.9)


@pytest.mark.slow
def test_a_real_box_falls_and_slides(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(
        world=FOUND.world,  # type: ignore[arg-type]
        robots=(SpawnedRobot(entity="box", robot=BOX, pose_in_world=Pose((0.0, 0.0, 0.5))),),
    )
    viewer = Viewer()
    player = Player(FOUND, lambda: Session(scene, remembered=0), viewer)
    try:
        for command in (Step(1.0), Push("box", None, (20.0, 0.0, 0.0), 0.2), Step(0.2)):
            viewer.commands.put(command)
        ends = iter([False, True])
        player.run(is_over=lambda: next(ends))
    finally:
        player.close()
    x, _, z = viewer.poses[-1]["box"]["base"].xyz
    assert z == pytest.approx(0.1, abs=0.02)
    assert x > 0.05
    assert viewer.reported[-1] == ("**1.20 s** simulated, paused", False)

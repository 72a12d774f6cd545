"""Sessions: scenes that live in a child process and do what they are told."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from PIL import Image

from simulation.movers import AT, DRIVE, arm, two_wheeled
from simulation.robots import GROUND, PLATE, body, single
from wsgen.errors import RequestError, SessionDiedError
from wsgen.model.engines import ENGINES
from wsgen.model.transform import Pose
from wsgen.simulation import session
from wsgen.simulation.engine import Motor
from wsgen.simulation.run import missing_engines, run_simulation
from wsgen.simulation.scene import NotDrawn, Picture, Scene, SpawnedRobot, Video
from wsgen.simulation.session import Session
from wsgen.testing.simulation import Simulation

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Robot

pytestmark = pytest.mark.slow


def scene_of(robot: Robot, pose: Pose = AT, *, engine: str = "fake", entity: str = "e") -> Scene:
    robots = (SpawnedRobot(entity=entity, robot=robot, pose_in_world=pose),)
    return Scene(world=GROUND, robots=robots, engine=engine)


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    if missing_engines([name]):
        pytest.skip(f"{ENGINES[name].title} is not installed")
    return name


@pytest.fixture(autouse=True)
def fake(monkeypatch: pytest.MonkeyPatch) -> None:
    like = ENGINES["bullet"]._replace
    fake = like(title="fake", tasks="simulation.session_tasks")
    monkeypatch.setitem(ENGINES, "fake", fake)
    absent = like(title="absent", library="no_such_module", tasks="simulation.session_not_loaded")
    monkeypatch.setitem(ENGINES, "absent", absent)


def test_it_does_what_it_is_asked_to() -> None:
    with Session(scene_of(two_wheeled())) as live:
        assert live.loaded["e"].links == 3
        assert live.spawn_poses == {"e": AT}
        assert live.states["e"].pose_in_world.xyz == (0.0, 0.0, 0.0)
        assert live.contacts("e") == ()
        states = live.step(2.0)
        assert states is live.states
        assert live.seconds == 2.0
        assert states["e"].pose_in_world.xyz == (0.0, 0.0, 2.0)
        assert states["e"].joint_positions == {"left": 4.0, "right": 0.0}
        assert states["e"].joint_velocities == {"left": pytest.approx(2.0), "right": 0.0}
        (contact,) = live.contacts("e")
        assert (contact.other_entity, contact.force) == (None, 9.8)
        live.reset()
        assert (live.seconds, live.states["e"].pose_in_world.xyz) == (0.0, (0.0, 0.0, 0.0))


def test_what_cannot_be_done_is_refused_before_it_is_sent() -> None:
    with Session(scene_of(two_wheeled())) as live:
        for refused, message in (
            (lambda: live.hold("e", {"lft": 1.0}), r"no movable joint `lft`.*\n.*`left`"),
            (lambda: live.set_motors("e", {"x": Motor(1.0, 1.0)}), "no movable joint `x`"),
            (lambda: live.push("e", (1.0, 0.0, 0.0), 1.0, "bse"), r"no link `bse`.*\n.*`base`"),
            (
                lambda: live.push("x", (1.0, 0.0, 0.0), 1.0),
                r"does not simulate a robot `x`(?s:.*)Robots: e\.",
            ),
            (lambda: live.push("e", (1.0, 0.0), 1.0), "not three numbers"),  # type: ignore[arg-type]
            (
                lambda: live.push("e", (math.inf, 0.0, 0.0), 1.0),
                "A part of the force is inf, not",
            ),
            (lambda: live.hold("e", {"left": math.nan}), "The position of `left` is nan, not"),
            (lambda: live.set_motors("e", {"left": Motor(math.nan, 1.0)}), "speed .* is nan"),
            (lambda: live.step(-1.0), "-1.0 s of simulated time"),
            (lambda: live.step(math.inf), "inf s of simulated time"),
            (lambda: live.watch(math.nan), "nan s of simulated time"),
        ):
            with pytest.raises(RequestError, match=message):
                refused()
        assert live.step(0.0)["e"].is_finite


def test_what_is_no_number_is_refused_before_it_is_sent() -> None:
    text: Any = "0.5"
    number: Any = 20.0
    push = (1.0, 0.0, math.nan)
    two: Any = (1.0, 0.0)
    items: Any = [1.0]
    with Session(scene_of(two_wheeled())) as live:
        for refused, message in (
            (lambda: live.step(text), "0.5 s of simulated time cannot pass"),
            (
                lambda: live.hold("e", {"left": math.nan}),
                r"`left` is nan, not .*\n.*in rad or m",
            ),
            (
                lambda: live.hold("e", {"left": text}),
                "position of `left` is '0.5', not a finite",
            ),
            (lambda: live.hold("e", items), r"positions of joints are \[1\.0\], not a dict"),
            (
                lambda: live.drive("e", DRIVE, linear=text),
                "linear velocity is '0.5', not a finite",
            ),
            (
                lambda: live.drive("e", DRIVE, angular=math.inf),
                r"angular velocity is inf.*\n.*rad/s",
            ),
            (
                lambda: live.push("e", number, 1.0),
                r"force is 20\.0, not three numbers.*\n.*in N",
            ),
            (lambda: live.push("e", two, 1.0), "not three numbers"),
            (lambda: live.push("e", push, 1.0), "part of the force is nan"),
        ):
            with pytest.raises(RequestError, match=message):
                refused()
        assert live.step(0.0)["e"].is_finite


@pytest.mark.parametrize("dtype", ["float64", "float32", "int64"])
def test_numbers_of_numpy_are_numbers(dtype: str) -> None:
    one, two = np.array([1, 2], dtype=dtype)
    force: Any = np.array([1, 2, 3], dtype=dtype)
    with Session(scene_of(two_wheeled())) as live:
        live.push("e", force, one)
        live.hold("e", {"left": one})
        live.drive("e", DRIVE, linear=one, angular=one)
        assert live.step(two)["e"].is_finite
        assert live.seconds == 2.0


def test_it_stops_where_a_state_is_lost() -> None:
    with Session(scene_of(two_wheeled())) as live:
        assert not live.step(20.0)["e"].is_finite
        assert live.seconds == pytest.approx(9.01)


def test_a_robot_that_the_engine_refuses_is_left_out() -> None:
    with Session(scene_of(two_wheeled(), entity="refused")) as live:
        assert live.refused["refused"].reason == "the script says so"
        assert not live.loaded
        assert not live.states
        with pytest.raises(RequestError, match="does not simulate a robot `refused`"):
            live.release("refused")


def test_an_engine_that_dies_is_an_error_that_names_the_step() -> None:
    with Session(scene_of(two_wheeled())) as live:
        live.step(5.5)
        live.push("e", (1.0, 0.0, 0.0), 1.0, "left")
        for _ in range(2):  # it stays dead
            with pytest.raises(
                SessionDiedError, match=r"crashed \(SIGABRT\) while simulating 2 s after 5.5 s"
            ):
                live.step(2.0)
    with pytest.raises(ValueError, match="closed"):
        live.step(1.0)


def test_an_engine_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "COMMAND_SECONDS", 1.0)
    monkeypatch.setattr(session, "SECONDS_A_SECOND", 0.0)
    with Session(scene_of(two_wheeled())) as live:
        live.push("e", (1.0, 0.0, 0.0), 1.0, "right")
        with pytest.raises(SessionDiedError, match=r"(CPU time|is busy\)) while simulating 1 s"):
            live.step(1.0)


def test_an_engine_that_dies_of_a_robot_names_it() -> None:
    with pytest.raises(
        SessionDiedError, match=r"while loading the robot `deadly`\. Its last output: a bad mesh"
    ):
        Session(scene_of(two_wheeled(), entity="deadly"))


def test_an_engine_that_is_not_loaded_says_what_to_install() -> None:
    with pytest.raises(SessionDiedError, match="libgl1"):
        Session(scene_of(two_wheeled(), engine="absent"))


def states_of(live: Session) -> list[str]:
    """All numbers, to the last bit."""
    live.drive("e", DRIVE, linear=0.5)
    seen = [repr(live.step(0.5))]
    live.push("e", (0.0, 20.0, 0.0), 0.3)
    seen.append(repr(live.step(0.5)))
    live.drive("e", DRIVE, angular=1.0)
    seen += [repr(live.step(0.25)), repr(live.contacts("e")), repr(live.watch(0.5))]
    return seen


def test_the_same_commands_give_the_same_states(engine: str) -> None:
    with Session(scene_of(two_wheeled(), engine=engine)) as one:
        first = states_of(one)
        one.reset()
        assert states_of(one) == first
        one.reset()
        one.step(1.0)
        whole = one.states
        one.reset()
        one.step(0.5)
        assert one.step(0.5) == whole
    with Session(scene_of(two_wheeled(), engine=engine)) as other:
        assert states_of(other) == first


def test_it_measures_what_a_simulation_measures(engine: str) -> None:
    scene = scene_of(two_wheeled(), engine=engine)
    expected = run_simulation(scene).robot_runs
    with Session(scene) as live:
        assert live.watch(scene.seconds) == expected


def test_a_robot_drives_and_is_released(engine: str) -> None:
    with Session(scene_of(two_wheeled(), Pose((0.0, 0.0, 0.105)), engine=engine)) as live:
        live.step(0.5)
        live.drive("e", DRIVE, linear=0.5)
        state = live.step(2.0)["e"]
        assert state.pose_in_world.xyz[:2] == pytest.approx((1.0, 0.0), abs=0.05)
        assert state.speed == pytest.approx(0.5, rel=0.05)
        assert state.joint_velocities["left"] == pytest.approx(5.0, rel=0.05)
        live.drive("e", DRIVE)
        assert live.step(1.0)["e"].speed < 0.02
        live.release("e")
        live.push("e", (20.0, 0.0, 0.0), 0.5)
        assert live.step(0.5)["e"].speed > 0.5  # its wheels roll


def test_an_arm_holds_and_keeps_what_it_was_told_before(engine: str) -> None:
    with Session(scene_of(arm(), Pose(), engine=engine)) as live:
        live.hold("e", {"j1": -0.5})
        live.step(2.0)
        live.hold("e", {"j2": 0.8})
        positions = live.step(2.0)["e"].joint_positions
        assert positions == {
            "j1": pytest.approx(-0.5, abs=0.03),
            "j2": pytest.approx(0.8, abs=0.03),
        }
        live.set_motors("e", {"j2": Motor(-0.2, 20.0)})
        velocities = live.step(1.0)["e"].joint_velocities
        assert velocities["j2"] == pytest.approx(-0.2, abs=0.02)
        live.release("e")
        assert live.step(1.0)["e"].joint_positions["j1"] > 0.5  # it falls


def test_pushes_end_and_add_up(engine: str) -> None:
    """Sideways on ice: force times time is momentum."""
    robot = single(body(PLATE, mass=2.0, mu=0.0))
    with Session(scene_of(robot, Pose((0.0, 0.0, 0.05)), engine=engine)) as live:
        live.push("e", (4.0, 0.0, 0.0), 0.5)
        live.push("e", (0.0, 4.0, 0.0), 1.0)
        live.step(0.505)
        live.step(1.0)
        x, y, _ = live.states["e"].pose_in_world.xyz
        assert [x, y] == [pytest.approx(1.255, rel=0.02), pytest.approx(2.01, rel=0.02)]
        assert live.states["e"].speed == pytest.approx(math.hypot(1.0, 2.0), rel=0.02)


def test_a_picture_and_the_last_second(engine: str, tmp_path: Path) -> None:
    with Session(scene_of(two_wheeled(), engine=engine)) as live:
        live.drive("e", DRIVE, linear=0.5)
        live.step(1.7)
        picture, video = tmp_path / "now.png", tmp_path / "last.gif"
        assert isinstance(live.picture(picture), Picture)
        drawn = live.record(str(video))
        assert isinstance(drawn, Video)
        assert drawn.frames == 21
        with Image.open(picture) as image:
            assert image.size == (960, 720)
        with Image.open(video) as image:
            assert getattr(image, "n_frames", 0) > 10
        live.step(0.1)  # and it goes on


def test_what_cannot_be_drawn_says_why(tmp_path: Path) -> None:
    with Session(scene_of(two_wheeled())) as live:
        nowhere = tmp_path / "no" / "where.gif"
        answer = live.record(nowhere)
        assert isinstance(answer, NotDrawn)
        assert "does not exist" in answer.problem
        assert isinstance(live.picture(nowhere.with_suffix(".png")), NotDrawn)
    with Session(scene_of(two_wheeled()), remembered=0.0) as live:
        answer = live.record(tmp_path / "a.gif")
        assert isinstance(answer, NotDrawn)
        assert answer.problem == "nothing was recorded"


@pytest.mark.parametrize("seconds", [0.0, 0.0004, 0.004, 0.0134, 0.0251])
def test_settling_ends_where_no_whole_step_is_left(seconds: float) -> None:
    loaded = SimpleNamespace(world=None, plan=None, robots=(), simulator=None)
    with Session(scene_of(two_wheeled())) as live:
        shared_scene = SimpleNamespace(engine="fake", loaded=loaded, session=lambda: live)
        simulation = Simulation(cast("Any", shared_scene))
        assert not simulation.settle(seconds)
        assert simulation.seconds == pytest.approx(seconds, abs=live.step_seconds / 2)

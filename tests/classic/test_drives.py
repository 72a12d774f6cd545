"""Where the real Gazebo Classic's motors drive robots, and those of wsgen.

`recorded/drives.json` was recorded with Debian 11's Gazebo 11.1: x and y (m) and yaw (rad) of each
robot on the ground plane at the beginning and at the end of each command of `PLAN`. The wheels get
what `gazebo_ros_diff_drive` gives them a hundred times a second: `vel` and `fmax` of their joints.
`with Gazebo's plugin` was driven by Gazebo's own `libDiffDrivePlugin.so`, which sets the speed of
the wheels itself. `--regenerate` records it anew.
"""

from __future__ import annotations

import importlib
import math
import re
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
import xacro

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic, recorded_in
from classic.rovers import ROVERS
from simulation.conftest import CLASSES
from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.behavior import Drive
from wsgen.model.engines import ENGINES
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation.controllers import UPDATE, DiffDriveController
from wsgen.simulation.run import missing_engines
from wsgen.simulation.sampling import heading_of
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Robot

RECORDED = Path(__file__).with_name("recorded") / "drives.json"
GOLDEN = Path(__file__).parents[1] / "golden"
TEMPLATES = ("diff_drive", "wanderer")
pytestmark = [pytest.mark.oracle, pytest.mark.slow]
LIVE = ("diff_drive", "wide wheels")  # asked in each run of the tests
WORLD = (
    "<sdf version='1.6'><world name='w'>{}<include><uri>model://ground_plane</uri></include>"
    "</world></sdf>"
)
# Fifty iterations, ODE's default, do not solve what is between skidding wheels and the ground.
SOLVED, SOFT, SLOW = ", solved", ", on contacts that give way", ", slowly corrected"
PHYSICS = {
    SOLVED: "<solver><iters>1000</iters></solver>",
    SOFT: "<constraints><cfm>0.00001</cfm></constraints>",
    SLOW: "<constraints><contact_max_correcting_vel>2</contact_max_correcting_vel></constraints>",
}
WEAK, STRONG = "four wheels", "four strong wheels"
# Its friction turns with the wheels in Gazebo Classic, out of the ground; MuJoCo projects it.
DIRECTED = "four wheels with a direction"
SKIDS = STRONG + SOLVED
CASTERS = "two casters"
OF_SOLVER = (SKIDS, CASTERS + SOFT, CASTERS + SOLVED, "diff_drive" + SLOW)
# A few in MuJoCo, and in DART, which is not Gazebo Classic's.
RUNS = [
    *(
        (one, "bullet")
        for one in ("diff_drive", *ROVERS, SKIDS)
        if one not in {DIRECTED, STRONG, WEAK}
    ),
    *((one, "mujoco") for one in ("diff_drive", "two casters", "wide wheels", SKIDS)),
    *((one, "dart") for one in ("diff_drive", "wide wheels", SKIDS)),
]
# Those that differ least from the others; each takes three seconds.
MORE = {
    *((one, "bullet") for one in ("smooth caster", "thin wheels", "balls for wheels", "heavy")),
    *((one, "bullet") for one in ("wheels of little friction", "wheels of much friction")),
    ("wide wheels", "mujoco"),
}
CLASSIC = World(name="w", has_ground_plane=True, simulator="classic", ground_friction=100.0)
# s, m/s, rad/s; the first second is for coming to rest.
PLAN = ((1, 0, 0), (4, 0.5, 0), (1, 0, 0), (3, 0, 1.0), (1, 0, 0), (4, 0.3, 0.5), (1, 0, 0))
OWN = "with Gazebo's plugin"
OWN_SKID = "with Gazebo's plugin for skid steering"
SAME = 0.02
# By how much at most others turn in another way, or go another way in a curve, and why.
INNER = "the weight is on the inner edges of cylinders in DART, on the outer ones in Gazebo Classic"
SPREAD = "more than three points carry it, on which ODE spreads the weight in another way"
LEFT = {
    ("diff_drive", "dart"): (0.025, INNER),
    ("wide wheels", "dart"): (0.4, INNER),
    ("two casters", ""): (0.25, SPREAD),
    (SKIDS, ""): (0.09, "on the spot it turns as far, within 1 %; in the curve, " + SPREAD),
    ("four wheels of little friction", ""): (0.04, SPREAD),
}
AHEAD, TURN, CURVE = 1, 3, 5  # their places in the plan
Places = list[list[float]]


class Subject(NamedTuple):
    """A robot with what drives it."""

    urdf: str
    robot: Robot
    drive: DiffDrive
    height: float  # m, at which it is spawned


def subject(name: str, folder: Path) -> Subject:
    if name in ROVERS:
        rover = ROVERS[name]
        return Subject(rover.urdf, lumped(rover.urdf), rover.drive, rover.height)
    source = GOLDEN / f"{name}-iron-classic/ws_gazebo/src/gazebo_test/model"
    for file in source.iterdir():
        text = file.read_text(encoding="utf-8").replace("$(find gazebo_test)/model", str(folder))
        (folder / file.name).write_text(text, encoding="utf-8")
    text = xacro.process_file(str(folder / "robot.xacro")).toxml()
    robot = lumped(text)
    drive = find_diff_drive(robot)
    assert not isinstance(drive, NoDrive)
    return Subject(text, robot, drive, 0.002)


def lumped(text: str) -> Robot:
    file = Path("r.urdf")
    robot, _ = read_urdf(text, file=file)
    assert robot is not None
    return lump(robot, file=file)[0]


def driven(
    one: Subject, drive: Callable[[DiffDriveController], None], place: Callable[[], list[float]]
) -> Places:
    """Where a robot is at the ends of the commands; `drive` lets time pass to the next update."""
    controller = DiffDriveController(one.drive, Drive(), one.robot)
    controller.has_begun = True
    places = []
    for seconds, linear, angular in PLAN:
        controller.task = Drive(linear=linear, angular=angular)
        for _ in range(round(seconds / UPDATE)):
            drive(controller)
        places.append(place())
    return places


def ask(name: str, folder: Path) -> Places:
    """Where Gazebo Classic's motors drive it."""
    name, comma, how = name.partition(",")
    one = subject(name, folder)
    world, file = folder / "w.world", folder / "r.urdf"
    physics = f"<physics type='ode'><ode>{PHYSICS[comma + how]}</ode></physics>" if how else ""
    world.write_text(WORLD.format(physics))
    # Sensors are no matter here, and take time.
    file.write_text(re.sub(r"<sensor.*?</sensor>", "", one.urdf, flags=re.DOTALL))
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(file, "r", z=one.height)
        sent: dict[str, object] = {}

        def drive(controller: DiffDriveController) -> None:
            for joint, motor in controller.motors({}).items():
                if sent.get(joint) != motor:
                    sent[joint] = motor
                    gazebo.ask("param", "r", joint, "fmax", motor.effort)
                    gazebo.ask("param", "r", joint, "vel", motor.speed)
            gazebo.run(UPDATE)

        def place() -> list[float]:
            pose = gazebo.state()["r"]["links"][f"r::{one.robot.root}"]["pose"]
            return _rounded(pose[0], pose[1], _yaw(pose))

        return driven(one, drive, place)


def _yaw(pose: list[float]) -> float:
    w, x, y, z = pose[3:]
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _rounded(*numbers: float) -> list[float]:
    return [round(number, 4) for number in numbers]


def simulated(engine_name: str, one: Subject) -> Places:
    """Where an engine of wsgen drives it."""
    module = importlib.import_module(f"wsgen.simulation.{engine_name}")
    with closing(getattr(module, CLASSES[engine_name])(CLASSIC)) as engine:
        engine.spawn(
            SpawnedRobot(
                entity="r",
                robot=one.robot,
                pose_in_world=Pose((0.0, 0.0, one.height)),
                drive=one.drive,
            )
        )
        steps = round(UPDATE / engine.step_seconds)

        def drive(controller: DiffDriveController) -> None:
            engine.drive("r", controller.motors({}))
            engine.advance(steps)

        def place() -> list[float]:
            state = engine.state("r")
            return _rounded(state.xyz[0], state.xyz[1], heading_of(state))

        return driven(one, drive, place)


def ask_own(folder: Path) -> Places:
    """Where Gazebo's own plugin drives the template."""
    one = subject("diff_drive", folder)
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text(WORLD.format(""))
    (pair,) = one.drive.pairs
    own = (
        "<gazebo><plugin name='own' filename='libDiffDrivePlugin.so'>"
        f"<left_joint>{pair.left}</left_joint><right_joint>{pair.right}</right_joint></plugin>"
        "</gazebo></robot>"
    )
    # The driver loads no plugins of models with sensors.
    text = re.sub(r"<sensor.*?</sensor>", "", one.urdf, flags=re.DOTALL)
    file.write_text(text.replace("</robot>", own))
    places = []
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(file, "r", z=one.height)
        for seconds, linear, angular in PLAN:
            turn = f"x: 0 y: 0 z: {math.sin(angular / 2)} w: {math.cos(angular / 2)}"
            pose = f"position {{x: {linear} y: 0 z: 0}} orientation {{{turn}}}"
            gazebo.ask("publish", "~/r/vel_cmd", "gazebo.msgs.Pose", pose)
            gazebo.run(seconds)
            there = gazebo.state()["r"]["links"][f"r::{one.robot.root}"]["pose"]
            places.append(_rounded(there[0], there[1], _yaw(there)))
    return places


def ask_skid(folder: Path) -> Places:
    """Where Gazebo's own plugin for skid steering drives a rover: x after messages, m.

    After one message and half a second, and after another half with one every hundredth.
    """
    one = subject(STRONG, folder)
    text = one.urdf
    for side in ("left", "right"):
        for number, end in enumerate(("front", "rear")):  # it finds its joints by these names
            text = text.replace(f"{side}{number}_joint", f"{side}_{end}")
    plugin = "<gazebo><plugin name='own' filename='libSkidSteerDrivePlugin.so'/></gazebo></robot>"
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text(WORLD.format(""))
    file.write_text(text.replace("</robot>", plugin))
    places = []
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(file, "r", z=one.height)
        gazebo.run(1.0)
        for messages, pause in ((0, 0.0), (1, 0.5), (50, 0.01)):
            for _ in range(messages):
                pose = "position {x: 0.5 y: 0 z: 0} orientation {x: 0 y: 0 z: 0 w: 1}"
                gazebo.ask("publish", "~/r/vel_cmd", "gazebo.msgs.Pose", pose)
                gazebo.run(pause)
            there = gazebo.state()["r"]["links"]["r::base"]["pose"]
            places.append(_rounded(there[0], there[1], _yaw(there)))
    return places


def way(places: Places, command: int) -> tuple[float, float]:
    """How far it has gone in a command (m), and how far it has turned (rad)."""
    (x, y, yaw), (to_x, to_y, to_yaw) = places[command - 1], places[command]
    # No command turns it by more than half a turn, but skidding may.
    return math.hypot(to_x - x, to_y - y), math.remainder(to_yaw - yaw, math.tau)


PLUGINS = {OWN: ask_own, OWN_SKID: ask_skid}


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("drives")
    return recorded_in(
        RECORDED,
        request,
        (*TEMPLATES, *ROVERS, *OF_SOLVER, *PLUGINS),
        lambda name: PLUGINS[name](folder) if name in PLUGINS else ask(name, folder),
    )


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    places = ask(name, tmp_path)
    for command in (AHEAD, TURN, CURVE):
        now = way(places, command)
        assert now == pytest.approx(way(recorded[name], command), rel=0.005, abs=0.01)


def test_the_templates_drive_alike(recorded: Any) -> None:
    assert recorded["diff_drive"] == recorded["wanderer"]


@pytest.mark.parametrize(("name", "engine_name"), RUNS)
def test_robots_go_where_they_go_in_gazebo_classic(
    name: str, engine_name: str, recorded: Any, tmp_path: Path, *, thorough: bool
) -> None:
    if (name, engine_name) in MORE and not thorough:
        pytest.skip("with --thorough alone")
    if missing_engines([engine_name]):
        pytest.skip(f"{ENGINES[engine_name].title} is not installed")
    one, real = subject(name.removesuffix(SOLVED), tmp_path), recorded[name]
    ours = simulated(engine_name, one)
    ahead, turn, curve = (shares(way(ours, one), way(real, one)) for one in (AHEAD, TURN, CURVE))
    bound, _ = LEFT.get((name, ""), LEFT.get((name, engine_name), (SAME, "")))
    assert ahead[0] < SAME
    assert max(curve[0], turn[1], curve[1]) < bound


def shares(ours: tuple[float, float], real: tuple[float, float]) -> tuple[float, float]:
    """By which shares of the real ones a way and a turn differ."""
    first, second = (abs(one / other - 1) for one, other in zip(ours, real, strict=True))
    return first, second


def test_fifty_iterations_do_not_solve_skidding(recorded: Any) -> None:
    """Wheels lag behind their motors, the more so the weaker these are."""
    weak, strong, solved = (way(recorded[one], TURN)[1] for one in (WEAK, STRONG, SKIDS))
    assert weak < 0.8 * strong < 0.7 * solved


def test_the_solver_chooses_where_the_weight_is_on_more_than_three_points(
    recorded: Any, tmp_path: Path
) -> None:
    """Where contacts give way a little it is decided, and as here; solved, wheels carry nothing."""
    soft, hard = (way(recorded[one], TURN)[1] for one in (CASTERS + SOFT, CASTERS))
    ours = way(simulated("bullet", subject(CASTERS, tmp_path)), TURN)[1]
    assert soft > 1.15 * hard
    assert ours == pytest.approx(soft, rel=0.04)
    assert way(recorded[CASTERS + SOLVED], AHEAD)[0] < 0.01


def test_wheels_turn_no_faster_than_contacts_are_corrected(recorded: Any, tmp_path: Path) -> None:
    """By as many rad/s as <contact_max_correcting_vel> says, for ODE corrects motors with it."""
    (pair,) = subject("diff_drive", tmp_path).drive.pairs
    slow, fast = (way(recorded[one], AHEAD)[0] for one in ("diff_drive" + SLOW, "diff_drive"))
    assert slow == pytest.approx(fast * 2 / (0.5 / pair.radius), rel=0.05)


def test_gazebos_own_plugin_drives_as_far(recorded: Any) -> None:
    """It sets the speed of the wheels, without a motor, and turns to the other side."""
    own, motors = recorded[OWN], recorded["diff_drive"]
    assert way(own, AHEAD)[0] == pytest.approx(way(motors, AHEAD)[0], rel=0.02)
    assert -way(own, TURN)[1] == pytest.approx(way(motors, TURN)[1], rel=0.02)


def test_gazebos_plugin_for_skid_steering_pushes_once_a_message(recorded: Any) -> None:
    """It sets the speed of the wheels in a message alone: the rover rolls on with what is left."""
    (begin, *_), (one, *_), (many, *_) = recorded[OWN_SKID]
    assert 0.01 < one - begin < 0.1 * 0.5 * 0.5
    assert 5 * (one - begin) < many - one < 0.9 * 0.5 * 0.5

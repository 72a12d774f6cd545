"""Simulations in one engine or several: what is told of each, and who passes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from child_answers import answered
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Answered, Died
from wsgen.model.behavior import Behavior, Reach
from wsgen.model.engines import ENGINES
from wsgen.model.robot import MOST_LINKS, Box, Collision, Inertial, Joint, JointType, Link, Robot
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.packages.workspace.settings import Settings
from wsgen.pipeline import run_robots as robot_runs
from wsgen.pipeline.behavior_plan import plan_behaviors
from wsgen.pipeline.prepare import PreparedRobot
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.simulation.engine import HullGap
from wsgen.simulation.run import missing_engines
from wsgen.simulation.scene import (
    DRAWING,
    LOADING,
    BehaviorMeasurement,
    Picture,
    RobotRun,
    Scene,
    SceneResult,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.pipeline.requests import SimulationResult

BODY = Inertial(mass=1.0, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
WORLD = World(name="w", has_ground_plane=True)
ALL = ("bullet", "mujoco", "dart")


def prepared(entity: str) -> PreparedRobot:
    robot = Robot(name="r", root="base", links=(Link(name="base", inertial=BODY),))
    return PreparedRobot(entity=entity, written=robot, lumped=robot)


def stands(entity: str, **more: Any) -> RobotRun:
    return RobotRun(
        **{
            "entity": entity,
            "links": 1,
            "movable_joints": 0,
            "mass": 1.0,
            "spawn_pose": Pose(),
            "overlaps": (),
            "lowest_point": 0.0,
            "penetration": 0.0,
            "lowest_point_at_end": 0.0,
            "is_finite": True,
            "settled_after": 0.1,
            "rest_pose": Pose(),
            "speed": 0.0,
            "turning": 0.0,
            "joint_speed": 0.0,
            "highest_speed": 0.0,
            "highest_point": 0.0,
            "tilt": 0.0,
            "energy_gain": 0.0,
            "joint_positions": {},
            "joint_travel": {},
            **more,
        }
    )


class Engines:
    """Answers for child processes: a robot that is in `kills` ends the engine."""

    def __init__(
        self, other: Mapping[str, Mapping[str, Any]] | None = None, *, kills: str = ""
    ) -> None:
        self.kills = kills
        self.other = other or {}  # what is measured, by engine, where it is not that of `stands`
        self.scenes: list[Scene] = []

    def __call__(self, task: str, *arguments: Any, **_: Any) -> Answered | Died:
        (scene,) = arguments
        assert task == f"{ENGINES[scene.engine].tasks}:simulate"
        self.scenes.append(scene)
        if any(robot.entity == self.kills for robot in scene.robots):
            step = LOADING.format(entity=self.kills)
            return Died(reason="crashed (SIGSEGV)", step=step, output="")
        more = self.other.get(scene.engine, {})
        result = SceneResult(
            robot_runs=tuple(stands(robot.entity, **more) for robot in scene.robots),
            refused={},
            picture=Picture(tile=None),
            seconds={"simulate": 0.0, "draw": 0.0},
        )
        return answered(result)


def simulated(
    engines: Engines, *entities: str, names: Sequence[str] = ("bullet",)
) -> SimulationResult:
    request = ValidateRequest(engines=names)
    robots = [prepared(entity) for entity in entities]
    return simulate_robots(WORLD, robots, request, "name", run=engines)


def test_a_robot_that_kills_the_engine_is_named_and_the_others_are_tried() -> None:
    outcome = simulated(Engines(kills="b"), "a", "b", "c")
    assert [(robot.entity, robot.passed) for robot in outcome.robots] == [
        ("a", True),
        ("b", False),
        ("c", True),
    ]
    assert [(found.code, found.element) for found in outcome.diagnostics] == [("SPN031", "b")]


def test_an_engine_that_dies_while_it_draws_costs_the_picture_alone(tmp_path: Path) -> None:
    class DiesDrawing(Engines):
        def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
            if arguments[0].picture is not None:
                return Died(reason="crashed (SIGSEGV)", step=DRAWING, output="")
            return super().__call__(task, *arguments, **more)

    request = ValidateRequest(engines=ALL, picture_folder=tmp_path)
    outcome = simulate_robots(WORLD, [prepared("a")], request, "name", run=DiesDrawing())
    assert [robot.passed for robot in outcome.robots] == [True]
    (found,) = outcome.diagnostics
    assert (found.code, found.severity) == ("SPN034", Severity.ERROR)
    assert found.message.startswith("Cannot draw")  # whatever the engines that draw none
    assert outcome.picture is None


IN_GROUND = {"lowest_point_at_end": -0.3}


@pytest.mark.parametrize(
    ("engines", "where"),
    [
        (("dart",), "In DART: "),
        (("bullet",), "In PyBullet: "),
        (("mujoco", "dart"), "In MuJoCo and DART: "),
        (("bullet", "mujoco", "dart"), ""),
    ],
)
def test_every_engine_must_pass_a_robot(engines: Sequence[str], where: str) -> None:
    outcome = simulated(Engines(dict.fromkeys(engines, IN_GROUND)), "a", names=ALL)
    (robot,) = outcome.robots
    assert not robot.passed
    assert [one.engine for one in robot.engines if not one.passed] == list(engines)
    (found,) = outcome.diagnostics
    assert found.code == "SPN055"
    assert found.message.startswith(f"{where}The robot is 0.300 m deep in the ground")
    assert [one.codes for one in robot.engines] == [
        frozenset(["SPN055"] if engine in engines else []) for engine in ALL
    ]


def test_the_worst_of_an_engine_is_reported() -> None:
    rolls, slides = ({"settled_after": None, "speed": speed} for speed in (0.02, 1.0))
    outcome = simulated(Engines({"bullet": rolls, "mujoco": slides}), "a", names=ALL)
    moving, disagree = outcome.diagnostics
    assert (moving.code, moving.severity) == ("SPN058", Severity.ERROR)
    assert moving.message.startswith("In PyBullet and MuJoCo: ")
    assert "moves at 1.000 m/s" in moving.message
    assert (disagree.code, disagree.element) == ("SPN065", "a")
    assert disagree.message.endswith("DART differs: in DART it comes to rest.")


def test_a_robot_on_a_hull_says_why_engines_disagree() -> None:
    class OnHull(Engines):
        def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
            answer = super().__call__(task, *arguments, **more)
            assert isinstance(answer, Answered)
            result = decode(answer.value, SceneResult)
            if "bullet" not in task:
                return answer
            bowl, ball = result.robot_runs
            gaps = (HullGap("l", "ball", 0.2),)
            rests = replace(ball, rest_pose=Pose((0.0, 0.0, 0.2)))
            return answered(replace(result, robot_runs=(replace(bowl, hull_gaps=gaps), rests)))

    on_hull, disagree = simulated(OnHull(), "bowl", "ball", names=ALL).diagnostics
    assert on_hull.message.startswith("In PyBullet: The mesh of `l` touches `ball` 200 mm from")
    assert disagree.element == "ball"
    assert disagree.message.startswith("MuJoCo and DART agree, PyBullet differs: in PyBullet it")
    assert "rests-on-hull" in str(disagree.hint)


def test_the_first_engine_is_the_one_of_the_report() -> None:
    places = {
        engine: {"rest_pose": Pose((0.0, 0.0, z)), "tilt": z}
        for engine, z in (("mujoco", 0.1), ("dart", 0.2))
    }
    outcome = simulated(Engines(places), "a", names=("mujoco", "dart"))
    (robot,) = outcome.robots
    assert robot.simulated is not None
    assert robot.simulated.engine == "mujoco"
    assert [one.rest and one.rest.tilt for one in robot.engines] == [0.1, 0.2]
    assert robot.rest == robot.engines[0].rest


@pytest.mark.slow
def test_engines_in_parallel_give_the_same_in_the_same_order() -> None:
    """Real engines; what is injected runs no threads."""
    robot = Robot(
        name="r",
        root="base",
        links=(
            Link(
                name="base",
                inertial=BODY,
                collisions=(Collision(geometry=Box(size=(0.2, 0.2, 0.2))),),
            ),
        ),
    )
    one = PreparedRobot(entity="a", written=robot, lumped=robot, spawn_pose=Pose((0.0, 0.0, 0.105)))
    engines = [name for name in ALL if not missing_engines([name])]
    outcomes = [
        simulate_robots(
            WORLD, [one], ValidateRequest(engines=engines, jobs=jobs), "n", run=parent.run
        )
        for jobs in (1, 3)
    ]
    assert outcomes[0].robots == outcomes[1].robots
    assert [one.engine for one in outcomes[1].robots[0].engines] == engines
    assert outcomes[1].robots[0].passed


NOTHING_TO_TOUCH = Diagnostic(
    name="some-rule",
    code="ROB053",
    severity=Severity.WARNING,
    message="No link has a <collision>.",
    line=2,
)
FALLS = {"lowest_point_at_end": -44.0, "settled_after": None}


class Falling(Engines):
    """In both engines the robots fall that are named."""

    def __init__(self, *falling: str) -> None:
        super().__init__()
        self.falling = falling

    def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
        answered = super().__call__(task, *arguments, **more)
        assert isinstance(answered, Answered)
        for robot_run in answered.value["robot_runs"]:
            robot_run.update(FALLS if robot_run["entity"] in self.falling else {})
        return answered


@pytest.mark.parametrize("engines", [("bullet",), ("bullet", "dart")])
def test_a_consequence_is_reported_with_its_cause_of_the_same_robot(
    engines: tuple[str, ...],
) -> None:
    without = replace(prepared("a"), diagnostics=(NOTHING_TO_TOUCH,))
    robots = [without, prepared("b")]
    request = ValidateRequest(engines=engines)
    outcome = simulate_robots(WORLD, robots, request, "name", run=Falling("a", "b"))
    assert [robot.passed for robot in outcome.robots] == [False, False]
    assert [(found.code, found.element) for found in outcome.diagnostics] == [("SPN056", "b")]
    before = Diagnostic(
        name="some-rule", code="ROB051", severity=Severity.WARNING, message="Something else."
    )
    first, cause, other = outcome.diagnostics_after([before, NOTHING_TO_TOUCH])
    assert (first, other.code) == (before, "SPN056")
    assert (cause.code, cause.severity, cause.line) == ("ROB053", Severity.ERROR, 2)
    assert cause.message.startswith("No link has a <collision>. In the simulation, the robot falls")


def test_scenery_that_falls_as_is_reported_of_it_stays_a_warning() -> None:
    ball = replace(prepared("ball"), is_static_model=True, diagnostics=(NOTHING_TO_TOUCH,))
    robots = [ball, prepared("a")]
    outcome = simulate_robots(WORLD, robots, ValidateRequest(), "name", run=Falling("ball"))
    (cause,) = outcome.diagnostics_after([NOTHING_TO_TOUCH])
    assert cause.severity is Severity.WARNING
    assert "falls" in cause.message
    silent = [replace(ball, diagnostics=()), prepared("a")]
    outcome = simulate_robots(WORLD, silent, ValidateRequest(), "name", run=Falling("ball"))
    (fall,) = outcome.diagnostics
    assert fall.message.startswith("The model `ball` falls")
    assert [robot.passed for robot in outcome.robots] == [True]


@pytest.mark.parametrize(
    ("asked", "installed", "taken"),
    [
        (["bullet"], ALL, ["mujoco"]),
        (["bullet"], ["bullet", "dart"], ["dart"]),
        (["bullet"], ["bullet"], []),
        (["bullet", "dart"], ["bullet", "dart"], ["dart"]),
        (ALL, ALL, ["mujoco", "dart"]),
    ],
)
def test_more_links_than_pybullet_can_do_go_to_another_engine(
    monkeypatch: pytest.MonkeyPatch,
    asked: Sequence[str],
    installed: Sequence[str],
    taken: Sequence[str],
) -> None:
    links = tuple(Link(name=f"l{n}", inertial=BODY) for n in range(MOST_LINKS + 1))
    joints = tuple(
        Joint(name=link.name, type=JointType.CONTINUOUS, parent="l0", child=link.name)
        for link in links[1:]
    )
    robot = Robot(name="r", root="l0", links=links, joints=joints)
    large = PreparedRobot(entity="large", written=robot, lumped=robot)
    monkeypatch.setattr(robot_runs, "installed_engines", lambda: list(installed))
    engines = Engines()
    robots = [large, prepared("a")]
    outcome = simulate_robots(WORLD, robots, ValidateRequest(engines=asked), "name", run=engines)
    assert [scene.engine for scene in engines.scenes] == list(taken or asked)
    found = [one for one in outcome.diagnostics if one.code == "SPN089"]
    assert [one.element for one in found] == (["large"] if taken else [])
    for one in found:
        names = {"mujoco": "MuJoCo", "dart": "DART"}
        assert " and ".join(names[engine] for engine in taken) in one.message


EXPLODES = {"energy_gain": 1e14}
NOWHERE = {"is_finite": False}


@pytest.mark.parametrize(
    ("asked", "unstable", "installed", "simulated_in", "passes"),
    [
        # Another engine is stable: the result is its.
        (["bullet"], {"bullet": EXPLODES}, ALL, ["bullet", "dart"], True),
        (["bullet"], {"bullet": NOWHERE}, ["bullet", "mujoco"], ["bullet", "mujoco"], True),
        (["mujoco"], {"mujoco": EXPLODES}, ALL, ["mujoco", "dart"], True),
        (ALL, {"bullet": EXPLODES, "mujoco": NOWHERE}, ALL, [*ALL, "dart"], True),
        # It is unstable, too, or there is none.
        (["bullet"], {"bullet": EXPLODES, "dart": NOWHERE}, ALL, ["bullet", "dart"], False),
        (["bullet"], {"bullet": EXPLODES}, ["bullet"], ["bullet"], False),
        # What Gazebo Sim's engine says counts.
        (["dart"], {"dart": EXPLODES}, ALL, ["dart"], False),
        (ALL, {"dart": EXPLODES}, ALL, ALL, False),
    ],
)
def test_what_one_engine_cannot_simulate_stably_another_one_does(
    monkeypatch: pytest.MonkeyPatch,
    *,
    asked: Sequence[str],
    unstable: Mapping[str, Mapping[str, Any]],
    installed: Sequence[str],
    simulated_in: Sequence[str],
    passes: bool,
) -> None:
    monkeypatch.setattr(robot_runs, "installed_engines", lambda: list(installed))
    engines = Engines(unstable)
    outcome = simulated(engines, "a", names=asked)
    assert [scene.engine for scene in engines.scenes] == list(simulated_in)
    (robot,) = outcome.robots
    assert robot.passed is passes
    codes = [one.code for one in outcome.diagnostics]
    if passes:
        assert codes == ["SPN108"]
        assert "cannot simulate the robot stably" in outcome.diagnostics[0].message
        assert [one.engine for one in robot.engines] == [
            engine for engine in dict.fromkeys(simulated_in) if engine not in unstable
        ]
    else:
        assert {"SPN052", "SPN061"} & set(codes)
        assert ("SPN108" in codes) is (installed == ["bullet"])


def test_an_unstable_robot_whose_second_engine_dies_stays_an_error() -> None:
    class DartDies(Engines):
        def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
            if "dart" in task:
                return Died(reason="took longer than 1 s", step="simulating 3 s", output="")
            return super().__call__(task, *arguments, **more)

    outcome = simulated(DartDies({"bullet": EXPLODES}), "a")
    assert [one.code for one in outcome.diagnostics] == ["SPN061"]
    assert not outcome.robots[0].passed


def test_engines_that_agree_are_not_reported() -> None:
    engines = Engines()
    outcome = simulated(engines, "a", names=ALL)
    assert outcome.diagnostics == ()
    assert [scene.engine for scene in engines.scenes] == list(ALL)


def test_an_engine_that_dies_is_no_pass() -> None:
    class OnlyDartDies(Engines):
        def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
            if "dart" in task:
                return Died(reason="took longer than 1 s", step="simulating 3 s", output="")
            return super().__call__(task, *arguments, **more)

    outcome = simulated(OnlyDartDies(), "a", names=ALL)
    (robot,) = outcome.robots
    assert not robot.passed
    assert [one.passed for one in robot.engines] == [True, True, False]
    (found,) = outcome.diagnostics
    assert found.code == "SPN031"
    assert found.message.startswith("In DART: The physics engine (DART) took longer")


def test_behaviors_are_given_to_their_robots_and_judged() -> None:
    """Of two robots one moves as it should; what cannot be tried fails its robot too."""
    arm = Joint(name="elbow", type=JointType.CONTINUOUS, parent="base", child="arm")
    robots = [
        replace(
            prepared(entity),
            lumped=Robot(
                name="r",
                root="base",
                links=tuple(Link(name=name, inertial=BODY) for name in ("base", "arm")),
                joints=(arm,),
            ),
        )
        for entity in ("a", "b", "c")
    ]

    def behavior(name: str, robot: str, joint: str = "elbow") -> Behavior:
        task = Reach(positions={joint: 0.5})
        return Behavior(name=name, task=task, seconds=1.0, robot=robot)

    settings = Settings(
        file=Path("wsgen.toml"),
        behaviors=(
            behavior("reaches", "a"),
            behavior("misses", "b"),
            behavior("has not", "c", "knee"),
            behavior("is not", "d"),
        ),
    )
    behavior_plan = plan_behaviors(settings, robots, simulator=None)
    assert [behavior_run.entity for behavior_run in behavior_plan.behavior_runs] == ["a", "b"]

    class Moves(Engines):
        def __call__(self, task: str, *arguments: Any, **more: Any) -> Answered | Died:
            answer = super().__call__(task, *arguments, **more)
            assert isinstance(answer, Answered)
            result = decode(answer.value, SceneResult)
            measured = [("reaches", 0.5), ("misses", 0.1), None]
            robot_runs = tuple(
                replace(
                    robot_run,
                    behaviors=(BehaviorMeasurement(one[0], (0.0, 0.0, 0.0), {"elbow": one[1]}),)
                    if one
                    else (),
                )
                for robot_run, one in zip(result.robot_runs, measured, strict=True)
            )
            return answered(replace(result, robot_runs=robot_runs))

    engines = Moves({"dart": {"mass": 2.0, "movable_joints": 1}})
    outcome = simulate_robots(
        WORLD,
        robots,
        ValidateRequest(engines=("dart",)),
        "n",
        run=engines,
        behavior_plan=behavior_plan,
    )
    assert [(one.entity, one.passed) for one in outcome.robots] == [
        ("a", True),
        ("b", False),
        ("c", False),
    ]
    assert [found.code for found in outcome.diagnostics] == ["SPN083", "SPN080", "SPN087"]
    assert [
        [(one.name, one.passed, one.positions) for one in robot.behaviors]
        for robot in outcome.robots
    ] == [
        [("reaches", True, {"elbow": 0.5})],
        [("misses", False, {"elbow": 0.1})],
        [("has not", False, None)],
    ]
    assert engines.scenes[0].behavior_runs == behavior_plan.behavior_runs

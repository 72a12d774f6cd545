"""How joints move in the real Gazebo Classic, and in the engines of wsgen.

`recorded/joints.json` was recorded with Debian 11's Gazebo 11.1: the positions of the joints (rad
or m) of each robot of `joint_cases.py`, every tenth of a second for three seconds after it was
spawned into an empty world; null where they are no numbers any more. `--regenerate` records it
anew.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic, recorded_in
from classic.joint_cases import CASES
from classic.worlds import not_followed
from simulation.conftest import CLASSES
from simulation.robots import VOID, spawned
from wsgen.checks.rules.joint_limits import unstable_damping
from wsgen.checks.rules.settings import STOPS
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.engines import ENGINES
from wsgen.simulation.run import missing_engines

if TYPE_CHECKING:
    from wsgen.checks.rules.settings import Setting
    from wsgen.model.robot import Robot

RECORDED = Path(__file__).with_name("recorded") / "joints.json"
LIVE = ("damping", "stop", "spring", "self-collide of one")  # asked in each run of the tests
LOOKS, EVERY = 30, 0.1  # s
SAME = 0.02  # of the farthest that the joint has moved
# The first joint hits its stop within a step, and throws the second one to its own.
HIT = {"two stops": 0.03}
NEAR = 2e-3  # rad or m
# Robots that move in another way, in all engines or in one, and why.
EXPLICIT = "Gazebo applies what the place or speed before a step asks for: the joint explodes"
IMPLICIT = "DART integrates springs implicitly, as in Gazebo Sim, which takes energy from them"


def of_setting(case: str, setting: Setting) -> dict[tuple[str, str], str]:
    """The differences of a case that a setting makes, as an entry of those below."""
    why, engines = not_followed(setting)
    return {(case, "" if len(engines) == len(ENGINES) else one): why for one in engines}


DIFFERENT = {
    ("too strong damping", ""): EXPLICIT,
    ("too stiff spring", ""): EXPLICIT,
    ("two stops", "dart"): "DART pushes back by 1 % of the way beyond a stop, ODE by 20 %",
    ("spring", "dart"): IMPLICIT,
    ("spring of a body in the air", "dart"): IMPLICIT,
    ("spring, implicit", ""): "Gazebo gives such a joint energy: a defect",
    **of_setting("soft stop", STOPS),
}
CLASSIC = replace(VOID, simulator="classic")
Positions = dict[str, list[float] | None]

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def ask(name: str, folder: Path) -> Positions:
    """How Gazebo Classic moves the joints."""
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text("<sdf version='1.6'><world name='w'/></sdf>")
    file.write_text(CASES[name])
    found: dict[str, list[Any]] = {}
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(file, "r")
        for _ in range(LOOKS):
            gazebo.run(EVERY)
            model = gazebo.state()["r"]
            is_there = all(None not in link["pose"] for link in model["links"].values())
            for joint, state in model["joints"].items():
                for axis in state["axes"]:
                    place = axis["position"][0]
                    found.setdefault(joint.removeprefix("r::"), []).append(
                        round(place, 4) if is_there and place is not None else None
                    )
    return {joint: None if None in places else places for joint, places in found.items()}


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("joints")
    return recorded_in(RECORDED, request, CASES, lambda name: ask(name, folder))


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    for joint, places in ask(name, tmp_path).items():
        assert places == pytest.approx(recorded[name][joint], abs=1e-3), joint


def model_of(name: str) -> Robot:
    file = Path("r.urdf")
    robot, _ = read_urdf(CASES[name], file=file)
    assert robot is not None
    return lump(robot, file=file, for_classic=True)[0]


def simulated(engine_name: str, name: str) -> dict[str, list[float]]:
    new_engine = getattr(
        importlib.import_module(f"wsgen.simulation.{engine_name}"), CLASSES[engine_name]
    )
    found: dict[str, list[float]] = {}
    with spawned(new_engine, model_of(name), world=CLASSIC) as engine:
        for _ in range(LOOKS):
            engine.advance(round(EVERY / engine.step_seconds))
            for joint, place in engine.joint_positions("e").items():
                found.setdefault(joint, []).append(place)
    return found


def is_same(ours: list[float], real: list[float] | None, share: float = SAME) -> bool:
    if real is None:
        return not all(map(math.isfinite, ours))
    bound = max(NEAR, share * max(map(abs, real)))
    return max(abs(one - other) for one, other in zip(ours, real, strict=True)) < bound


@pytest.mark.parametrize("engine", CLASSES)
@pytest.mark.parametrize("name", CASES)
def test_joints_move_as_in_gazebo_classic(name: str, engine: str, recorded: Any) -> None:
    if missing_engines([engine]):
        pytest.skip(f"{ENGINES[engine].title} is not installed")
    ours = simulated(engine, name)
    assert ours.keys() == recorded[name].keys()
    share = HIT.get(name, SAME)
    moves_so = all(is_same(ours[one], real, share) for one, real in recorded[name].items())
    assert moves_so == (not {(name, ""), (name, engine)} & DIFFERENT.keys())


def test_each_difference_is_of_a_case() -> None:
    assert {name for name, _ in DIFFERENT} <= CASES.keys()


@pytest.mark.parametrize("name", [name for name in CASES if "damping" in name])
def test_a_damper_that_is_too_strong_is_reported(name: str) -> None:
    robot, _ = read_urdf(CASES[name], file=None)
    assert robot is not None
    lumped, _ = lump(robot)
    assert lumped is not None
    found = list(unstable_damping(lumped, None, "classic"))
    assert bool(found) == (name == "too strong damping")

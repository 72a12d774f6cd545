"""What `gz joint` of the real Gazebo Classic does to joints, and what wsgen's efforts do.

`recorded/commands.json` was recorded with Debian 11's Gazebo 11.1: the positions of a joint (rad or
m) every tenth of a second for three seconds, from a message to the topic `joint_cmd` on. `force` is
an effort, `position` and `velocity` have the gains of a PID controller. `--regenerate` records it
anew.
"""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic, recorded_in
from classic.joint_cases import bar, dynamics, lift, limit
from simulation.conftest import CLASSES
from simulation.robots import VOID, spawned
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.live.nodes.simulator.plugins.joint_commands import Gains, GzPid
from wsgen.model.engines import ENGINES
from wsgen.simulation.controllers import effort_in_classic
from wsgen.simulation.run import missing_engines

if TYPE_CHECKING:
    from collections.abc import Mapping

RECORDED = Path(__file__).with_name("recorded") / "commands.json"
LIVE = ("effort beyond its limit", "PID of a position")  # asked in each run of the tests
LOOKS, EVERY = 30, 0.1  # s
CLASSIC = replace(VOID, simulator="classic")

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


class Command(NamedTuple):
    """A message for the joint j."""

    urdf: str
    kind: str  # force, position, velocity
    target: float  # N m or N; rad or m; rad/s or m/s
    gains: Mapping[str, float] = {}  # of Gazebo's message

    @property
    def message(self) -> str:
        if self.kind == "force":
            said = f"force_optional {{data: {self.target}}}"
        else:
            values = {"target": self.target, **self.gains}
            parts = (f"{name}_optional {{data: {value}}}" for name, value in values.items())
            said = f"{self.kind} {{{' '.join(parts)}}}"
        return f"name: 'r::j' axis: 0 {said}"


LEVEL = bar(dynamics(0.2), axis="0 0 1")  # nothing pulls it
DAMPED = bar(dynamics(2), axis="0 0 1")
WEAK = bar(limit(-3, 3, 2, 100) + dynamics(0.2), kind="revolute", axis="0 0 1")
SLOW = bar(limit(-9, 9, 20, 1) + dynamics(0.2), kind="revolute", axis="0 0 1")
ARM = bar(limit(-3, 3) + dynamics(6), kind="revolute")
WITH_INTEGRAL = {"p_gain": 30, "i_gain": 20, "i_max": 10, "i_min": -10}
# None has a gain of the change: what that does in the first step is not the same in two runs.
COMMANDS = {
    "effort": Command(LEVEL, "force", 0.5),
    "effort that lifts": Command(lift(limit(-2, 2) + dynamics(1)), "force", 15),
    "effort beyond its limit": Command(WEAK, "force", 20),
    "effort at the highest speed": Command(SLOW, "force", 5),
    "PID of a position": Command(DAMPED, "position", 1.0, {"p_gain": 10}),
    "PID that lifts": Command(ARM, "position", -0.5, WITH_INTEGRAL),
    "PID of a speed": Command(LEVEL, "velocity", 1.0, {"p_gain": 2}),
}


def ask(name: str, folder: Path) -> list[float]:
    """Where Gazebo Classic moves the joint."""
    command = COMMANDS[name]
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text("<sdf version='1.6'><world name='w'/></sdf>")
    file.write_text(command.urdf)
    places = []
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(file, "r")
        gazebo.ask("publish", "/r/joint_cmd", "ignition.msgs.JointCmd", command.message)
        for _ in range(LOOKS):
            gazebo.run(EVERY)
            (axis,) = gazebo.state()["r"]["joints"]["r::j"]["axes"]
            places.append(round(axis["position"][0], 4))
    return places


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("commands")
    return recorded_in(RECORDED, request, COMMANDS, lambda name: ask(name, folder))


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(name, tmp_path) == pytest.approx(recorded[name], abs=2e-3)


@pytest.mark.parametrize("engine_name", CLASSES)
@pytest.mark.parametrize("name", COMMANDS)
def test_efforts_move_joints_as_in_gazebo_classic(
    name: str, engine_name: str, recorded: Any
) -> None:
    if missing_engines([engine_name]):
        pytest.skip(f"{ENGINES[engine_name].title} is not installed")
    command = COMMANDS[name]
    robot, _ = read_urdf(command.urdf, file=Path("r.urdf"))
    assert robot is not None
    robot, _ = lump(robot, file=Path("r.urdf"))
    (joint,) = robot.movable_joints
    gains = {name.removesuffix("_gain"): value for name, value in command.gains.items()}
    pid = GzPid(Gains(**{"p": 0.0, "i": 0.0, "d": 0.0, **gains}))
    places = []
    new_engine = getattr(
        importlib.import_module(f"wsgen.simulation.{engine_name}"), CLASSES[engine_name]
    )
    with spawned(new_engine, robot, world=CLASSIC) as engine:
        for step in range(round(LOOKS * EVERY / engine.step_seconds)):
            place, speed = engine.joint_positions("e")["j"], engine.joint_velocities("e")["j"]
            effort = command.target
            if command.kind != "force":
                now = place if command.kind == "position" else speed
                effort = pid.command(now - command.target, engine.step_seconds)
            engine.set_efforts("e", {"j": effort_in_classic(joint, effort, speed)})
            engine.advance(1)
            if (step + 1) % round(EVERY / engine.step_seconds) == 0:
                places.append(engine.joint_positions("e")["j"])
    assert places == pytest.approx(recorded[name], abs=0.02 * max(map(abs, recorded[name])))

"""The physics engines: all that the other wings know of each, in one table."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable


class EngineSpec(NamedTuple):
    """One physics engine.

    Attributes:
        title: What its users call it.
        library: The module that it is; importing wsgen's module of the engine imports it.
        wheels: What pip calls its library, by preference.
        extra: That of wsgen which installs it; "": wsgen requires it where it has wheels.
        engine: The module and class that simulate with it (`simulation/engine.py`).
        tasks: The module with `simulate` and `serve`, which child processes call.
    """

    title: str
    library: str
    wheels: tuple[str, ...]
    extra: str
    engine: str
    tasks: str


# In the order of preference, by the names that --engine takes.
ENGINES = {
    "bullet": EngineSpec(
        title="PyBullet",
        library="pybullet",
        wheels=("pybullet", "pybullet-arm64"),
        extra="",
        engine="wsgen.simulation.bullet:BulletEngine",
        tasks="wsgen.pipeline.tasks.bullet",
    ),
    "mujoco": EngineSpec(
        title="MuJoCo",
        library="mujoco",
        wheels=("mujoco-core", "mujoco"),
        extra="mujoco",
        engine="wsgen.simulation.mujoco:MujocoEngine",
        tasks="wsgen.pipeline.tasks.mujoco",
    ),
    "dart": EngineSpec(
        title="DART",
        library="dartpy",
        wheels=("dartpy",),
        extra="dart",
        engine="wsgen.simulation.dart:DartEngine",
        tasks="wsgen.pipeline.tasks.dart",
    ),
}
# The user's own Gazebo has results beside theirs, and is no engine that sweeps or live runs take.
GAZEBO = "gazebo"
RESULT_NAMES = {**{name: spec.title for name, spec in ENGINES.items()}, GAZEBO: "Gazebo"}


def name_engines(engines: Iterable[str]) -> str:
    """The names of engines, as a sentence lists them."""
    *names, last = [RESULT_NAMES[engine] for engine in engines]
    return f"{', '.join(names)} and {last}" if names else last

"""What the child process of a simulation does, with whatever engine."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import announce
from wsgen.rendering.drawing import draw, recorder_for, remember
from wsgen.simulation.scene import robot_run_to_json
from wsgen.simulation.simulate import play

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.model.world import World
    from wsgen.rendering.recording import Recorder
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.scene import RobotRun, Scene


UNBUFFERED = 2  # _IONBF of C's stdio, on Linux and macOS


def simulate(scene: Scene, make_engine: Callable[[World], Engine]) -> dict[str, Any]:
    """Simulate the scene in an engine; `wsgen.simulation.run` makes a SimulationOutcome of it."""
    _let_last_words_out()
    engine = make_engine(scene.world)
    recorder = recorder_for(engine, scene)
    started = time.perf_counter()
    robot_runs, refused = play(engine, scene, announce, recorder)
    standing = remember(engine, scene, refused)
    if scene.behavior_runs:
        robot_runs = _try(engine, scene, robot_runs, recorder)
    simulated = time.perf_counter()
    drawn = draw(scene, refused, recorder, standing) if robot_runs else {}
    return {
        "robot_runs": [robot_run_to_json(robot_run) for robot_run in robot_runs],
        "refused": {entity: [why.reason, why.hint] for entity, why in refused.items()},
        **drawn,
        "seconds": {
            "simulate": simulated - started,
            "draw": time.perf_counter() - simulated,
        },
    }


def _try(
    engine: Engine, scene: Scene, robot_runs: list[RobotRun], recorder: Recorder | None
) -> list[RobotRun]:
    """The simulations with what the robots did beyond standing; most scenes load nothing for it."""
    from wsgen.simulation.behaviors import run_behaviors  # noqa: PLC0415

    if recorder is None:
        return run_behaviors(engine, scene, robot_runs, announce)
    return run_behaviors(
        engine, scene, robot_runs, announce, observe=recorder, begun=recorder.begin
    )


def _let_last_words_out() -> None:
    """Take the buffer from C's standard output: what is in it when the engine crashes is lost."""
    name = "__stdoutp" if sys.platform == "darwin" else "stdout"
    with suppress(OSError, ValueError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, UNBUFFERED, 0)

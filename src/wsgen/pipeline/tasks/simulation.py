"""What the child process of a simulation does, with whatever engine."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from wsgen.isolation.child import announce
from wsgen.rendering.drawing import Drawings, draw, recorder_for, remember
from wsgen.simulation.scene import SceneResult
from wsgen.simulation.simulate import run_scene

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsgen.model.world import World
    from wsgen.rendering.recording import Recorder
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.sampling import Sampler
    from wsgen.simulation.scene import RobotRun, Scene
    from wsgen.simulation.simulate import Observer


UNBUFFERED = 2  # _IONBF of C's stdio, on Linux and macOS


def simulate(scene: Scene, make_engine: Callable[[World], Engine]) -> SceneResult:
    """Simulate the scene in an engine."""
    unbuffer_output_of_c()
    engine = make_engine(scene.world)
    recorder = recorder_for(engine, scene)
    sampler = _sampler(engine, scene)
    observers = [observer for observer in (recorder, sampler) if observer is not None]
    observe = _observe_all(observers)
    started = time.perf_counter()
    robot_runs, refused = run_scene(engine, scene, announce, observe)
    standing = remember(engine, scene, refused)
    if scene.behavior_runs:
        robot_runs = _run_behaviors(engine, scene, robot_runs, observers)
    if sampler is not None:
        robot_runs = sampler.add_to(robot_runs)
    simulated = time.perf_counter()
    drawings = draw(scene, refused, recorder, standing) if robot_runs else Drawings()
    return SceneResult(
        robot_runs=tuple(robot_runs),
        refused=refused,
        picture=drawings.picture,
        world_picture=drawings.world_picture,
        video=drawings.video,
        view=drawings.seen(),
        seconds={"simulate": simulated - started, "draw": time.perf_counter() - simulated},
    )


def _sampler(engine: Engine, scene: Scene) -> Sampler | None:
    """What takes samples, if they are wanted; most scenes load nothing for it."""
    if not scene.samples:
        return None
    from wsgen.simulation.sampling import Sampler  # noqa: PLC0415

    return Sampler(engine, scene)


def _observe_all(observers: Sequence[Recorder | Sampler]) -> Observer | None:
    """One observer for all, as `run_scene` takes it."""
    if not observers:
        return None

    def observe(seconds: float, entities: Sequence[str]) -> None:
        for observer in observers:
            observer(seconds, entities)

    return observe


def _run_behaviors(
    engine: Engine,
    scene: Scene,
    robot_runs: list[RobotRun],
    observers: Sequence[Recorder | Sampler],
) -> list[RobotRun]:
    """The runs with what the robots did beyond standing; most scenes load nothing for it."""
    from wsgen.simulation.run_behaviors import run_behaviors  # noqa: PLC0415

    def begin(name: str, seconds: float) -> None:
        for observer in observers:
            observer.begin(name, seconds)

    return run_behaviors(
        engine, scene, robot_runs, announce, observe=_observe_all(observers), begun=begin
    )


def unbuffer_output_of_c() -> None:
    """Take the buffer from C's standard output: what is in it when the engine crashes is lost."""
    name = "__stdoutp" if sys.platform == "darwin" else "stdout"
    with suppress(OSError, ValueError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, UNBUFFERED, 0)

"""What the child processes of simulations and of sessions do, with whatever engine."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from wsgen.isolation import channel
from wsgen.isolation.child import announce
from wsgen.rendering.drawing import Drawings, draw, recorder_for, remember
from wsgen.simulation.running_scene import RunningScene
from wsgen.simulation.scene import SceneResult
from wsgen.simulation.simulate import run_scene

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from wsgen.isolation.channel import Endpoint
    from wsgen.model.world import World
    from wsgen.rendering.drawing import Recorder
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.sampling import Sampler
    from wsgen.simulation.scene import NotDrawn, Picture, RobotRun, Scene, Video
    from wsgen.simulation.session import Opened
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
    from wsgen.simulation.simulate import run_behaviors  # noqa: PLC0415

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


def serve(
    scene: Scene, remembered: float, endpoint: Endpoint, make_engine: Callable[[World], Engine]
) -> None:
    """Open the scene with the first command, and do what the others say."""
    unbuffer_output_of_c()
    _Server(scene, remembered, make_engine).serve(endpoint)


class _Server:
    """The commands of a session."""

    def __init__(
        self, scene: Scene, remembered: float, make_engine: Callable[[World], Engine]
    ) -> None:
        self._scene = scene
        self._remembered = remembered
        self._make_engine = make_engine
        self._commands: dict[str, Callable[..., object]] = {"open": self._open}

    def serve(self, endpoint: Endpoint) -> None:
        channel.serve(endpoint, self._commands)

    def _open(self) -> Opened:
        running = RunningScene(
            self._scene, self._make_engine, announce, remembered=self._remembered
        )
        self._commands |= {
            "reset": running.reset,
            "step": running.step,
            "watch": running.watch,
            "drive": running.drive,
            "hold": running.hold,
            "set_motors": running.set_motors,
            "release": running.release,
            "push": running.push,
            "measure": running.measure,
            "moved": running.moved,
            "contacts": running.contacts,
            "lowest_point": running.lowest_point,
            "picture": lambda file: self._picture(running, file),
            "record": lambda file: self._record(running, file),
        }
        return running.opened()

    @staticmethod
    def _picture(running: RunningScene, file: Path) -> Picture | NotDrawn:
        # Loading NumPy and Pillow would cost every session.
        from wsgen.rendering.drawing import draw_picture  # noqa: PLC0415

        return draw_picture(running, file)

    @staticmethod
    def _record(running: RunningScene, file: Path) -> Video | NotDrawn:
        from wsgen.rendering.drawing import draw_last_seconds  # noqa: PLC0415  as above

        return draw_last_seconds(running, file)

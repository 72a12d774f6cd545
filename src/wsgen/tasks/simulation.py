"""What the child process of a trial does, with whatever engine."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import announce
from wsgen.rendering.drawing import draw, recorder_for, remember
from wsgen.simulation.scene import trial_to_json
from wsgen.simulation.simulate import play

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.model.world import World
    from wsgen.rendering.recording import Recorder
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.scene import RobotTrial, Scene


UNBUFFERED = 2  # _IONBF of C's stdio, on Linux and macOS


def simulate(scene: Scene, make_engine: Callable[[World], Engine]) -> dict[str, Any]:
    """Play the scene in an engine; gives what `wsgen.simulation.run` makes a TrialOutcome of."""
    _let_last_words_out()
    engine = make_engine(scene.world)
    recorder = recorder_for(engine, scene)
    started = time.perf_counter()
    trials, refused = play(engine, scene, announce, recorder)
    standing = remember(engine, scene, refused)
    if scene.attempts:
        trials = _try(engine, scene, trials, recorder)
    simulated = time.perf_counter()
    drawn = draw(scene, refused, recorder, standing) if trials else {}
    return {
        "trials": [trial_to_json(trial) for trial in trials],
        "refused": {entity: [why.reason, why.hint] for entity, why in refused.items()},
        **drawn,
        "seconds": {
            "simulate": simulated - started,
            "draw": time.perf_counter() - simulated,
        },
    }


def _try(
    engine: Engine, scene: Scene, trials: list[RobotTrial], recorder: Recorder | None
) -> list[RobotTrial]:
    """The trials with what the robots did beyond standing; most scenes load nothing for it."""
    from wsgen.simulation.behaviors import try_behaviours  # noqa: PLC0415

    if recorder is None:
        return try_behaviours(engine, scene, trials, announce)
    return try_behaviours(engine, scene, trials, announce, observe=recorder, begun=recorder.begin)


def _let_last_words_out() -> None:
    """Take the buffer from C's standard output: what is in it when the engine crashes is lost."""
    name = "__stdoutp" if sys.platform == "darwin" else "stdout"
    with suppress(OSError, ValueError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, UNBUFFERED, 0)

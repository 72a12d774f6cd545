"""What the child process of a trial does."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import announce
from wsgen.simulation.bullet import BulletEngine
from wsgen.simulation.scene import trial_to_json
from wsgen.simulation.trial import play

if TYPE_CHECKING:
    from wsgen.simulation.scene import Scene

UNBUFFERED = 2  # _IONBF of C's stdio, on Linux and macOS


def simulate(scene: Scene) -> dict[str, Any]:
    """Play the scene in PyBullet; gives what `wsgen.simulation.run` makes a TrialOutcome of."""
    _let_last_words_out()
    started = time.perf_counter()
    engine = BulletEngine(scene.world)
    trials, refused = play(engine, scene, announce)
    simulated = time.perf_counter()
    tile, picture_problem = _draw(engine, scene) if trials else (None, None)
    return {
        "trials": [trial_to_json(trial) for trial in trials],
        "refused": {entity: why.reason for entity, why in refused.items()},
        "picture_tile": tile,
        "picture_problem": picture_problem,
        "seconds": {
            "simulate": simulated - started,
            "draw": time.perf_counter() - simulated,
        },
    }


def _draw(engine: BulletEngine, scene: Scene) -> tuple[float | None, str | None]:
    """Draw the picture that is wanted; gives what a square in it is, or why there is none."""
    if scene.picture is None:
        return None, None
    announce("drawing the picture")
    try:
        return engine.draw(scene.picture), None
    except Exception as error:  # noqa: BLE001  whatever it is, the trial counts without a picture
        return None, getattr(error, "strerror", None) or str(error) or repr(error)


def _let_last_words_out() -> None:
    """Take the buffer from C's standard output: what is in it when the engine crashes is lost."""
    name = "__stdoutp" if sys.platform == "darwin" else "stdout"
    with suppress(OSError, ValueError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, UNBUFFERED, 0)

"""What the child process of a trial does, with whatever engine."""

from __future__ import annotations

import ctypes
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import announce
from wsgen.model.transform import compose
from wsgen.simulation.scene import DRAWING, trial_to_json
from wsgen.simulation.trial import play

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsgen.model.pose import Pose
    from wsgen.model.robot import Visual
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.scene import Scene

UNBUFFERED = 2  # _IONBF of C's stdio, on Linux and macOS


def simulate(scene: Scene, make_engine: Callable[[World], Engine]) -> dict[str, Any]:
    """Play the scene in an engine; gives what `wsgen.simulation.run` makes a TrialOutcome of."""
    _let_last_words_out()
    engine = make_engine(scene.world)
    started = time.perf_counter()
    trials, refused = play(engine, scene, announce)
    simulated = time.perf_counter()
    tile, picture_problem = _draw(engine, scene, [*refused]) if trials else (None, None)
    return {
        "trials": [trial_to_json(trial) for trial in trials],
        "refused": {entity: [why.reason, why.hint] for entity, why in refused.items()},
        "picture_tile": tile,
        "picture_problem": picture_problem,
        "seconds": {
            "simulate": simulated - started,
            "draw": time.perf_counter() - simulated,
        },
    }


def _draw(engine: Engine, scene: Scene, refused: Sequence[str]) -> tuple[float | None, str | None]:
    """Draw the picture that is wanted; gives what a square in it is, or why there is none."""
    if scene.picture is None:
        return None, None
    announce(DRAWING)
    try:
        # NumPy's and Pillow's loading would cost every trial as much as its simulation does, and
        # where PyBullet has no wheels there is no picture.
        from wsgen.simulation import bullet_studio  # noqa: PLC0415

        seen: list[tuple[Visual, Pose]] = []
        corners: list[Vector] = []
        for robot in scene.robots:
            if robot.entity in refused:
                continue
            corners += engine.corners(robot.entity)
            poses = engine.link_poses(robot.entity)
            corners += [pose.xyz for pose in poses.values()]  # of parts that nothing can touch
            seen += [
                (visual, compose(poses[link.name], visual.pose_in_link))
                for link in robot.robot.links
                for visual in link.visuals
            ]
        return bullet_studio.draw(seen, corners, scene.picture), None
    except ImportError:
        return None, "PyBullet draws it, and has no wheel for this Python"
    except Exception as error:  # noqa: BLE001  whatever it is, the trial counts without a picture
        return None, getattr(error, "strerror", None) or str(error) or repr(error)


def _let_last_words_out() -> None:
    """Take the buffer from C's standard output: what is in it when the engine crashes is lost."""
    name = "__stdoutp" if sys.platform == "darwin" else "stdout"
    with suppress(OSError, ValueError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, UNBUFFERED, 0)

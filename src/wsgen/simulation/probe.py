"""A first, coarse shot: it shows how far bodies reach more closely than the boxes around them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsgen.simulation.framing import NEAREST, Size, eye_camera
from wsgen.simulation.picture import unproject

if TYPE_CHECKING:
    from collections.abc import Collection, Container, Mapping

    from wsgen.simulation.bullet_studio import Studio
    from wsgen.simulation.framing import Floats
    from wsgen.simulation.shot import Shot

PROBE = Size(480, 360)  # pixels
FEW = 40  # pixels; of what is thinner, the shot may have missed a part
MOST_SHOTS, GROWTH = 8, 3.0  # each from farther away, for what nobody knows the size of
CLOSER = 1.2  # how much more than has been found the last shot takes in


def seen_points(
    studio: Studio,
    numbers: Collection[int],
    around: Mapping[int, Floats],
    whole: Container[int],
    guess: Floats,
) -> Floats:
    """Points (n by 3, m, in the world) that bodies lie between.

    Args:
        studio: What they stand in.
        numbers: Which bodies.
        around: Points that each lies between; some may be missing.
        whole: Bodies of which those points are not of a box around them but their own.
        guess: Points (n by 3, m) about where the missing ones are. If they reach out of the shot,
            it is taken again from farther away.
    """
    missing = [body for body in numbers if body not in around]
    boxed = [body for body in numbers if body not in whole]
    points = np.vstack([guess, *around.values()])
    shots = [_shoot(studio, points, missing)]
    while not _is_complete(shots[-1], missing) and len(shots) < MOST_SHOTS:
        points = _widen(points, GROWTH)
        shots.append(_shoot(studio, points, missing))
    clear, seen = _reach(shots[-1], boxed)
    if len(shots) > 1 and clear:  # from so far away they were small; now it is known where they are
        clear, seen = _reach(_shoot(studio, _widen(seen, CLOSER), missing), boxed)
    unseen = [points for body, points in around.items() if body not in clear]
    return np.vstack([seen, *unseen, *([guess] if set(missing) - clear else [])])


def _shoot(studio: Studio, points: Floats, missing: Collection[int]) -> Shot:
    camera = eye_camera(points, PROBE, behind=points)
    if missing:  # they may be nearer or farther than what is known
        distance = math.dist(camera.eye, camera.target)
        camera = replace(camera, near=distance * NEAREST, far=distance / NEAREST)
    return studio.shoot(camera)


def _is_complete(shot: Shot, missing: Collection[int]) -> bool:
    """Whether bodies are seen, and do not reach out of the shot."""
    bodies = shot.body
    rim = np.concatenate([bodies[0], bodies[-1], bodies[:, 0], bodies[:, -1]])
    wanted = list(missing)
    return bool(np.isin(wanted, bodies).all() and not np.isin(rim, wanted).any())


def _widen(points: Floats, factor: float) -> Floats:
    middle = points.mean(axis=0)
    wider: Floats = middle + (points - middle) * factor
    return wider


def _reach(shot: Shot, numbers: Collection[int]) -> tuple[set[int], Floats]:
    """Which of the bodies are seen clearly, and all points that are seen of those."""
    clear = {body for body in numbers if np.count_nonzero(shot.body == body) >= FEW}
    rows, columns = np.nonzero(np.isin(shot.body, list(clear)))
    depth = shot.depth[rows, columns].astype(np.float64)
    return clear, unproject(shot, rows, columns, depth).T

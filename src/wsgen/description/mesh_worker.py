"""The child process that looks into mesh files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.description.mesh_content import BrokenMeshError, EnormousMeshError, refuse_triangles
from wsgen.description.mesh_reader import read_mesh
from wsgen.description.mesh_stl import write_stl
from wsgen.isolation.child import announce

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

CRASHING = 1e18  # m; squares of it are beyond single precision, in which engines calculate


class Request(NamedTuple):
    """A file to look into, and what it is used for."""

    path: str
    is_collision: bool
    is_visual: bool


def inspect(requests: Sequence[tuple[str, bool, bool]], folder: str) -> list[dict[str, Any]]:
    """Look into every file, given as fields of `Request`; announces the number of the one it is at.

    What PyBullet would read otherwise than Gazebo, or not at all, is written anew into `folder`:
    every COLLADA file for collisions, as its loader knows a part of the format alone and crashes
    on a good deal of it.

    Returns:
        For each file `problem` and `hint` if it cannot be used, and whether it `is_enormous`; else
        `triangles`, their number, `low` and `high`, the corners of the box around them (m,
        unscaled), `oddity`, and the files to take instead, `collision` and `visual`.
    """
    answers = []
    for number, request in enumerate(requests):
        announce(str(number))
        answers.append(_inspect(Request(*request), Path(folder, f"{number}.stl")))
    return answers


def _inspect(request: Request, spare: Path) -> dict[str, Any]:
    file = Path(request.path)
    try:
        content = read_mesh(file)
        low, high = _bounds(content.corners)
    except BrokenMeshError as error:
        is_enormous = isinstance(error, EnormousMeshError)
        return {"problem": error.problem, "hint": error.hint, "is_enormous": is_enormous}
    except OSError as error:
        return _refuse(f"cannot be read ({error.strerror})", "Check that it is there for you.")
    except MemoryError:
        return _refuse("needs more memory to be read than it may have", "Reduce it.")
    is_collision_plain = content.is_plain and file.suffix.lower() != ".dae"
    is_rewritten = (request.is_collision and not is_collision_plain) or (
        request.is_visual and not content.is_plain
    )
    if is_rewritten:
        write_stl(content.corners, spare)
    return {
        "problem": None,
        "triangles": len(content.corners),
        "low": low,
        "high": high,
        "oddity": content.oddity,
        "collision": str(file if is_collision_plain else spare),
        "visual": str(file if content.is_plain else spare),
    }


def _refuse(problem: str, hint: str) -> dict[str, Any]:
    return {"problem": problem, "hint": hint, "is_enormous": False}


def _bounds(corners: NDArray[Any]) -> tuple[list[float], list[float]]:
    """The corners of the box around triangles, m."""
    if not len(corners):
        raise BrokenMeshError("has no triangle: Gazebo and PyBullet leave it out without a word")
    refuse_triangles(len(corners))
    points = corners.reshape(-1, 3)
    # A column at a time: over rows of three numpy is twenty times as slow.
    low = [float(points[:, axis].min()) for axis in range(3)]
    high = [float(points[:, axis].max()) for axis in range(3)]
    if not np.isfinite([*low, *high]).all() or max(-min(low), *high) > CRASHING:
        raise BrokenMeshError(
            "has a corner that is at no finite place: PyBullet crashes on it or leaves it out"
        )
    return low, high

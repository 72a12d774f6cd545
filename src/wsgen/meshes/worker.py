"""The child process that looks into mesh files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.isolation.child import announce
from wsgen.meshes.appearance import SceneRenderer, Showing
from wsgen.meshes.content import BrokenMeshError, EnormousMeshError, bounds_of, refuse_triangles
from wsgen.meshes.reader import read_mesh
from wsgen.meshes.stl import write_stl

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


CRASHING = 1e18  # m; squares of it are beyond single precision, in which engines calculate


class Request(NamedTuple):
    """A file to look into, and what it is used for."""

    path: str
    is_collision: bool
    is_visual: bool  # seen, and nobody asked for its look
    showings: Sequence[Sequence[Any]] = ()  # fields of `Showing`: the looks that are asked for


def inspect(requests: Sequence[Sequence[Any]], folder: str) -> list[dict[str, Any]]:
    """Look into every file, given as fields of `Request`; announces the number of the one it is at.

    What PyBullet would read otherwise than Gazebo, or not at all, is written anew into `folder`:
    every COLLADA file for collisions, as its loader knows a part of the format alone and crashes
    on a good deal of it.

    Returns:
        For each file `problem` and `hint` if it cannot be used, and whether it `is_enormous`; else
        `triangles`, their number, `low` and `high`, the corners of the box around them (m,
        unscaled), `oddity`, and the files to take instead, `collision` and `visual`; `looks`, a
        list of fields of `Look` for each of the request's showings, and `complaints`, the fields of
        each `Complaint`.
    """
    answers = []
    scene_renderer = SceneRenderer(Path(folder))
    asked = [Request(*fields) for fields in requests]
    for number, request in enumerate(asked):
        announce(str(number))
        answers.append(_inspect(request, number, Path(folder), scene_renderer))
    looks = scene_renderer.hang()
    for number, (answer, request) in enumerate(zip(answers, asked, strict=True)):
        answer["looks"] = [looks.get((number, _showing(one)), []) for one in request.showings]
    return answers


def _inspect(
    request: Request, number: int, folder: Path, scene_renderer: SceneRenderer
) -> dict[str, Any]:
    file, spare = Path(request.path), folder / f"{number}.stl"
    try:
        content = read_mesh(file, with_look=bool(request.showings))
        low, high = _bounds(content.corners)
        complaints = scene_renderer.add(number, file, content, map(_showing, request.showings))
    except BrokenMeshError as error:
        is_enormous = isinstance(error, EnormousMeshError)
        return {"problem": error.problem, "hint": error.hint, "is_enormous": is_enormous}
    except OSError as error:
        return _refuse(f"cannot be read ({error.strerror})", "Check that it is there for you.")
    except MemoryError:
        return _refuse("needs more memory to be read than it may have", "Reduce it.")
    if content.cleaned is not None:
        file = folder / f"{number}.obj"
        file.write_bytes(content.cleaned)
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
        "complaints": complaints,
    }


def _showing(fields: Sequence[Any]) -> Showing:
    is_painted, scale, times = fields
    return Showing(is_painted, (scale[0], scale[1], scale[2]), times)


def _refuse(problem: str, hint: str) -> dict[str, Any]:
    return {"problem": problem, "hint": hint, "is_enormous": False}


def _bounds(corners: NDArray[Any]) -> tuple[list[float], list[float]]:
    """The corners of the box around triangles, m."""
    if not len(corners):
        raise BrokenMeshError("has no triangle: Gazebo and PyBullet leave it out without a word")
    refuse_triangles(len(corners))
    low, high = bounds_of(corners)
    if not np.isfinite([*low, *high]).all() or max(-min(low), *high) > CRASHING:
        raise BrokenMeshError(
            "has a corner that is at no finite place: PyBullet crashes on it or leaves it out"
        )
    return low, high

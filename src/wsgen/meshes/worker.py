"""The child process that inspects mesh files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.isolation.child import announce
from wsgen.meshes.appearance import AppearanceWriter
from wsgen.meshes.content import BrokenMeshError, EnormousMeshError, bounds_of, refuse_triangles
from wsgen.meshes.reader import read_mesh
from wsgen.meshes.requests import InspectedMesh, MeshRequest, UnusableMesh
from wsgen.meshes.stl import write_stl

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.model.transform import Vector


CRASHING = 1e18  # m; squares of it are beyond single precision, in which engines calculate


def inspect(requests: Sequence[MeshRequest], folder: Path) -> list[InspectedMesh | UnusableMesh]:
    """Inspect every file; announces the number of the one it is at.

    What PyBullet would not read, or not as Gazebo does, is rewritten into `folder`: every COLLADA
    file for collisions, as PyBullet's loader knows only a part of the format and crashes on much of
    it.
    """
    answers = []
    writer = AppearanceWriter(folder)
    for number, request in enumerate(requests):
        announce(str(number))
        answers.append(_inspect(request, number, folder, writer))
    colored = writer.write()
    return [
        replace(
            answer,
            colored=tuple(tuple(colored.get((number, one), ())) for one in request.showings),
        )
        if isinstance(answer, InspectedMesh)
        else answer
        for number, (answer, request) in enumerate(zip(answers, requests, strict=True))
    ]


def _inspect(
    request: MeshRequest, number: int, folder: Path, writer: AppearanceWriter
) -> InspectedMesh | UnusableMesh:
    file, rewritten = Path(request.path), folder / f"{number}.stl"
    try:
        content = read_mesh(file, with_materials=bool(request.showings))
        low, high = _bounds(content.corners)
        problems = writer.add(number, file, content, request.showings)
    except BrokenMeshError as error:
        is_enormous = isinstance(error, EnormousMeshError)
        return UnusableMesh(problem=error.problem, hint=error.hint, is_enormous=is_enormous)
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        return UnusableMesh(problem=problem, hint="Check that the file exists and is readable.")
    except MemoryError:
        problem = "needs more memory to be read than wsgen allows"
        return UnusableMesh(problem=problem, hint="Reduce its triangles.")
    if content.cleaned is not None:
        file = folder / f"{number}.obj"
        file.write_bytes(content.cleaned)
    is_collision_plain = content.is_plain and file.suffix.lower() != ".dae"
    is_rewritten = (request.is_collision and not is_collision_plain) or (
        request.is_visual and not content.is_plain
    )
    if is_rewritten:
        write_stl(content.corners, rewritten)
    return InspectedMesh(
        triangles=len(content.corners),
        low=low,
        high=high,
        inconsistency=content.inconsistency,
        collision=str(file if is_collision_plain else rewritten),
        visual=str(file if content.is_plain else rewritten),
        material_problems=tuple(problems),
    )


def _bounds(corners: NDArray[Any]) -> tuple[Vector, Vector]:
    """The corners of the box around triangles, m."""
    if not len(corners):
        raise BrokenMeshError("has no triangle: Gazebo and PyBullet leave it out without a message")
    refuse_triangles(len(corners))
    low, high = bounds_of(corners)
    if not np.isfinite([*low, *high]).all() or max(-min(low), *high) > CRASHING:
        raise BrokenMeshError(
            "has a vertex with an infinite, enormous or undefined coordinate: PyBullet crashes on "
            "it or leaves it out"
        )
    return low, high

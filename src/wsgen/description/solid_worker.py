"""The child process that makes meshes of the shapes that no engine has."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.description.mesh_content import BrokenMeshError
from wsgen.description.mesh_stl import write_stl
from wsgen.description.solid_extrusion import extrusion_triangles
from wsgen.description.solid_heightmap import heightmap_surface
from wsgen.description.solid_primitives import cone_triangles, ellipsoid_triangles
from wsgen.isolation.child import announce
from wsgen.model.robot import Ellipsoid, Extrusion, Heightmap

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Triangulated


def build(shapes: Sequence[Triangulated], folder: str) -> list[dict[str, Any]]:
    """Write a binary STL file of each shape into a folder.

    Announces the number of the shape it is at.

    Returns:
        For each shape its file, `path`, and `low` and `high`, the corners of the box around it (m);
        for a heightmap also `pixels` on a side of the image and `rows` of corners. What nothing
        can be made of has no `path`, but a `problem`, which goes on after its name, and a `hint`.
    """
    answers = []
    for number, shape in enumerate(shapes):
        announce(str(number))
        try:
            answers.append(_write(shape, Path(folder, f"{number}.stl")))
        except BrokenMeshError as error:
            answers.append({"path": None, "problem": error.problem, "hint": error.hint})
    return answers


def _write(shape: Triangulated, file: Path) -> dict[str, Any]:
    more: dict[str, Any] = {}
    if isinstance(shape, Heightmap):
        surface = heightmap_surface(shape)
        corners: NDArray[Any] = surface.corners
        more = {"pixels": surface.pixels, "rows": surface.rows}
    elif isinstance(shape, Extrusion):
        corners = extrusion_triangles(shape)
    elif isinstance(shape, Ellipsoid):
        corners = ellipsoid_triangles(shape)
    else:
        corners = cone_triangles(shape)
    write_stl(corners, file)
    # A column at a time: over rows of three numpy is twenty times as slow.
    columns = [corners[..., axis].astype(np.float32) for axis in range(3)]
    return {
        "problem": None,
        "path": str(file),
        "low": [float(column.min()) for column in columns],
        "high": [float(column.max()) for column in columns],
        **more,
    }

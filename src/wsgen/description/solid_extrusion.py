"""Outlines that are extruded, as triangles. The one place that knows Shapely."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from wsgen.description.mesh_content import BrokenMeshError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsgen.model.robot import Extrusion

DRAW_ANEW = "Draw each outline as a simple polygon that touches neither itself nor another."


def extrusion_triangles(extrusion: Extrusion) -> NDArray[Any]:
    """Its surface, shape (n, 3, 3), m, counter-clockwise seen from outside.

    Raises:
        BrokenMeshError: Outlines touch or cross themselves or each other; Gazebo makes nothing of
            such ones.
    """
    rings = [shapely.Polygon(outline) for outline in extrusion.outlines]
    for number, ring in enumerate(rings, 1):
        if not ring.is_valid or ring.area == 0:
            raise BrokenMeshError(
                f"has an outline, number {number}, that encloses no area or crosses itself "
                f"({shapely.is_valid_reason(ring)})",
                hint=DRAW_ANEW,
            )
    if any(one.boundary.intersects(other.boundary) for one, other in combinations(rings, 2)):
        raise BrokenMeshError("has outlines that touch or cross each other", hint=DRAW_ANEW)
    # What is inside of an even number of them is outside.
    inside: Any = rings[0]
    for ring in rings[1:]:
        inside = shapely.symmetric_difference(inside, ring)
    area = shapely.orient_polygons(inside)
    floor = _floor(area)
    top = np.concatenate([floor, np.full((*floor.shape[:2], 1), extrusion.height)], axis=2)
    bottom = np.concatenate([floor[:, ::-1], np.zeros((*floor.shape[:2], 1))], axis=2)
    return np.concatenate([top, bottom, *_walls(area, extrusion.height)])


def _floor(area: Any) -> NDArray[Any]:
    """The area as triangles in the plane, shape (n, 3, 2), counter-clockwise."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    return np.array([shapely.get_coordinates(shapely.orient_polygons(t))[:3] for t in triangles])


def _walls(area: Any, height: float) -> Iterator[NDArray[Any]]:
    """Above the rings of the area; it is to the left of each of them."""
    up = np.array([0.0, 0.0, height])
    for ring in shapely.get_rings(shapely.get_parts(area)):
        points = shapely.get_coordinates(ring)  # the last is the first again
        low = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
        high = low + up
        yield np.stack([low[:-1], low[1:], high[1:]], axis=1)
        yield np.stack([low[:-1], high[1:], high[:-1]], axis=1)

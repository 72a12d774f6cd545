"""How far shapes reach down."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import Box, Capsule, Cylinder, Primitive, Sphere
from wsgen.model.transform import rotation_of_rpy

if TYPE_CHECKING:
    from wsgen.model.pose import Pose
    from wsgen.model.robot import Geometry


def lowest_point(geometry: Geometry, pose_in_world: Pose) -> float | None:
    """The z of the lowest point of a primitive, m; None for others, whose points are in files."""
    x, y, z = (abs(part) for part in rotation_of_rpy(pose_in_world.rpy)[2])
    if not isinstance(geometry, Primitive):
        return None
    if isinstance(geometry, Box):
        reach = sum(part * edge / 2 for part, edge in zip((x, y, z), geometry.size, strict=True))
    elif isinstance(geometry, Sphere):
        reach = geometry.radius
    elif isinstance(geometry, Capsule):
        reach = z * geometry.length / 2 + geometry.radius
    else:
        reach = _of_cylinder(geometry, math.hypot(x, y), z)
    return pose_in_world.xyz[2] - reach


def _of_cylinder(cylinder: Cylinder, across: float, along: float) -> float:
    return along * cylinder.length / 2 + across * cylinder.radius

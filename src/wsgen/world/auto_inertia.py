"""`<inertial auto="true">`: mass and inertia from the collisions, since SDF 1.11."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.inertia import about_link_axes, moved, of_solid
from wsgen.model.pose import Pose
from wsgen.model.robot import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Heightmap,
    Inertial,
    Mesh,
    Sphere,
)
from wsgen.world.values import number, optional_number
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.robot import Collision, Geometry
    from wsgen.world.source import Source, Version
    from wsgen.xmltree import Element

SINCE: Version = (1, 11)
HEAVIEST = 1e30  # kg; more is a slip, and its inertia would overflow
WATER = 1000.0  # kg/m³, what SDF takes where no density is said


def is_automatic(source: Source, inertial: Element) -> bool:
    """Whether Gazebo computes this inertia itself."""
    return source.version >= SINCE and inertial.get("auto") in {"true", "1"}


def computed(
    source: Source, link: Element, inertial: Element, collisions: Sequence[Collision]
) -> Inertial | None:
    """The inertial of a link from its collisions; None where they have no volume.

    A mesh, an extrusion or a heightmap adds nothing, which is reported. The centre of mass of a
    cone is taken for half way up, as sdformat 15 does. A mass that is given scales the whole, as in
    Gazebo Sim since Ionic.
    """
    density = number(source, inertial, "density", default=WATER)
    densities = {
        element.get("name"): number(source, element, "density", default=density)
        for element in children(link, "collision")
    }
    if any(isinstance(shape.geometry, Mesh | Extrusion | Heightmap) for shape in collisions):
        source.warning(
            "WLD040",
            "The inertia is to be computed from a mesh, polyline or heightmap: "
            "the trial takes its other shapes alone.",
            at=inertial,
            hint="Give mass and inertia in numbers.",
        )
    parts = [
        _part(collision, max(0.0, densities.get(collision.name, density)))
        for collision in collisions
    ]
    mass = sum(part.mass for part in parts)
    if not 0 < mass < HEAVIEST:
        return None
    centre = _centre(parts, mass)
    sums = [0.0] * 6
    for part in parts:
        x, y, z = (at - to for at, to in zip(part.pose_in_link.xyz, centre, strict=True))
        about_centre = moved(about_link_axes(part), part.mass, (x, y, z))
        sums = [a + b for a, b in zip(sums, about_centre, strict=True)]
    given = optional_number(source, inertial, "mass")
    scale = 1.0 if given is None or given <= 0 else given / mass
    ixx, ixy, ixz, iyy, iyz, izz = (moment * scale for moment in sums)
    return Inertial(
        mass=mass * scale,
        pose_in_link=Pose(xyz=centre),
        inertia=(ixx, ixy, ixz, iyy, iyz, izz),
    )


def _part(collision: Collision, density: float) -> Inertial:
    mass = density * _volume(collision.geometry)
    xx, yy, zz = of_solid(collision.geometry, mass) or (0.0, 0.0, 0.0)
    return Inertial(
        mass=mass, pose_in_link=collision.pose_in_link, inertia=(xx, 0.0, 0.0, yy, 0.0, zz)
    )


def _centre(parts: Sequence[Inertial], mass: float) -> tuple[float, float, float]:
    x, y, z = (
        sum(part.mass * part.pose_in_link.xyz[axis] for part in parts) / mass for axis in range(3)
    )
    return (x, y, z)


def _volume(geometry: Geometry) -> float:
    """In m³; 0 for what is made of triangles."""
    if isinstance(geometry, Box):
        return math.prod(geometry.size)
    if isinstance(geometry, Sphere | Ellipsoid):
        radii = (geometry.radius,) * 3 if isinstance(geometry, Sphere) else geometry.radii
        return 4 / 3 * math.pi * math.prod(radii)
    if isinstance(geometry, Cylinder | Cone):
        share = 1 if isinstance(geometry, Cylinder) else 1 / 3
        return share * math.pi * geometry.radius**2 * geometry.length
    if isinstance(geometry, Capsule):
        return math.pi * geometry.radius**2 * (geometry.length + 4 / 3 * geometry.radius)
    return 0.0

"""`<link>` and `<inertial>` of SDF. Everything is seen from the link's own frame.

`<inertial auto="true">`: mass and inertia from the collisions, since SDF 1.11.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.inertia import about_link_axes, is_possible, moved, of_solid, principal_moments
from wsgen.model.robot import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Extrusion,
    GazeboTag,
    Heightmap,
    Inertial,
    Link,
    Mesh,
    Sphere,
)
from wsgen.model.transform import Pose
from wsgen.sdf.shapes import ShapeReader
from wsgen.sdf.source import line_of
from wsgen.sdf.values import first, number, optional_number, read_pose, truth
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.robot import Collision, Geometry
    from wsgen.sdf.frames import Node
    from wsgen.sdf.includes import Includes
    from wsgen.sdf.source import Source, Version
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

    A mesh, an extrusion or a heightmap adds nothing, which is reported. The center of mass of a
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
            "the simulation takes its other shapes alone.",
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
    center = _center(parts, mass)
    sums = [0.0] * 6
    for part in parts:
        x, y, z = (at - to for at, to in zip(part.pose_in_link.xyz, center, strict=True))
        about_center = moved(about_link_axes(part), part.mass, (x, y, z))
        sums = [a + b for a, b in zip(sums, about_center, strict=True)]
    given = optional_number(source, inertial, "mass")
    scale = 1.0 if given is None or given <= 0 else given / mass
    ixx, ixy, ixz, iyy, iyz, izz = (moment * scale for moment in sums)
    return Inertial(
        mass=mass * scale,
        pose_in_link=Pose(xyz=center),
        inertia=(ixx, ixy, ixz, iyy, iyz, izz),
    )


def _part(collision: Collision, density: float) -> Inertial:
    mass = density * _volume(collision.geometry)
    xx, yy, zz = of_solid(collision.geometry, mass) or (0.0, 0.0, 0.0)
    return Inertial(
        mass=mass, pose_in_link=collision.pose_in_link, inertia=(xx, 0.0, 0.0, yy, 0.0, zz)
    )


def _center(parts: Sequence[Inertial], mass: float) -> tuple[float, float, float]:
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


MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
# What SDF gives a link that says nothing: 1 kg, and the inertia of something 2.4 m large.
DEFAULT_INERTIAL = Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))


class Body(NamedTuple):
    """A link, with what the model of a robot has no place for."""

    link: Link
    tag: GazeboTag | None  # its sensors


def read_body(includes: Includes, node: Node, name: str) -> Body:
    """The link at a node, under a name that is unique in the outermost model."""
    source, element = node.source, node.element
    shapes = ShapeReader(source, includes, name)
    collisions = shapes.collisions(element)
    sensors = tuple(sensor.get("name") or "" for sensor in children(element, "sensor"))
    link = Link(
        name=name,
        inertial=_read_inertial(node, name, collisions),
        visuals=shapes.visuals(element),
        collisions=collisions,
        self_collide=truth(source, element, "self_collide", default=node.scope.self_collide),
        gravity=truth(source, element, "gravity", default=True),
        velocity_decay=max(
            number(source, element, "velocity_decay", "linear", default=0.0),
            number(source, element, "velocity_decay", "angular", default=0.0),
        ),
        line=line_of(element),
    )
    tag = GazeboTag(reference=name, sensors=sensors, line=line_of(element)) if sensors else None
    return Body(link, tag)


def _read_inertial(node: Node, name: str, collisions: Sequence[Collision]) -> Inertial | None:
    source, link = node.source, node.element
    element = first(link, "inertial")
    if element is None:
        if not node.scope.is_static:
            source.lacking(
                "WLD035",
                f"The link `{name}` has no <inertial>: Gazebo gives it 1 kg and 1 kg m².",
                at=link,
                name="inertial",
                hint="Give it its own mass and inertia, or make the model static.",
            )
        return DEFAULT_INERTIAL
    if is_automatic(source, element):
        automatic = computed(source, link, element, collisions)
        if automatic is not None:
            return automatic
    mass = optional_number(source, element, "mass")
    pose, relative_to = read_pose(source, element)
    if relative_to:
        source.warning(
            "WLD020",
            f"The pose of the inertia is relative to `{relative_to}`; "
            "it is taken as relative to its link.",
            at=element,
            hint="Write the pose as seen from the link, without relative_to.",
        )
    inertial = Inertial(
        mass=1.0 if mass is None else mass, pose_in_link=pose, inertia=_inertia(source, element)
    )
    _check(source, element, name, inertial, is_static=node.scope.is_static)
    return inertial if inertial.mass >= 0 else None


def _check(
    source: Source, element: Element, name: str, inertial: Inertial, *, is_static: bool
) -> None:
    """Report a mass or an inertia that no body has."""
    if inertial.mass < 0:
        source.error(
            "WLD036",
            f"The mass of the link `{name}` is negative ({inertial.mass:g} kg).",
            at=element,
            hint="Give the link its mass in kilograms.",
        )
        return
    if inertial.mass == 0 and not is_static:
        source.warning(
            "WLD041",
            f"The link `{name}` has mass 0: an engine holds it still, or cannot move it.",
            at=element,
            hint="Give it a mass, or make the model static.",
        )
    if not is_possible(inertial.inertia):
        low, middle, high = principal_moments(inertial.inertia)
        source.error(
            "WLD037",
            f"No body has the inertia of the link `{name}`: its principal moments are "
            f"{low:.4g}, {middle:.4g} and {high:.4g} kg m².",
            at=element,
            hint="Each must be positive, and none larger than the other two together. Compute it "
            "from mass and shape, or export it from CAD about the center of mass.",
        )


def _inertia(source: Source, inertial: Element) -> tuple[float, float, float, float, float, float]:
    xx, xy, xz, yy, yz, zz = (
        number(source, inertial, "inertia", moment, default=default)
        for moment, default in zip(MOMENTS, DEFAULT_INERTIAL.inertia, strict=True)
    )
    return (xx, xy, xz, yy, yz, zz)

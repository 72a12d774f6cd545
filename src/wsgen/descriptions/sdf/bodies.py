"""`<link>` and `<inertial>` of SDF, all in the link's own frame.

Since SDF 1.11, `<inertial auto="true">` computes mass and inertia from the collisions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import IMPOSSIBLE_INERTIA, NEGATIVE_MASS
from wsgen.descriptions.sdf.shapes import FRAME_IGNORED, ShapeReader
from wsgen.descriptions.sdf.source import line_of
from wsgen.descriptions.sdf.values import first, number, optional_number, read_pose, truth
from wsgen.diagnostics import Measured, Rule, Severity
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
    Sensor,
    Sphere,
)
from wsgen.model.transform import Pose
from wsgen.text.xmltree import child_texts, children

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.descriptions.sdf.frames import Node
    from wsgen.descriptions.sdf.includes import Includes
    from wsgen.descriptions.sdf.source import Source, Version
    from wsgen.model.robot import Collision, Geometry
    from wsgen.text.xmltree import Element


DEFAULT_INERTIA = Rule(
    code="WLD035",
    name="default-inertia",
    severity=Severity.WARNING,
    severity_varies="information in a model without joints",
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A link of a model that can move has no `<inertial>`.",
    why="Gazebo uses 1 kg and 1 kg m², which fits a body of about 2.4 m. A small link is then much "
    "too heavy and turns much too slowly.",
    example='<link name="arm">\n  <collision name="collision">...</collision>\n</link>',
    instead="""<link name="arm">
  <inertial>
    <mass>0.2</mass>
    <inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.0001</izz></inertia>
  </inertial>
  <collision name="collision">...</collision>
</link>""",
)

INERTIA_OF_MESH = Rule(
    code="WLD040",
    name="inertia-of-mesh",
    severity=Severity.WARNING,
    summary="Gazebo computes the inertia of a link from a mesh, a polyline or a heightmap.",
    what='Looks at `<inertial auto="true">` since SDF 1.11, where Gazebo computes mass and '
    "inertia from the collisions.",
    why="The simulation ignores such shapes and computes the inertia from the other shapes of "
    "the link: the robot is lighter than in Gazebo.",
    example='<inertial auto="true"/>\n<collision name="c">\n  <geometry><mesh>...</mesh>',
    instead="<inertial>\n  <mass>0.2</mass>\n  <inertia>...</inertia>\n</inertial>",
)

MASSLESS_MODEL_LINK = Rule(
    code="WLD041",
    name="massless-model-link",
    severity=Severity.WARNING,
    severity_varies="an error in Gazebo Classic",
    measured=Measured(classic="crashes", sim="accepts it"),
    summary="A link of a model that can move has mass 0.",
    why="Physics engines hold such a link in place or cannot move it, and its joints may become "
    "unstable. The server of Gazebo Classic ends with a world that has such a link.",
    example="<mass>0</mass>",
    instead="<mass>0.2</mass>",
)

SINCE: Version = (1, 11)
HEAVIEST = 1e30  # kg; more is a mistake, and its inertia would overflow
WATER = 1000.0  # kg/m³, the default of SDF


def is_automatic(source: Source, inertial: Element) -> bool:
    """Whether Gazebo computes this inertia itself."""
    return source.version >= SINCE and inertial.get("auto") in {"true", "1"}


def computed(
    source: Source, link: Element, inertial: Element, collisions: Sequence[Collision]
) -> Inertial | None:
    """The inertial of a link from its collisions; None if they have no volume.

    A mesh, an extrusion or a heightmap adds nothing, which is reported. The center of mass of a
    cone is at half its height, as in sdformat 15. An explicit mass scales the result, as in Gazebo
    Sim since Ionic.
    """
    density = number(source, inertial, "density", default=WATER)
    densities = {
        element.get("name"): number(source, element, "density", default=density)
        for element in children(link, "collision")
    }
    if any(isinstance(shape.geometry, Mesh | Extrusion | Heightmap) for shape in collisions):
        source.report(
            INERTIA_OF_MESH,
            "The inertia is computed from a mesh, a polyline or a heightmap: "
            "the simulation uses only the other shapes of the link.",
            at=inertial,
            hint="Write mass and inertia as numbers.",
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
    """In m³; 0 for shapes that are made of triangles."""
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
# What SDF gives a link without <inertial>: 1 kg, and the inertia of a body of 2.4 m.
DEFAULT_INERTIAL = Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))


class Body(NamedTuple):
    """A link, and its sensors, for which `Link` has no field."""

    link: Link
    tag: GazeboTag | None  # the sensors


def read_body(includes: Includes, node: Node, name: str) -> Body:
    """The link at a node, under a name that is unique in the outermost model."""
    source, element = node.source, node.element
    shapes = ShapeReader(source, includes, name)
    collisions = shapes.collisions(element)
    sensors = tuple(
        Sensor(
            name=sensor.get("name") or "",
            kind=sensor.get("type") or "",
            values=child_texts(sensor),
            line=line_of(sensor),
        )
        for sensor in children(element, "sensor")
    )
    link = Link(
        name=name,
        inertial=_read_inertial(node, name, collisions),
        visuals=shapes.visuals(element),
        collisions=collisions,
        self_collide=truth(source, element, "self_collide", default=node.scope.self_collide),
        gravity=truth(source, element, "gravity", default=True),
        is_kinematic=truth(source, element, "kinematic", default=False),
        velocity_decay=(
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
            # A single box of 1 kg is often what is meant; a sensor of 1 kg on a robot is not.
            counts = any(node.scope.own("joint")) or (link, "inertial") in source.misspelled
            source.report_missing(
                DEFAULT_INERTIA,
                f"The link `{name}` has no <inertial>: Gazebo gives it 1 kg and 1 kg m².",
                at=link,
                child="inertial",
                hint="Add an <inertial> with mass and inertia, or make the model static.",
                severity=Severity.WARNING if counts else Severity.INFO,
            )
        return DEFAULT_INERTIAL
    if is_automatic(source, element):
        automatic = computed(source, link, element, collisions)
        if automatic is not None:
            return automatic
    mass = optional_number(source, element, "mass")
    pose, relative_to = read_pose(source, element)
    if relative_to:
        source.report(
            FRAME_IGNORED,
            f"The pose of the inertia is relative to `{relative_to}`; "
            "the simulation reads it as relative to its link.",
            at=element,
            hint="Write the pose in the frame of the link, without relative_to.",
        )
    inertial = Inertial(
        mass=1.0 if mass is None else mass, pose_in_link=pose, inertia=_inertia(source, element)
    )
    _check(source, element, name, inertial, is_static=node.scope.is_static)
    return inertial if inertial.mass >= 0 else None


def _check(
    source: Source, element: Element, name: str, inertial: Inertial, *, is_static: bool
) -> None:
    """Report a mass or an inertia that no body can have."""
    if inertial.mass < 0:
        source.report(
            NEGATIVE_MASS,
            f"The mass of the link `{name}` is negative ({inertial.mass:g} kg).",
            at=element,
            hint="Write the mass of the link in kilograms.",
        )
        return
    if inertial.mass == 0 and not is_static:
        source.report(
            MASSLESS_MODEL_LINK,
            f"The link `{name}` has mass 0: engines hold it in place or cannot move it.",
            at=element,
            hint="Write its mass in kilograms, or make the model static.",
        )
    if not is_possible(inertial.inertia):
        low, middle, high = principal_moments(inertial.inertia)
        source.report(
            IMPOSSIBLE_INERTIA,
            f"The inertia of the link `{name}` is impossible: its principal moments are "
            f"{low:.4g}, {middle:.4g} and {high:.4g} kg m².",
            at=element,
            hint="Compute it from mass and shape, or export it from CAD about the center of mass: "
            "each moment must be positive, and none larger than the sum of the other two.",
        )


def _inertia(source: Source, inertial: Element) -> tuple[float, float, float, float, float, float]:
    xx, xy, xz, yy, yz, zz = (
        number(source, inertial, "inertia", moment, default=default)
        for moment, default in zip(MOMENTS, DEFAULT_INERTIAL.inertia, strict=True)
    )
    return (xx, xy, xz, yy, yz, zz)

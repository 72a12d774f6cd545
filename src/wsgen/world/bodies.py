"""`<link>` and `<inertial>` of SDF. Everything is seen from the link's own frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.inertia import is_possible, principal_moments
from wsgen.model.robot import GazeboTag, Inertial, Link
from wsgen.world.auto_inertia import computed, is_automatic
from wsgen.world.shapes import ShapeReader
from wsgen.world.source import line_of
from wsgen.world.values import first, number, optional_number, read_pose, truth
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.robot import Collision
    from wsgen.world.included import Includes
    from wsgen.world.scopes import Node
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

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
            "from mass and shape, or export it from CAD about the centre of mass.",
        )


def _inertia(source: Source, inertial: Element) -> tuple[float, float, float, float, float, float]:
    xx, xy, xz, yy, yz, zz = (
        number(source, inertial, "inertia", moment, default=default)
        for moment, default in zip(MOMENTS, DEFAULT_INERTIAL.inertia, strict=True)
    )
    return (xx, xy, xz, yy, yz, zz)

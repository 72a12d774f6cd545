"""`<link>` and `<inertial>` of a URDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.findings import line_of
from wsgen.description.numbers import read_number
from wsgen.description.shapes import read_collision, read_origin, read_visual
from wsgen.model.robot import Inertial, Link
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.description.findings import Findings
    from wsgen.description.shapes import Rgba
    from wsgen.xmltree import Element

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read_link(
    findings: Findings, element: Element, name: str, materials: Mapping[str, Rgba | None]
) -> Link:
    """A link; what is wrong in it is reported and left out."""
    path = f"link[@name='{name}']"
    visuals = [
        read_visual(findings, visual, f"{path}/visual", materials)
        for visual in children(element, "visual")
    ]
    collisions = [
        read_collision(findings, collision, f"{path}/collision")
        for collision in children(element, "collision")
    ]
    # Of repeated elements the first one counts, as for Gazebo's parser.
    first = next(children(element, "inertial"), None)
    inertial = None if first is None else _read_inertial(findings, first, f"{path}/inertial")
    return Link(
        name=name,
        inertial=inertial,
        visuals=tuple(visual for visual in visuals if visual is not None),
        collisions=tuple(collision for collision in collisions if collision is not None),
        line=line_of(element),
    )


def _read_inertial(findings: Findings, element: Element, path: str) -> Inertial | None:
    pose = read_origin(findings, element, path)
    parts: dict[str, Element] = {}
    for part in children(element, "mass", "inertia"):
        parts.setdefault(str(part.tag), part)
    for tag, example in (
        ("mass", '<mass value="1"/>'),
        ("inertia", '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'),
    ):
        if tag not in parts:
            findings.error(
                "ROB021",
                f"<inertial> has no <{tag}>.",
                hint=f"Add {example} (kg, kg m²).",
                at=element,
                path=path,
            )
    if len(parts) < 2:  # noqa: PLR2004  a mass and an inertia
        return None
    mass = read_number(findings, parts["mass"], "value", f"{path}/mass", required=True)
    moments = [
        read_number(findings, parts["inertia"], moment, f"{path}/inertia", required=True)
        for moment in MOMENTS
    ]
    if mass is None or None in moments:
        return None
    if mass < 0:
        findings.error(
            "ROB022",
            f"The mass is negative ({mass:g} kg).",
            hint="Give the link its mass in kilograms.",
            at=parts["mass"],
            path=f"{path}/mass",
        )
        return None
    ixx, ixy, ixz, iyy, iyz, izz = (moment or 0.0 for moment in moments)
    return Inertial(mass=mass, pose_in_link=pose, inertia=(ixx, ixy, ixz, iyy, iyz, izz))

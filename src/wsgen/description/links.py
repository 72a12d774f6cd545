"""`<link>` and `<inertial>` of a URDF.

urdfdom reads a link's inertial, then its visuals, then its collisions, and stops at the first that
it cannot read, without refusing the robot: what comes behind is lost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.findings import line_of
from wsgen.description.numbers import read_number
from wsgen.description.shapes import Unusable, read_collision, read_origin, read_visual
from wsgen.model.robot import Inertial, Link
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.description.findings import Findings
    from wsgen.description.materials import Rgba
    from wsgen.model.robot import Collision, Visual
    from wsgen.xmltree import Element

EXAMPLES = {  # of what an <inertial> must have
    "mass": '<mass value="1"/>',
    "inertia": '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>',
}
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read_link(
    findings: Findings, element: Element, name: str, materials: Mapping[str, Rgba | None]
) -> Link:
    """A link as Gazebo's parser reads it; what is wrong in it is reported and left out."""
    path = f"link[@name='{name}']"
    before = len(findings.errors)
    # Of repeated elements the first one counts, as for Gazebo's parser.
    first = next(children(element, "inertial"), None)
    inertial, is_whole = (None, True) if first is None else _read_inertial(findings, first, path)
    visuals = [
        read_visual(findings, visual, f"{path}/visual", materials)
        for visual in children(element, "visual")
    ]
    collisions = [
        read_collision(findings, collision, f"{path}/collision")
        for collision in children(element, "collision")
    ]
    seen = _until_unreadable(visuals) if is_whole else 0
    touched = _until_unreadable(collisions) if is_whole and seen == len(visuals) else 0
    _report_lost(
        findings,
        before,
        len(visuals) - seen - (is_whole and seen < len(visuals)),
        len(collisions)
        - touched
        - (is_whole and seen == len(visuals) and touched < len(collisions)),
    )
    return Link(
        name=name,
        inertial=inertial,
        visuals=tuple(one for one in visuals[:seen] if not isinstance(one, Unusable)),
        collisions=tuple(one for one in collisions[:touched] if not isinstance(one, Unusable)),
        line=line_of(element),
    )


def _until_unreadable(shapes: Sequence[Visual | Collision | Unusable]) -> int:
    """How many of them come before the first that Gazebo's parser cannot read."""
    return next(
        (index for index, shape in enumerate(shapes) if shape is Unusable.UNREADABLE), len(shapes)
    )


def _report_lost(findings: Findings, error: int, visuals: int, collisions: int) -> None:
    lost = [
        f"{count} {kind}{'s' if count > 1 else ''}"
        for count, kind in ((visuals, "visual"), (collisions, "collision"))
        if count
    ]
    if lost and error < len(findings.errors):  # not where what is left over of xacro is the cause
        findings.add_consequence(
            error,
            "Gazebo's parser stops reading the link there, and leaves out what comes behind: "
            f"{' and '.join(lost)}.",
        )


def _read_inertial(findings: Findings, element: Element, path: str) -> tuple[Inertial | None, bool]:
    """The inertial as Gazebo has it, and whether all of it can be read.

    Where only the moments are wrong, the mass is kept, with moments of zero.
    """
    path = f"{path}/inertial"
    pose = read_origin(findings, element, path)
    parts: dict[str, Element] = {}
    for part in children(element, "mass", "inertia"):
        parts.setdefault(str(part.tag), part)
    lacking = [tag for tag in EXAMPLES if tag not in parts]
    if lacking:
        findings.missing(
            "ROB021",
            f"<inertial> has no <{'> and no <'.join(lacking)}>.",
            hint=f"Add {' and '.join(EXAMPLES[tag] for tag in lacking)} (kg, kg m²).",
            at=element,
            path=path,
            name=lacking[0],
        )
    mass = _read_mass(findings, parts["mass"], path) if "mass" in parts else None
    moments = [
        read_number(findings, parts["inertia"], moment, f"{path}/inertia", required=True)
        for moment in MOMENTS
        if "inertia" in parts
    ]
    is_whole = pose is not None and mass is not None and bool(moments) and None not in moments
    if pose is None or mass is None or mass < 0:
        return None, is_whole
    numbers = [moment or 0.0 for moment in moments] if is_whole else [0.0] * len(MOMENTS)
    ixx, ixy, ixz, iyy, iyz, izz = numbers
    return Inertial(mass=mass, pose_in_link=pose, inertia=(ixx, ixy, ixz, iyy, iyz, izz)), is_whole


def _read_mass(findings: Findings, element: Element, path: str) -> float | None:
    mass = read_number(findings, element, "value", f"{path}/mass", required=True)
    if mass is not None and mass < 0:
        findings.error(
            "ROB022",
            f"The mass is negative ({mass:g} kg).",
            hint="Give the link its mass in kilograms.",
            at=element,
            path=f"{path}/mass",
        )
    return mass

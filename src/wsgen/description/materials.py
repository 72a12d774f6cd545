"""`<material>` of a URDF.

Gazebo goes on without a colour that it cannot read; on a material that is defined twice for the
whole robot its parser refuses the robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.numbers import read_numbers
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

Rgba = tuple[float, float, float, float]


def read_materials(findings: Findings, root: Element) -> dict[str, Rgba | None]:
    """The materials by name, those of the robot and those in its links; None: a texture only."""
    materials: dict[str, Rgba | None] = {}
    _report_repeated(findings, root)
    inside = [
        material
        for link in children(root, "link")
        for visual in children(link, "visual")
        for material in children(visual, "material")
    ]
    for material in (*children(root, "material"), *inside):
        name = material.get("name") or ""
        if name and _has(material, "color", "texture"):
            path = f"material[@name='{name}']"
            colour = _read_colour(findings, material, path)
            if materials.setdefault(name, colour) != colour:
                findings.warning(
                    "ROB026",
                    f"The material `{name}` has two colours.",
                    hint="Define it once, or give the second one another name: Gazebo takes the "
                    "first colour for both, other programs may not.",
                    at=material,
                    path=path,
                )
    return materials


def _report_repeated(findings: Findings, root: Element) -> None:
    """Materials of the whole robot; urdfdom counts those that it cannot read as well."""
    names: set[str | None] = set()
    for material in children(root, "material"):
        name = material.get("name")
        if name in names:
            findings.error(
                "ROB059",
                f"The material `{name or ''}` is defined twice for the whole robot, and Gazebo "
                "refuses the robot, be the colours equal or not.",
                hint="Remove one of the definitions; in xacro, put them into a file of their own "
                "that is included once.",
                at=material,
                path=f"material[@name='{name or ''}']",
            )
        names.add(name)


def _has(element: Element, *tags: str) -> bool:
    return next(children(element, *tags), None) is not None


def used_colour(
    findings: Findings, material: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Rgba | None:
    """The colour of a visual's material; None where it has none."""
    name = material.get("name") or ""
    if name in materials:
        return materials[name]
    if _has(material, "color"):
        return _read_colour(findings, material, path)
    if name and not _has(material, "texture"):
        findings.warning(
            "ROB025",
            f"The material `{name}` is not defined.",
            hint=f'Add <material name="{name}"><color rgba="0.5 0.5 0.5 1"/></material> to the '
            "robot; without it simulators show their default colour.",
            at=material,
            path=path,
        )
    return None


def _read_colour(findings: Findings, material: Element, path: str) -> Rgba | None:
    for colour in children(material, "color"):
        rgba = read_numbers(
            findings, colour, "rgba", 4, f"{path}/color", required=True, is_fatal=False
        )
        if rgba is None:
            return None
        if not all(0 <= number <= 1 for number in rgba):
            findings.warning(
                "ROB027",
                f'rgba="{colour.get("rgba")}" is not between 0 and 1.',
                hint="Divide by 255 if these are bytes.",
                at=colour,
                path=f"{path}/color",
            )
        red, green, blue, alpha = (min(1.0, max(0.0, number)) for number in rgba)
        return (red, green, blue, alpha)
    return None

"""`<link>` and `<inertial>` of a URDF.

urdfdom reads a link's inertial, then its visuals, then its collisions, and stops at the first that
it cannot read, without refusing the robot: what comes behind is lost.

`<visual>`, `<collision>`, `<geometry>` and `<origin>` of a URDF.

`<material>` of a URDF.

Gazebo goes on without a color that it cannot read; on a material that is defined twice for the
whole robot its parser refuses the robot.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Inertial,
    Link,
    Mesh,
    Sphere,
    Visual,
)
from wsgen.model.transform import IDENTITY, Pose
from wsgen.urdf.collector import line_of
from wsgen.urdf.unknown_elements import SHAPES, meant_element
from wsgen.urdf.values import read_number, read_numbers, read_triple
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.urdf.collector import Findings
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
            color = _read_color(findings, material, path)
            if materials.setdefault(name, color) != color:
                findings.warning(
                    "ROB026",
                    f"The material `{name}` has two colors.",
                    hint="Define it once, or give the second one another name: Gazebo takes the "
                    "first color for both, other programs may not.",
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
                "refuses the robot, be the colors equal or not.",
                hint="Remove one of the definitions; in xacro, put them into a file of their own "
                "that is included once.",
                at=material,
                path=f"material[@name='{name or ''}']",
            )
        names.add(name)


def _has(element: Element, *tags: str) -> bool:
    return next(children(element, *tags), None) is not None


def used_color(
    findings: Findings, material: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Rgba | None:
    """The color of a visual's material; None where it has none."""
    name = material.get("name") or ""
    if name in materials:
        return materials[name]
    if _has(material, "color"):
        return _read_color(findings, material, path)
    if name and not _has(material, "texture"):
        findings.warning(
            "ROB025",
            f"The material `{name}` is not defined.",
            hint=f'Add <material name="{name}"><color rgba="0.5 0.5 0.5 1"/></material> to the '
            "robot; without it simulators show their default color.",
            at=material,
            path=path,
        )
    return None


def _read_color(findings: Findings, material: Element, path: str) -> Rgba | None:
    for color in children(material, "color"):
        rgba = read_numbers(
            findings, color, "rgba", 4, f"{path}/color", required=True, is_fatal=False
        )
        if rgba is None:
            return None
        if not all(0 <= number <= 1 for number in rgba):
            findings.warning(
                "ROB027",
                f'rgba="{color.get("rgba")}" is not between 0 and 1.',
                hint="Divide by 255 if these are bytes.",
                at=color,
                path=f"{path}/color",
            )
        red, green, blue, alpha = (min(1.0, max(0.0, number)) for number in rgba)
        return (red, green, blue, alpha)
    return None


class Unusable(Enum):
    """Why a shape is not part of the robot."""

    UNREADABLE = "urdfdom stops reading the link at it"
    WITHOUT_EXTENT = "Gazebo's parser takes it, and no engine can"


def read_origin(findings: Findings, element: Element, path: str) -> Pose | None:
    """The pose in `<origin>`, that of the frame itself where there is none; None where wrong."""
    for origin in children(element, "origin"):
        path = f"{path}/origin"
        xyz, rpy = (
            read_triple(findings, origin, attribute, path)
            if attribute in origin.attrib
            else (0.0, 0.0, 0.0)
            for attribute in ("xyz", "rpy")
        )
        return None if xyz is None or rpy is None else Pose(xyz=xyz, rpy=rpy)
    return IDENTITY


def read_visual(
    findings: Findings, element: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Visual | Unusable:
    """Something to see."""
    pose = read_origin(findings, element, path)
    rgba, is_named = None, True
    for material in children(element, "material"):
        is_named = material.get("name") is not None
        if not is_named:
            findings.missing(
                "ROB006",
                "The material has no name.",
                hint='Write <material name="NAME">: Gazebo stops reading the link here.',
                at=material,
                path=f"{path}/material",
                name="name",
            )
        rgba = used_color(findings, material, f"{path}/material", materials)
        break
    geometry = _read_geometry(findings, element, path)
    if pose is None or not is_named:
        return Unusable.UNREADABLE
    if isinstance(geometry, Unusable):
        return geometry
    return Visual(geometry=geometry, pose_in_link=pose, rgba=rgba, name=element.get("name"))


def read_collision(findings: Findings, element: Element, path: str) -> Collision | Unusable:
    """Something to touch."""
    pose = read_origin(findings, element, path)
    geometry = _read_geometry(findings, element, path)
    if pose is None:
        return Unusable.UNREADABLE
    if isinstance(geometry, Unusable):
        return geometry
    return Collision(geometry=geometry, pose_in_link=pose, name=element.get("name"))


def _read_geometry(findings: Findings, owner: Element, path: str) -> Geometry | Unusable:
    path = f"{path}/geometry"
    for geometry in children(owner, "geometry"):
        # The first element counts, whatever it is.
        shape = next((child for child in geometry if isinstance(child.tag, str)), None)
        if shape is not None and shape.tag in SHAPES:
            return _read_shape(findings, shape, f"{path}/{shape.tag}")
        near = None if shape is None else meant_element(shape.tag, SHAPES)
        findings.missing(
            "ROB024",
            "The geometry is empty."
            if shape is None
            else f"Gazebo knows no shape <{shape.tag}> in a URDF.",
            hint=f"Put one of {', '.join(f'<{name}>' for name in SHAPES)} into it.",
            at=geometry,
            path=path,
            name=near or "",
        )
        return Unusable.UNREADABLE
    findings.missing(
        "ROB024",
        "<geometry> is missing.",
        hint="Add <geometry> with a shape in it, or remove the element.",
        at=owner,
        path=path,
        name="geometry",
    )
    return Unusable.UNREADABLE


def _read_shape(findings: Findings, shape: Element, path: str) -> Geometry | Unusable:
    if shape.tag == "mesh":
        return _read_mesh(findings, shape, path)
    sizes: tuple[float, ...] | None
    if shape.tag == "box":
        sizes = read_numbers(findings, shape, "size", 3, path, required=True)
    else:
        radius = read_number(findings, shape, "radius", path, required=True)
        length = (
            1.0
            if shape.tag == "sphere"
            else read_number(findings, shape, "length", path, required=True)
        )
        sizes = None if radius is None or length is None else (radius, length)
    if sizes is None:
        return Unusable.UNREADABLE
    if not all(size > 0 for size in sizes):
        return _without_extent(findings, shape, path, "A size")
    if shape.tag == "box":
        return Box(size=(sizes[0], sizes[1], sizes[2]))
    if shape.tag == "sphere":
        return Sphere(radius=sizes[0])
    return Cylinder(radius=sizes[0], length=sizes[1])


def _read_mesh(findings: Findings, shape: Element, path: str) -> Mesh | Unusable:
    scale: tuple[float, float, float] | None = (1.0, 1.0, 1.0)
    if "scale" in shape.attrib:
        scale = read_triple(findings, shape, "scale", path)
    uri = (shape.get("filename") or "").strip()
    if not uri:
        findings.missing(
            "ROB029",
            "The mesh has no file name.",
            hint='Write <mesh filename="package://PACKAGE/meshes/FILE.stl"/>.',
            at=shape,
            path=path,
            name="filename",
        )
    if scale is None or not uri:
        return Unusable.UNREADABLE
    # A mirrored mesh can be seen, but Gazebo's physics engine ends on it.
    if 0 in scale or (min(scale) < 0 and not _is_only_seen(path)):
        return _without_extent(findings, shape, path, "The scale")
    return Mesh(uri=uri, scale=scale)


def _without_extent(findings: Findings, shape: Element, path: str, what: str) -> Unusable:
    told = f"{what} of this {shape.tag} is not greater than 0"
    if _is_only_seen(path):
        findings.warning(
            "ROB028",
            f"{told}: there is nothing to see of it.",
            hint="Remove the <visual>, or give every length, radius and scale a number of meters.",
            at=shape,
            path=path,
        )
    else:
        findings.error(
            "ROB028",
            f"{told}.",
            hint="Give every length, radius and scale a positive number of meters: Gazebo's "
            "physics engine ends the program on such a shape. Mirror meshes in the file.",
            at=shape,
            path=path,
        )
    return Unusable.WITHOUT_EXTENT


def _is_only_seen(path: str) -> bool:
    return "/visual/" in path


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

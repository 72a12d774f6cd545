"""`<link>` of a URDF with what is in it: inertial, visuals, collisions and materials.

urdfdom reads a link's inertial, then its visuals, then its collisions, and stops at the first that
it cannot read, without refusing the robot: everything behind it is lost. It ignores a color that
it cannot read, and refuses a robot that defines a material twice at the top level.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import (
    MAKE_IT_THICK,
    MIRROR_IT,
    MIRRORED_MESH,
    NEGATIVE_MASS,
    NO_SHAPE,
    UNNAMED_ELEMENT,
    ZERO_SIZE,
)
from wsgen.descriptions.urdf.unknown_elements import SHAPES, meant_element
from wsgen.descriptions.urdf.values import line_of, read_number, read_numbers, read_triple
from wsgen.diagnostics import Measured, Rule, Severity
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
from wsgen.text.suggestions import advice
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.text.xmltree import Element


Rgba = tuple[float, float, float, float]
EXAMPLES = {  # of what an <inertial> must have
    "mass": '<mass value="1"/>',
    "inertia": '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>',
}
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

ANGLE_IN_DEGREES = Rule(
    code="ROB140",
    name="angle-in-degrees",
    severity=Severity.WARNING,
    summary="The angle of an `<origin>` looks like degrees.",
    what="Looks for angles above a full turn (6.2832 rad).",
    why="Angles in URDF are in radians: 90 rad are 14 turns and 117 degrees, so that the "
    "orientation is wrong.",
    example='<origin xyz="0 0 0.1" rpy="90 0 0"/>',
    instead='<origin xyz="0 0 0.1" rpy="1.5708 0 0"/>',
)
MOST_TURNED = 6.5  # rad; a whole turn is written with few digits
INCOMPLETE_INERTIAL = Rule(
    code="ROB021",
    name="incomplete-inertial",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="An `<inertial>` has no `<mass>` or no `<inertia>`.",
    why="`urdfdom` stops reading the link there: its shapes are lost, and Gazebo drops a link "
    "without mass.",
    example='<inertial>\n  <mass value="1"/>\n</inertial>',
    instead="<inertial>\n"
    '  <mass value="1"/>\n'
    '  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>\n'
    "</inertial>",
)

UNDEFINED_MATERIAL = Rule(
    code="ROB025",
    name="undefined-material",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A visual uses a material that is not defined.",
    why="Gazebo and RViz draw the link in their default color.",
    example="<visual>\n"
    '  <geometry><sphere radius="0.1"/></geometry>\n'
    '  <material name="blue"/>\n'
    "</visual>",
    instead='<material name="blue">\n  <color rgba="0 0 1 1"/>\n</material>',
)

TWO_COLORED_MATERIAL = Rule(
    code="ROB026",
    name="two-colored-material",
    severity=Severity.WARNING,
    summary="A material is defined with two colors.",
    why="Gazebo uses the first color for both; other programs may use the second.",
    example='<material name="blue"><color rgba="0 0 1 1"/></material>\n'
    "…\n"
    '<material name="blue"><color rgba="0 0 0.5 1"/></material>',
    instead='<material name="blue"><color rgba="0 0 1 1"/></material>\n'
    "…\n"
    '<material name="dark_blue"><color rgba="0 0 0.5 1"/></material>',
)

COLOR_OUT_OF_RANGE = Rule(
    code="ROB027",
    name="color-out-of-range",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A color component is not between 0 and 1.",
    why="Simulators clamp the components: a color in bytes (0 to 255) becomes white.",
    example='<color rgba="255 128 0 1"/>',
    instead='<color rgba="1 0.5 0 1"/>',
)

UNNAMED_MESH = Rule(
    code="ROB029",
    name="unnamed-mesh",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="A mesh has no file name.",
    why="`urdfdom` stops reading the link there and silently drops its remaining elements.",
    example='<mesh scale="0.001 0.001 0.001"/>',
    instead='<mesh filename="package://my_robot/meshes/arm.stl" scale="0.001 0.001 0.001"/>',
)

DUPLICATE_MATERIAL = Rule(
    code="ROB059",
    name="duplicate-material",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A material is defined twice at the top level of the robot.",
    why="`urdfdom` refuses the robot, even if the colors are equal. Usually a xacro file with "
    "materials is included twice.",
    example='<material name="blue"><color rgba="0 0 1 1"/></material>\n'
    '<material name="blue"><color rgba="0 0 1 1"/></material>',
    instead='<material name="blue"><color rgba="0 0 1 1"/></material>',
)


def read_link(
    collector: Collector, element: Element, name: str, materials: Mapping[str, Rgba | None]
) -> Link:
    """A link as Gazebo's parser reads it; what it cannot read is reported and left out."""
    path = f"link[@name='{name}']"
    before = len(collector.errors)
    # Of repeated elements the first one counts, as for Gazebo's parser.
    first = next(children(element, "inertial"), None)
    inertial, is_whole = (None, True) if first is None else _read_inertial(collector, first, path)
    visuals = [
        _read_visual(collector, visual, f"{path}/visual", materials)
        for visual in children(element, "visual")
    ]
    collisions = [
        _read_collision(collector, collision, f"{path}/collision")
        for collision in children(element, "collision")
    ]
    visuals_read = _until_unreadable(visuals) if is_whole else 0
    has_all_visuals = is_whole and visuals_read == len(visuals)
    collisions_read = _until_unreadable(collisions) if has_all_visuals else 0
    # The first one that cannot be read is reported itself.
    visuals_lost = len(visuals) - visuals_read - (is_whole and not has_all_visuals)
    is_collision_reported = has_all_visuals and collisions_read < len(collisions)
    collisions_lost = len(collisions) - collisions_read - is_collision_reported
    _report_lost(collector, before, visuals_lost, collisions_lost)
    return Link(
        name=name,
        inertial=inertial,
        visuals=tuple(one for one in visuals[:visuals_read] if isinstance(one, Visual)),
        collisions=tuple(one for one in collisions[:collisions_read] if isinstance(one, Collision)),
        line=line_of(element),
    )


def _until_unreadable(shapes: Sequence[Visual | Collision | Unusable]) -> int:
    """How many of them come before the first that Gazebo's parser cannot read."""
    return next(
        (index for index, shape in enumerate(shapes) if shape is Unusable.UNREADABLE), len(shapes)
    )


def _report_lost(collector: Collector, error: int, visuals: int, collisions: int) -> None:
    lost = [
        f"{count} {kind}{'s' if count > 1 else ''}"
        for count, kind in ((visuals, "visual"), (collisions, "collision"))
        if count
    ]
    if lost and error < len(collector.errors):  # not where unexpanded xacro is the cause
        collector.add_consequence(
            error,
            f"Gazebo's parser stops reading the link there and drops {' and '.join(lost)}.",
        )


def _read_inertial(
    collector: Collector, element: Element, path: str
) -> tuple[Inertial | None, bool]:
    """The inertial as Gazebo has it, and whether all of it can be read.

    Where only the moments cannot be read, the mass is kept, with moments of zero.
    """
    path = f"{path}/inertial"
    pose = read_origin(collector, element, path)
    parts: dict[str, Element] = {}
    for part in children(element, "mass", "inertia"):
        parts.setdefault(str(part.tag), part)
    lacking = [tag for tag in EXAMPLES if tag not in parts]
    if lacking:
        collector.report_missing(
            INCOMPLETE_INERTIAL,
            f"<inertial> has no <{'> and no <'.join(lacking)}>.",
            hint=f"Add {' and '.join(EXAMPLES[tag] for tag in lacking)} (kg, kg m²).",
            at=element,
            path=path,
            name=lacking[0],
        )
    mass = _read_mass(collector, parts["mass"], path) if "mass" in parts else None
    moments = [
        read_number(collector, parts["inertia"], moment, f"{path}/inertia", required=True)
        for moment in MOMENTS
        if "inertia" in parts
    ]
    is_whole = pose is not None and mass is not None and bool(moments) and None not in moments
    if pose is None or mass is None or mass < 0:
        return None, is_whole
    numbers = [moment or 0.0 for moment in moments] if is_whole else [0.0] * len(MOMENTS)
    ixx, ixy, ixz, iyy, iyz, izz = numbers
    return Inertial(mass=mass, pose_in_link=pose, inertia=(ixx, ixy, ixz, iyy, iyz, izz)), is_whole


def _read_mass(collector: Collector, element: Element, path: str) -> float | None:
    mass = read_number(collector, element, "value", f"{path}/mass", required=True)
    if mass is not None and mass < 0:
        collector.report(
            NEGATIVE_MASS,
            f"The mass is negative ({mass:g} kg).",
            hint="Write the mass of the link in kilograms.",
            at=element,
            path=f"{path}/mass",
        )
    return mass


class Unusable(Enum):
    """Why a shape is not part of the robot."""

    UNREADABLE = "urdfdom stops reading the link at it"
    WITHOUT_EXTENT = "Gazebo's parser accepts it, but physics engines do not"


def read_origin(collector: Collector, element: Element, path: str) -> Pose | None:
    """The pose in `<origin>`, the identity without one; None where it cannot be read."""
    for origin in children(element, "origin"):
        path = f"{path}/origin"
        xyz, rpy = (
            read_triple(collector, origin, attribute, path)
            if attribute in origin.attrib
            else (0.0, 0.0, 0.0)
            for attribute in ("xyz", "rpy")
        )
        if rpy is not None and max(map(abs, rpy)) > MOST_TURNED:
            _report_degrees(collector, origin, rpy, path)
        return None if xyz is None or rpy is None else Pose(xyz=xyz, rpy=rpy)
    return IDENTITY


def _report_degrees(
    collector: Collector, origin: Element, rpy: tuple[float, ...], path: str
) -> None:
    radians = " ".join(f"{math.radians(angle):.6g}" for angle in rpy)
    collector.report(
        ANGLE_IN_DEGREES,
        f'rpy="{origin.get("rpy")}" looks like degrees; URDF uses radians.',
        hint=f'Write rpy="{radians}".',
        at=origin,
        path=f"{path}/@rpy",
    )


def _read_visual(
    collector: Collector, element: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Visual | Unusable:
    """A `<visual>`."""
    pose = read_origin(collector, element, path)
    rgba, is_named = None, True
    for material in children(element, "material"):
        is_named = material.get("name") is not None
        if not is_named:
            collector.report_missing(
                UNNAMED_ELEMENT,
                "The material has no name.",
                hint='Write <material name="NAME">: Gazebo stops reading the link here.',
                at=material,
                path=f"{path}/material",
                name="name",
            )
        rgba = _used_color(collector, material, f"{path}/material", materials)
        break
    geometry = _read_geometry(collector, element, path)
    if pose is None or not is_named:
        return Unusable.UNREADABLE
    if isinstance(geometry, Unusable):
        return geometry
    return Visual(geometry=geometry, pose_in_link=pose, rgba=rgba, name=element.get("name"))


def _read_collision(collector: Collector, element: Element, path: str) -> Collision | Unusable:
    """A `<collision>`."""
    pose = read_origin(collector, element, path)
    geometry = _read_geometry(collector, element, path)
    if pose is None:
        return Unusable.UNREADABLE
    if isinstance(geometry, Unusable):
        return geometry
    return Collision(geometry=geometry, pose_in_link=pose, name=element.get("name"))


def _read_geometry(collector: Collector, owner: Element, path: str) -> Geometry | Unusable:
    path = f"{path}/geometry"
    for geometry in children(owner, "geometry"):
        # The first element counts, whatever it is.
        shape = next((child for child in geometry if isinstance(child.tag, str)), None)
        if shape is not None and shape.tag in SHAPES:
            return _read_shape(collector, shape, f"{path}/{shape.tag}")
        near = None if shape is None else meant_element(shape.tag, SHAPES)
        collector.report_missing(
            NO_SHAPE,
            "The geometry is empty."
            if shape is None
            else f"URDF does not have a shape <{shape.tag}>.",
            hint=f"Write one of {', '.join(f'<{name}>' for name in SHAPES)} in it.",
            at=geometry,
            path=path,
            name=near or "",
        )
        return Unusable.UNREADABLE
    collector.report_missing(
        NO_SHAPE,
        "<geometry> is missing.",
        hint="Add a <geometry> with a shape, or remove the element.",
        at=owner,
        path=path,
        name="geometry",
    )
    return Unusable.UNREADABLE


def _read_shape(collector: Collector, shape: Element, path: str) -> Geometry | Unusable:
    if shape.tag == "mesh":
        return _read_mesh(collector, shape, path)
    sizes: tuple[float, ...] | None
    if shape.tag == "box":
        sizes = read_numbers(collector, shape, "size", 3, path, required=True)
    else:
        radius = read_number(collector, shape, "radius", path, required=True)
        length = (
            1.0
            if shape.tag == "sphere"
            else read_number(collector, shape, "length", path, required=True)
        )
        sizes = None if radius is None or length is None else (radius, length)
    if sizes is None:
        return Unusable.UNREADABLE
    if not all(size > 0 for size in sizes):
        is_flat = shape.tag == "box" and min(sizes) == 0
        without = _without_extent(collector, shape, path, "A size", is_flat=is_flat)
        if 0 in sizes or shape.tag == "sphere" or _is_only_seen(path):
            return without
        sizes = tuple(map(abs, sizes))  # as Gazebo Classic has it; Gazebo Sim ends there
    if shape.tag == "box":
        return Box(size=(sizes[0], sizes[1], sizes[2]))
    if shape.tag == "sphere":
        return Sphere(radius=sizes[0])
    return Cylinder(radius=sizes[0], length=sizes[1])


def _read_mesh(collector: Collector, shape: Element, path: str) -> Mesh | Unusable:
    scale: tuple[float, float, float] | None = (1.0, 1.0, 1.0)
    if "scale" in shape.attrib:
        scale = read_triple(collector, shape, "scale", path)
    uri = (shape.get("filename") or "").strip()
    if not uri:
        collector.report_missing(
            UNNAMED_MESH,
            "The mesh has no file name.",
            hint='Write <mesh filename="package://PACKAGE/meshes/FILE.stl"/>.',
            at=shape,
            path=path,
            name="filename",
        )
    if scale is None or not uri:
        return Unusable.UNREADABLE
    if 0 in scale:
        return _without_extent(collector, shape, path, "The scale")
    if min(scale) < 0 and not _is_only_seen(path):
        collector.report(
            MIRRORED_MESH,
            "A scale of this collision mesh is negative.",
            hint=MIRROR_IT,
            at=shape,
            path=path,
        )
    return Mesh(uri=uri, scale=scale)


def _without_extent(
    collector: Collector, shape: Element, path: str, what: str, *, is_flat: bool = False
) -> Unusable:
    message = f"{what} of this {shape.tag} is not greater than 0"
    if _is_only_seen(path):
        collector.report(
            ZERO_SIZE,
            f"{message}: it is not visible.",
            hint="Remove the <visual>, or write every length, radius and scale as a positive "
            "number (m).",
            at=shape,
            path=path,
            severity=Severity.WARNING,
        )
    elif is_flat:
        collector.report(
            ZERO_SIZE,
            f"{message}: it is left out of the simulation.",
            hint=MAKE_IT_THICK,
            at=shape,
            path=path,
            severity=Severity.WARNING,
        )
    else:
        collector.report(
            ZERO_SIZE,
            f"{message}.",
            hint="Write every length, radius and scale as a positive number (m): Gazebo Sim's "
            "physics engine terminates the program on such a shape.",
            at=shape,
            path=path,
        )
    return Unusable.WITHOUT_EXTENT


def _is_only_seen(path: str) -> bool:
    return "/visual/" in path


def read_materials(collector: Collector, root: Element) -> dict[str, Rgba | None]:
    """The materials by name, those of the robot and those in its links; None: a texture only."""
    materials: dict[str, Rgba | None] = {}
    _report_repeated(collector, root)
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
            color = _read_color(collector, material, path)
            if materials.setdefault(name, color) != color:
                collector.report(
                    TWO_COLORED_MATERIAL,
                    f"The material `{name}` has two colors.",
                    hint="Remove one definition, or give the second one another name: Gazebo uses "
                    "the first color for both, other programs may not.",
                    at=material,
                    path=path,
                )
    return materials


def _report_repeated(collector: Collector, root: Element) -> None:
    """Materials of the whole robot; urdfdom counts those that it cannot read as well."""
    names: set[str | None] = set()
    for material in children(root, "material"):
        name = material.get("name")
        if name in names:
            collector.report(
                DUPLICATE_MATERIAL,
                f"The material `{name or ''}` is defined twice at the top level: Gazebo refuses "
                "the robot, even if the colors are equal.",
                hint="Remove one of the definitions. In xacro, move materials to a separate file "
                "that is included once.",
                at=material,
                path=f"material[@name='{name or ''}']",
            )
        names.add(name)


def _has(element: Element, *tags: str) -> bool:
    return next(children(element, *tags), None) is not None


def _used_color(
    collector: Collector, material: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Rgba | None:
    """The color of a visual's material; None where it has none."""
    name = material.get("name") or ""
    if name in materials:
        return materials[name]
    if _has(material, "color"):
        return _read_color(collector, material, path)
    if name and not _has(material, "texture"):
        collector.report(
            UNDEFINED_MATERIAL,
            f"The material `{name}` is not defined.",
            hint=advice(
                name,
                materials,
                f'Add <material name="{name}"><color rgba="0.5 0.5 0.5 1"/></material> to the '
                "robot; without it, simulators use their default color.",
            ),
            at=material,
            path=path,
        )
    return None


def _read_color(collector: Collector, material: Element, path: str) -> Rgba | None:
    for color in children(material, "color"):
        rgba = read_numbers(
            collector, color, "rgba", 4, f"{path}/color", required=True, is_fatal=False
        )
        if rgba is None:
            return None
        if not all(0 <= number <= 1 for number in rgba):
            collector.report(
                COLOR_OUT_OF_RANGE,
                f'rgba="{color.get("rgba")}" is not between 0 and 1.',
                hint="Write numbers between 0 and 1: divide bytes by 255.",
                at=color,
                path=f"{path}/color",
            )
        red, green, blue, alpha = (min(1.0, max(0.0, number)) for number in rgba)
        return (red, green, blue, alpha)
    return None

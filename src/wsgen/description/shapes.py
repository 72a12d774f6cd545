"""`<visual>`, `<collision>`, `<geometry>`, `<origin>` and `<material>` of a URDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.numbers import read_number, read_numbers, read_triple
from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import Box, Capsule, Collision, Cylinder, Geometry, Mesh, Sphere, Visual
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

Rgba = tuple[float, float, float, float]
GEOMETRIES = ("box", "cylinder", "sphere", "capsule", "mesh")


def read_origin(findings: Findings, element: Element, path: str) -> Pose:
    """The pose in `<origin>`; that of the frame itself where there is none."""
    for origin in children(element, "origin"):
        path = f"{path}/origin"
        return Pose(
            xyz=read_triple(findings, origin, "xyz", path) or (0.0, 0.0, 0.0),
            rpy=read_triple(findings, origin, "rpy", path) or (0.0, 0.0, 0.0),
        )
    return IDENTITY


def read_visual(
    findings: Findings, element: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Visual | None:
    """Something to see; None where its geometry is wrong."""
    pose = read_origin(findings, element, path)
    rgba = None
    for material in children(element, "material"):
        rgba = _used_colour(findings, material, f"{path}/material", materials)
    geometry = _read_geometry(findings, element, path)
    if geometry is None:
        return None
    return Visual(geometry=geometry, pose_in_link=pose, rgba=rgba, name=element.get("name"))


def read_collision(findings: Findings, element: Element, path: str) -> Collision | None:
    """Something to touch; None where its geometry is wrong."""
    pose = read_origin(findings, element, path)
    geometry = _read_geometry(findings, element, path)
    if geometry is None:
        return None
    return Collision(geometry=geometry, pose_in_link=pose, name=element.get("name"))


def read_materials(findings: Findings, root: Element) -> dict[str, Rgba | None]:
    """The materials by name, those of the robot and those in its links; None: a texture only."""
    materials: dict[str, Rgba | None] = {}
    inside = [
        material
        for link in children(root, "link")
        for visual in children(link, "visual")
        for material in children(visual, "material")
    ]
    for material in (*children(root, "material"), *inside):
        name = material.get("name") or ""
        is_definition = _has(material, "color", "texture")
        if name and is_definition:
            colour = _read_colour(findings, material, f"material[@name='{name}']")
            if materials.setdefault(name, colour) != colour:
                findings.warning(
                    "ROB026",
                    f"The material `{name}` has two colours.",
                    hint="Define it once, or give the second one another name: which of them a "
                    "program takes is not defined.",
                    at=material,
                    path=f"material[@name='{name}']",
                )
    return materials


def _has(element: Element, *tags: str) -> bool:
    return next(children(element, *tags), None) is not None


def _used_colour(
    findings: Findings, material: Element, path: str, materials: Mapping[str, Rgba | None]
) -> Rgba | None:
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
        rgba = read_numbers(findings, colour, "rgba", 4, f"{path}/color", required=True)
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


def _read_geometry(findings: Findings, owner: Element, path: str) -> Geometry | None:
    path = f"{path}/geometry"
    for geometry in children(owner, "geometry"):
        for shape in children(geometry, *GEOMETRIES):
            return _read_shape(findings, shape, f"{path}/{shape.tag}")
        findings.error(
            "ROB024",
            "The geometry has no known shape.",
            hint=f"Put one of {', '.join(f'<{name}>' for name in GEOMETRIES)} into it.",
            at=geometry,
            path=path,
        )
        return None
    findings.error(
        "ROB024",
        "<geometry> is missing.",
        hint="Add <geometry> with a shape in it, or remove the element.",
        at=owner,
        path=path,
    )
    return None


def _read_shape(findings: Findings, shape: Element, path: str) -> Geometry | None:
    if shape.tag == "mesh":
        return _read_mesh(findings, shape, path)
    if shape.tag == "box":
        size = read_numbers(findings, shape, "size", 3, path, required=True)
        if size is None or not _is_positive(findings, shape, path, size):
            return None
        return Box(size=(size[0], size[1], size[2]))
    return _read_round(findings, shape, path)


def _read_round(
    findings: Findings, shape: Element, path: str
) -> Sphere | Cylinder | Capsule | None:
    radius = read_number(findings, shape, "radius", path, required=True)
    length = (
        read_number(findings, shape, "length", path, required=True)
        if shape.tag != "sphere"
        else 1.0
    )
    if (
        radius is None
        or length is None
        or not _is_positive(findings, shape, path, (radius, length))
    ):
        return None
    if shape.tag == "sphere":
        return Sphere(radius=radius)
    if shape.tag == "cylinder":
        return Cylinder(radius=radius, length=length)
    return Capsule(radius=radius, length=length)


def _read_mesh(findings: Findings, shape: Element, path: str) -> Mesh | None:
    scale = read_triple(findings, shape, "scale", path) or (1.0, 1.0, 1.0)
    uri = (shape.get("filename") or "").strip()
    if not uri:
        findings.error(
            "ROB029",
            "The mesh has no file name.",
            hint='Write <mesh filename="package://PACKAGE/meshes/FILE.stl"/>.',
            at=shape,
            path=path,
        )
        return None
    if not _is_positive(findings, shape, path, scale):
        return None
    return Mesh(uri=uri, scale=scale)


def _is_positive(findings: Findings, shape: Element, path: str, sizes: tuple[float, ...]) -> bool:
    if all(size > 0 for size in sizes):
        return True
    findings.error(
        "ROB028",
        f"A size of this {shape.tag} is not greater than 0.",
        hint="Give every length, radius and scale a positive number of metres: Gazebo's physics "
        "engine ends the program on a shape without extent.",
        at=shape,
        path=path,
    )
    return False

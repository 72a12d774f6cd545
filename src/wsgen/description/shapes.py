"""`<visual>`, `<collision>`, `<geometry>` and `<origin>` of a URDF."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from wsgen.description.materials import used_colour
from wsgen.description.numbers import read_number, read_numbers, read_triple
from wsgen.description.spelling import SHAPES, meant_element
from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import Box, Collision, Cylinder, Geometry, Mesh, Sphere, Visual
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.description.findings import Findings
    from wsgen.description.materials import Rgba
    from wsgen.xmltree import Element


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
        rgba = used_colour(findings, material, f"{path}/material", materials)
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
            hint="Remove the <visual>, or give every length, radius and scale a number of metres.",
            at=shape,
            path=path,
        )
    else:
        findings.error(
            "ROB028",
            f"{told}.",
            hint="Give every length, radius and scale a positive number of metres: Gazebo's "
            "physics engine ends the program on such a shape. Mirror meshes in the file.",
            at=shape,
            path=path,
        )
    return Unusable.WITHOUT_EXTENT


def _is_only_seen(path: str) -> bool:
    return "/visual/" in path

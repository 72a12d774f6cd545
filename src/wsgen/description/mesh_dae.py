"""COLLADA files: the scene. What Gazebo reads of it, and whether PyBullet reads the same.

Gazebo applies the unit and the nodes' transforms, and leaves `up_axis` alone; so does PyBullet.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Content,
    Patch,
    parse_floats,
    refuse_triangles,
)
from wsgen.description.mesh_dae_geometry import Geometry, read_geometry
from wsgen.description.mesh_dae_materials import Materials
from wsgen.description.mesh_dae_tree import Ids, child, children
from wsgen.xmltree import Malformed, parse_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.xmltree import Element

    Matrix = NDArray[np.float64]  # (4, 4)

NODE_LIMIT = 20_000  # nodes may stand for others, and those for others


def is_dae(data: bytes) -> bool:
    """Whether these are the bytes of a COLLADA file."""
    return b"<COLLADA" in data[:4096]


def read_dae(data: bytes, folder: Path | None = None) -> Content:
    """The triangles of a COLLADA file's scene; with their look if its `folder` is given."""
    root = parse_numbers(data)
    if isinstance(root, Malformed):
        raise BrokenMeshError(
            f"is not well-formed XML (line {root.line}: {root.message}): Gazebo crashes on it"
        )
    if root.tag.rpartition("}")[2] != "COLLADA":
        raise BrokenMeshError("is XML, but no COLLADA: Gazebo and PyBullet crash on it")
    return _Scene(root, with_look=folder is not None).read()


class _Scene:
    """The nodes of the scene, and the geometries that they place."""

    def __init__(self, root: Element, *, with_look: bool) -> None:
        self.root = root
        self.ids = Ids(root)
        self.materials = Materials(self.ids) if with_look else None
        self.patches: list[Patch] = []
        self.geometries: dict[str, Geometry] = {}
        self.is_plain = True
        self.oddity: str | None = None

    def read(self) -> Content:
        scale = self._unit()
        parts = []
        triangles = 0
        for instance, matrix in self._places():
            geometry = self._geometry(instance.get("url", ""))
            triangles += len(geometry.corners)
            refuse_triangles(triangles)
            parts.append(scale * _moved(geometry.corners, matrix))
            if self.materials is not None:
                self.materials.bind(instance)
                self._add_patches(geometry, scale * matrix, self.materials)
        # PyBullet reads all geometries, also those that no node places.
        self.is_plain &= len(self.geometries) == sum(1 for _ in self.root.iter("{*}geometry"))
        if not parts:
            raise BrokenMeshError(
                "has a scene without geometry",
                hint="Export it with the objects selected that are to be in it.",
            )
        for geometry in self.geometries.values():
            self.is_plain &= geometry.is_plain
            self.oddity = self.oddity or geometry.oddity
        corners = parts[0] if len(parts) == 1 else np.concatenate(parts)
        if not len(corners):
            self._complain_of_unread()
        return Content(
            corners=corners,
            is_plain=self.is_plain,
            oddity=self.oddity,
            patches=tuple(self.patches),
            complaints=() if self.materials is None else tuple(self.materials.complaints),
        )

    def _add_patches(self, geometry: Geometry, matrix: Matrix, materials: Materials) -> None:
        """The geometry as it is placed; mirrored, its triangles are seen from the other side."""
        linear = matrix[:3, :3]
        size = float(np.linalg.det(linear))  # 0 where it is pressed flat
        order = slice(None, None, -1 if size < 0 else 1)
        for symbol, patch in geometry.patches:
            normals = patch.normals
            if normals is not None:
                turned = normals @ np.linalg.inv(linear) if size and math.isfinite(size) else None
                normals = None if turned is None else turned[:, order]
            points = patch.texture_points
            self.patches.append(
                Patch(
                    corners=(patch.corners @ linear.T + matrix[:3, 3])[:, order],
                    normals=normals,
                    texture_points=None if points is None else points[:, order],
                    material=materials.find(symbol),
                )
            )

    def _complain_of_unread(self) -> None:
        unread = {kind for geometry in self.geometries.values() for kind in geometry.unread}
        if unread:
            raise BrokenMeshError(
                f"has nothing but <{'>, <'.join(sorted(unread))}>, which Gazebo does not read",
                hint="Export it with its faces cut into triangles.",
            )

    def _unit(self) -> float:
        """Metres of one unit of length."""
        asset = child(self.root, "asset")
        if asset is None:
            self.is_plain = False
            self.oddity = "has no <asset>: PyBullet crashes on it, and its unit is not known"
            return 1.0
        unit = child(asset, "unit")
        meter = None if unit is None else unit.get("meter")
        if meter is None:
            self.is_plain &= unit is None
            return 1.0
        return float(_floats(meter, 1, "the unit")[0])

    def _places(self) -> Iterator[tuple[Element, Matrix]]:
        """What the scene places: each <instance_geometry>, with the node's pose."""
        waiting = [(node, np.eye(4), 0) for node in reversed(self._top_nodes())]
        for _ in range(NODE_LIMIT):
            if not waiting:
                return
            node, parent, depth = waiting.pop()
            matrix = parent @ _transform(node)
            self.is_plain &= np.allclose(parent @ _transform_in_pybullet(node), matrix)
            for instance in children(node, "instance_geometry"):
                yield instance, matrix
            for instance in children(node, "instance_node"):
                self.is_plain = False  # PyBullet passes it over
                inner = self.ids.find(instance.get("url", ""), "a node")
                waiting.append((inner, matrix, depth + 1))
            waiting += [(inner, matrix, depth) for inner in children(node, "node")]
            if depth > len(self.ids):
                break
        if waiting:
            raise BrokenMeshError("has nodes that stand for themselves, or far too many")

    def _top_nodes(self) -> list[Element]:
        scene = child(self.root, "scene")
        instance = None if scene is None else child(scene, "instance_visual_scene")
        if instance is None:
            raise BrokenMeshError("has no <scene>: Gazebo crashes on it")
        return list(children(self.ids.find(instance.get("url", ""), "the scene"), "node"))

    def _geometry(self, url: str) -> Geometry:
        if url not in self.geometries:
            self.geometries[url] = read_geometry(
                self.ids.find(url, "a geometry"), self.ids, with_look=self.materials is not None
            )
        return self.geometries[url]


def _moved(corners: NDArray[Any], matrix: Matrix) -> NDArray[Any]:
    if (matrix == np.eye(4)).all():
        return corners
    moved: NDArray[Any] = corners @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def _transform(node: Element) -> Matrix:
    """As Gazebo has it: a matrix, or else place, all rotations and scale in this order."""
    matrix = child(node, "matrix")
    if matrix is not None:
        return _matrix(matrix)
    result = _translation(node)
    for rotation in children(node, "rotate"):
        result @= _rotation(rotation)
    return result @ _scaling(node)


def _transform_in_pybullet(node: Element) -> Matrix:
    """As PyBullet has it, which takes the first of each kind, in an order of its own."""
    matrix, rotation = child(node, "matrix"), child(node, "rotate")
    result = np.eye(4) if matrix is None else _matrix(matrix)
    result = result @ _translation(node) @ _scaling(node)
    return result if rotation is None else result @ _rotation(rotation)


def _matrix(element: Element) -> Matrix:
    return _floats(element.text, 16, "a <matrix>").reshape(4, 4)


def _translation(node: Element) -> Matrix:
    result = np.eye(4)
    element = child(node, "translate")
    if element is not None:
        result[:3, 3] = _floats(element.text, 3, "a <translate>")
    return result


def _scaling(node: Element) -> Matrix:
    element = child(node, "scale")
    if element is None:
        return np.eye(4)
    return np.diag([*_floats(element.text, 3, "a <scale>"), 1.0])


def _rotation(element: Element) -> Matrix:
    """About an axis, by degrees; Rodrigues' formula."""
    *axis, degrees = _floats(element.text, 4, "a <rotate>")
    length = math.hypot(*axis)
    result = np.eye(4)
    if length > 0:
        x, y, z = (part / length for part in axis)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        angle = math.radians(degrees)
        result[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return result


def _floats(text: str | None, count: int, what: str) -> NDArray[np.float64]:
    numbers = parse_floats(text or "", what)
    if len(numbers) != count:
        raise BrokenMeshError(f"has {len(numbers)} numbers in {what} instead of {count}")
    return numbers

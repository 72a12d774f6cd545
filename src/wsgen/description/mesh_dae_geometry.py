"""COLLADA files: one geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Patch,
    parse_floats,
    parse_integers,
    triangulate,
)
from wsgen.description.mesh_dae_tree import child, children, whole_number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsgen.description.mesh_dae_tree import Ids
    from wsgen.xmltree import Element

COORDINATES = 3
WIDTHS = {"NORMAL": 3, "TEXCOORD": 2}  # how many numbers a corner has of it
CORNERS = 3
UNREAD = ("polygons", "tristrips", "trifans")  # by Gazebo and PyBullet


class Geometry(NamedTuple):
    """The triangles of a geometry, in its own frame and unit."""

    corners: NDArray[Any]  # (n, 3, 3)
    is_plain: bool  # PyBullet reads the same
    oddity: str | None = None  # what is wrong and does no harm to Gazebo
    unread: frozenset[str] = frozenset()  # names of elements with faces that Gazebo does not read
    # Where somebody asked for the look: what the triangles are called that are of one material,
    # and these, of no material yet.
    patches: tuple[tuple[str | None, Patch], ...] = ()


def read_geometry(geometry: Element, ids: Ids, *, with_look: bool = False) -> Geometry:
    """The triangles and polygons of a <geometry>."""
    mesh = child(geometry, "mesh")
    if mesh is None:
        return Geometry(corners=np.empty((0, CORNERS, COORDINATES)), is_plain=False)
    reader = _Reader(ids)
    parts, patches = [], []
    for faces in children(mesh, "triangles", "polylist"):
        inputs = list(children(faces, "input"))
        table = _indices(faces, inputs)
        parts.append(reader.read(faces, inputs, table))
        if with_look and len(parts[-1]):
            normals = reader.read_rows(faces, inputs, table, "NORMAL")
            texture_points = reader.read_rows(faces, inputs, table, "TEXCOORD")
            patches.append((faces.get("material"), Patch(parts[-1], normals, texture_points)))
    unread = frozenset(name for name in UNREAD if child(mesh, name) is not None)
    return Geometry(
        corners=parts[0]
        if len(parts) == 1
        else np.concatenate([np.empty((0, CORNERS, COORDINATES)), *parts]),
        is_plain=reader.is_plain and reader.oddity is None,
        oddity=reader.oddity,
        unread=unread,
        patches=tuple(patches),
    )


class _Reader:
    """Reads the faces of one geometry."""

    def __init__(self, ids: Ids) -> None:
        self.ids = ids
        self.points: dict[str, NDArray[np.float64]] = {}  # by the address of the <vertices>
        self.is_plain = True
        self.oddity: str | None = None

    def read(
        self, faces: Element, inputs: Sequence[Element], table: NDArray[np.int64]
    ) -> NDArray[Any]:
        """The corners of a <triangles> or <polylist>, cut into triangles; shape (n, 3, 3).

        `table` has a row for each corner, and a column for each offset of the inputs.
        """
        if not table.size:
            self.is_plain = False  # PyBullet crashes on an empty one
            return np.empty((0, CORNERS, COORDINATES))
        vertices = _input(inputs, "VERTEX")
        if vertices is None:
            raise BrokenMeshError("has faces without an <input> for the vertices")
        return self._corners(faces, vertices, table[:, whole_number(vertices, "offset", 0)])

    def read_rows(
        self, faces: Element, inputs: Sequence[Element], table: NDArray[np.int64], semantic: str
    ) -> NDArray[Any] | None:
        """What else corners have, shape (n, 3, width); None where it is not there, or broken."""
        width = WIDTHS[semantic]
        vertices = _input(inputs, "VERTEX")
        source = at = _input(inputs, semantic)
        try:
            if at is None and vertices is not None:  # some give a vertex its normal at once
                inner = self.ids.find(vertices.get("source"), "vertices")
                source, at = _input(list(children(inner, "input")), semantic), vertices
            if source is None or at is None:
                return None
            column = table[:, whole_number(at, "offset", 0)]
            rows = _rows(self.ids.find(source.get("source"), "a source"), width)
        except BrokenMeshError:
            return None
        if column.min() < 0 or column.max() >= len(rows):
            return None
        found: NDArray[Any] = rows[self._cut(faces, column)]
        return found

    def _corners(self, faces: Element, source: Element, column: NDArray[np.int64]) -> NDArray[Any]:
        points = self._points_of(source.get("source", ""))
        if column.min() < 0 or column.max() >= len(points):
            wrong = column.min() if column.min() < 0 else column.max()
            raise BrokenMeshError(
                f"has {len(points)} vertices, and a face with number {wrong}, counted from 0: "
                "Gazebo and PyBullet read other memory there"
            )
        return points[self._cut(faces, column)]

    def _cut(self, faces: Element, column: NDArray[np.int64]) -> NDArray[np.int64]:
        """The indices of triangles, shape (n, 3)."""
        sizes = child(faces, "vcount")
        if sizes is None:
            if len(column) % CORNERS:
                raise BrokenMeshError(f"has {len(column)} corners, which are no whole triangles")
            self._compare_count(faces, len(column) // CORNERS)
            return column.reshape(-1, CORNERS)
        counts = parse_integers(sizes.text or "", "a <vcount>")
        if (counts < 0).any() or counts.sum() != len(column):
            raise BrokenMeshError(
                f"has polygons of {counts.sum()} corners together, and {len(column)} corners: "
                "Gazebo crashes on it"
            )
        self._compare_count(faces, len(counts))
        if (counts == CORNERS).all():
            return column.reshape(-1, CORNERS)
        self.is_plain = False  # PyBullet takes three corners of each
        return triangulate(column, counts)

    def _points_of(self, url: str) -> NDArray[np.float64]:
        if url not in self.points:
            vertices = self.ids.find(url, "vertices")
            positions = [
                one for one in children(vertices, "input") if one.get("semantic") == "POSITION"
            ]
            if not positions:
                raise BrokenMeshError("has <vertices> without an <input> for their positions")
            self.points[url] = self._read_source(
                self.ids.find(positions[0].get("source"), "a source")
            )
        return self.points[url]

    def _read_source(self, source: Element) -> NDArray[np.float64]:
        """The points of a <source>, shape (n, 3)."""
        points = _rows(source, COORDINATES)
        stride = _stride(source, COORDINATES)
        array = child(source, "float_array")
        if array is not None:
            self._compare_count(array, len(points) * stride)
        self.is_plain &= stride == COORDINATES
        return points

    def _compare_count(self, element: Element, actual: int) -> None:
        claimed = whole_number(element, "count", actual)
        if claimed != actual:
            name = element.tag.rpartition("}")[2]
            self.oddity = f'says count="{claimed}" in a <{name}>, and has {actual} there'


def _rows(source: Element, width: int) -> NDArray[np.float64]:
    """What is in a <source>, shape (n, width)."""
    array = child(source, "float_array")
    numbers = parse_floats("" if array is None else array.text or "", "its vertices")
    if not numbers.size:
        raise BrokenMeshError("has vertices without numbers: Gazebo and PyBullet crash on it")
    stride = _stride(source, width)
    if stride < width or len(numbers) % stride:
        raise BrokenMeshError(f"has {len(numbers)} numbers for its vertices, in steps of {stride}")
    return numbers.reshape(-1, stride)[:, :width]


def _stride(source: Element, default: int) -> int:
    technique = child(source, "technique_common")
    accessor = None if technique is None else child(technique, "accessor")
    return default if accessor is None else whole_number(accessor, "stride", default)


def _input(inputs: Sequence[Element], semantic: str) -> Element | None:
    """The first input of that kind; of several sets, that with the smallest number."""
    found = [one for one in inputs if one.get("semantic") == semantic]
    return min(found, key=lambda one: whole_number(one, "set", 0), default=None)


def _indices(faces: Element, inputs: Sequence[Element]) -> NDArray[np.int64]:
    """A row for each corner, a column for each offset of the inputs."""
    if any(one.get("offset") is None for one in inputs):
        raise BrokenMeshError("has an <input> without offset: Gazebo and PyBullet crash on it")
    paragraph = child(faces, "p")
    indices = parse_integers(
        "" if paragraph is None else paragraph.text or "", "the indices of its faces"
    )
    stride = max((whole_number(one, "offset", 0) for one in inputs), default=0) + 1
    if len(indices) % stride:
        raise BrokenMeshError(
            f"has {len(indices)} indices in a <p>, not a multiple of its {stride} inputs"
        )
    return indices.reshape(-1, stride)

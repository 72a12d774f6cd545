"""COLLADA files: what Gazebo reads of them, and whether PyBullet reads the same.

Gazebo applies the unit and the nodes' transforms, and leaves `up_axis` alone; so does PyBullet.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.descriptions.meshes.content import (
    BrokenMeshError,
    Content,
    Material,
    Patch,
    check_part,
    parse_floats,
    parse_integers,
    refuse_triangles,
    triangulate,
)
from wsgen.descriptions.meshes.requests import MISSING_EFFECT, MaterialProblem
from wsgen.text.xmltree import Malformed, parse_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.descriptions.meshes.requests import Rgba
    from wsgen.text.xmltree import Element

    Matrix = NDArray[np.float64]  # (4, 4)


LONGEST_NUMBER = 18  # digits


class Ids:
    """The elements of a document by their id; of two with one id the first, as in Gazebo."""

    def __init__(self, root: Element) -> None:
        self._elements: dict[str, Element] = {}
        for element in root.iter("{*}*"):
            name = element.get("id")
            if name is not None:
                self._elements.setdefault(name, element)

    def __len__(self) -> int:
        return len(self._elements)

    def get(self, name: str, kind: str) -> Element | None:
        """The element with that id, if it is of that kind."""
        found = self._elements.get(name)
        return found if found is not None and found.tag.rpartition("}")[2] == kind else None

    def find(self, url: str | None, what: str) -> Element:
        """The element with the id behind the # of an address, which is to be `what`."""
        found = self._elements.get((url or "").removeprefix("#"))
        if found is None:
            raise BrokenMeshError(
                f"refers to {what} `{url or ''}` that it does not define: Gazebo crashes or does "
                "not load it"
            )
        return found


def children(element: Element, *names: str) -> Iterator[Element]:
    """The child elements with one of these names, in whatever namespace."""
    for inner in element.iterchildren("{*}*"):
        if inner.tag.rpartition("}")[2] in names:
            yield inner


def child(element: Element, name: str) -> Element | None:
    """The first child element of that name."""
    return next(children(element, name), None)


def whole_number(element: Element, name: str, default: int) -> int:
    """An attribute that is a whole number of 0 or more."""
    text = element.get(name, str(default)).strip()
    if not text.isdecimal() or len(text) > LONGEST_NUMBER:
        raise BrokenMeshError(f'has {name}="{text}" in a <{element.tag.rpartition("}")[2]}>')
    return int(text)


COORDINATES = 3
WIDTHS = {"NORMAL": 3, "TEXCOORD": 2}  # how many numbers a corner has of it
CORNERS = 3
UNREAD = ("polygons", "tristrips", "trifans")  # by Gazebo and PyBullet


class Geometry(NamedTuple):
    """The triangles of a geometry, in its own frame and unit."""

    corners: NDArray[Any]  # (n, 3, 3)
    is_plain: bool  # PyBullet reads the same
    inconsistency: str | None = None  # a problem that Gazebo reads over
    unread: frozenset[str] = frozenset()  # names of elements with faces that Gazebo does not read
    # Where the materials were asked for: what the triangles are called that are of one material,
    # and these, of no material yet.
    patches: tuple[tuple[str | None, Patch], ...] = ()


def read_geometry(geometry: Element, ids: Ids, *, with_materials: bool = False) -> Geometry:
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
        if with_materials and len(parts[-1]):
            normals = reader.read_rows(faces, inputs, table, "NORMAL")
            texture_points = reader.read_rows(faces, inputs, table, "TEXCOORD")
            patches.append((faces.get("material"), Patch(parts[-1], normals, texture_points)))
    unread = frozenset(name for name in UNREAD if child(mesh, name) is not None)
    return Geometry(
        corners=parts[0]
        if len(parts) == 1
        else np.concatenate([np.empty((0, CORNERS, COORDINATES)), *parts]),
        is_plain=reader.is_plain and reader.inconsistency is None,
        inconsistency=reader.inconsistency,
        unread=unread,
        patches=tuple(patches),
    )


class _Reader:
    """Reads the faces of one geometry."""

    def __init__(self, ids: Ids) -> None:
        self.ids = ids
        self.points: dict[str, NDArray[np.float64]] = {}  # by the address of the <vertices>
        self.is_plain = True
        self.inconsistency: str | None = None

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
        """What else corners have, shape (n, 3, width); None where it is missing or broken."""
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
                f"has {len(points)} vertices, and a face refers to number {wrong}, counted from 0: "
                "Gazebo and PyBullet read memory out of bounds"
            )
        return points[self._cut(faces, column)]

    def _cut(self, faces: Element, column: NDArray[np.int64]) -> NDArray[np.int64]:
        """The indices of triangles, shape (n, 3)."""
        sizes = child(faces, "vcount")
        if sizes is None:
            if len(column) % CORNERS:
                raise BrokenMeshError(f"has {len(column)} corners, which is not a multiple of 3")
            self._compare_count(faces, len(column) // CORNERS)
            return column.reshape(-1, CORNERS)
        counts = parse_integers(sizes.text or "", "a <vcount>")
        if (counts < 0).any() or counts.sum() != len(column):
            raise BrokenMeshError(
                f"has polygons of {counts.sum()} corners together, but {len(column)} corners: "
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
            self.inconsistency = f'has count="{claimed}" in a <{name}>, but {actual} values'


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


SHADERS = ("lambert", "phong", "blinn")  # Gazebo passes over <constant>
LUMINANCE = (0.212671, 0.71516, 0.072169)  # of red, green and blue, as the standard has it
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)


class Materials:
    """The materials of a file."""

    def __init__(self, ids: Ids) -> None:
        self.ids = ids
        self.problems: dict[MaterialProblem, None] = {}
        self._targets: dict[str, str] = {}  # of the names that geometries give their materials
        self._read: dict[str, Material] = {}

    def bind(self, instance: Element) -> None:
        """Take the materials that an <instance_geometry> gives to its geometry."""
        for inner in instance.iter("{*}instance_material"):
            self._targets[inner.get("symbol", "")] = inner.get("target", "")

    def find(self, symbol: str | None) -> Material:
        """The material that a geometry calls by this name; without one the default."""
        if symbol is None:
            return Material()
        target = self._targets.get(symbol, symbol).removeprefix("#")
        if target not in self._read:
            self._read[target] = self._material(target)
        return self._read[target]

    def _material(self, target: str) -> Material:
        material = self.ids.get(target, "material")
        instance = None if material is None else child(material, "instance_effect")
        if instance is None:
            return Material()
        url = instance.get("url", "")
        effect = self.ids.get(url.removeprefix("#"), "effect")
        if effect is None:
            problem = MaterialProblem(
                MISSING_EFFECT,
                f"has a material `{target}` with an effect `{url}` that it does not define: Gazebo "
                "crashes on it",
                "Export the mesh again.",
            )
            self.problems[problem] = None
            return Material()
        profile = child(effect, "profile_COMMON")
        technique = None if profile is None else child(profile, "technique")
        found = [] if technique is None else [child(technique, name) for name in SHADERS]
        shader = next((one for one in found if one is not None), None)
        return Material() if shader is None else self._shaded(shader, effect)

    def _shaded(self, shader: Element, effect: Element) -> Material:
        rgba, image = None, None
        diffuse = child(shader, "diffuse")
        if diffuse is not None:
            texture = child(diffuse, "texture")
            rgba = _color(diffuse)
            if rgba is None and texture is not None:
                rgba, image = WHITE, self._image(texture.get("texture", ""), effect)
        opacity = _opacity(shader)
        if rgba is None:
            return Material()
        return Material(rgba=(*rgba[:3], opacity), image=image)

    def _image(self, name: str, effect: Element) -> str | None:
        """The address of an image, which an effect names by way of a sampler and a surface."""
        parameters = {one.get("sid"): one for one in effect.iter("{*}newparam")}
        for kind, inside in ("sampler2D", "source"), ("surface", "init_from"):
            if name not in parameters:
                break  # some name the image at once
            what = child(parameters[name], kind)
            source = None if what is None else child(what, inside)
            name = "" if source is None else (source.text or "").strip()
        image = self.ids.get(name, "image")
        address = None if image is None else child(image, "init_from")
        return None if address is None else (address.text or "").strip() or None


def _color(element: Element) -> Rgba | None:
    """The <color> in an element; None where there is none that can be read."""
    color = child(element, "color")
    try:
        numbers = parse_floats("" if color is None else color.text or "", "a color").tolist()
    except BrokenMeshError:
        return None
    if len(numbers) not in {3, 4} or not all(map(math.isfinite, numbers)):
        return None
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*numbers, 1.0)[:4])
    return (red, green, blue, alpha)


def _opacity(shader: Element) -> float:
    """From 0, invisible, to 1; it is 1 where <transparent> does not say how it is meant."""
    transparent = child(shader, "transparent")
    mode = None if transparent is None else transparent.get("opaque")
    color = None if transparent is None else _color(transparent)
    if mode is None or color is None:
        return 1.0
    factor = _factor(shader)
    luminance = sum(part * weight for part, weight in zip(color, LUMINANCE, strict=False))
    opacities = {
        "A_ONE": color[3] * factor,
        "A_ZERO": 1 - color[3] * factor,
        "RGB_ONE": luminance * factor,
        "RGB_ZERO": 1 - luminance * factor,
    }
    return min(1.0, max(0.0, opacities.get(mode, 1.0)))


def _factor(shader: Element) -> float:
    transparency = child(shader, "transparency")
    number = None if transparency is None else child(transparency, "float")
    try:
        numbers = parse_floats("" if number is None else number.text or "", "a number").tolist()
    except BrokenMeshError:
        return 1.0
    return min(1.0, max(0.0, numbers[0])) if len(numbers) == 1 else 1.0


NODE_LIMIT = 20_000  # nodes may stand for others, and those for others


def is_dae(data: bytes) -> bool:
    """Whether these are the bytes of a COLLADA file."""
    return b"<COLLADA" in data[:4096]


def read_dae(data: bytes, folder: Path | None = None, part: str | None = None) -> Content:
    """The triangles of a COLLADA file's scene, or of one of its nodes.

    With their materials if its `folder` is given.
    """
    root = parse_numbers(data)
    if isinstance(root, Malformed):
        raise BrokenMeshError(
            f"is not well-formed XML (line {root.line}: {root.message}): Gazebo crashes on it"
        )
    if root.tag.rpartition("}")[2] != "COLLADA":
        raise BrokenMeshError("is XML, but not COLLADA: Gazebo and PyBullet crash on it")
    return _Scene(root, with_materials=folder is not None).read(part)


class _Scene:
    """The nodes of the scene, and the geometries that they place."""

    def __init__(self, root: Element, *, with_materials: bool) -> None:
        self.root = root
        self.ids = Ids(root)
        self.materials = Materials(self.ids) if with_materials else None
        self.patches: list[Patch] = []
        self.geometries: dict[str, Geometry] = {}
        self.is_plain = True
        self.inconsistency: str | None = None

    def read(self, part: str | None) -> Content:
        scale = self._unit()
        parts = []
        triangles = 0
        places = list(self._places())
        if part is not None:
            check_part(part, (name for _, _, name in places))
        for instance, matrix, name in places:
            if part not in {None, name}:
                continue
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
                hint="Select the objects in the CAD or 3D program, and export the file again.",
            )
        for geometry in self.geometries.values():
            self.is_plain &= geometry.is_plain
            self.inconsistency = self.inconsistency or geometry.inconsistency
        corners = parts[0] if len(parts) == 1 else np.concatenate(parts)
        if not len(corners):
            self._refuse_unread()
        return Content(
            corners=corners,
            is_plain=self.is_plain,
            inconsistency=self.inconsistency,
            patches=tuple(self.patches),
            material_problems=() if self.materials is None else tuple(self.materials.problems),
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

    def _refuse_unread(self) -> None:
        unread = {kind for geometry in self.geometries.values() for kind in geometry.unread}
        if unread:
            raise BrokenMeshError(
                f"has only <{'>, <'.join(sorted(unread))}>, which Gazebo does not read",
                hint="Triangulate the faces when you export the file.",
            )

    def _unit(self) -> float:
        """Metres of one unit of length."""
        asset = child(self.root, "asset")
        if asset is None:
            self.is_plain = False
            self.inconsistency = "has no <asset>: PyBullet crashes on it, and its unit is unknown"
            return 1.0
        unit = child(asset, "unit")
        meter = None if unit is None else unit.get("meter")
        if meter is None:
            self.is_plain &= unit is None
            return 1.0
        return float(_floats(meter, 1, "the unit")[0])

    def _places(self) -> Iterator[tuple[Element, Matrix, str]]:
        """What the scene places: each <instance_geometry>, with the node's pose and name.

        A node without a name has that of the node that it is in.
        """
        waiting = [(node, np.eye(4), 0, "") for node in reversed(self._top_nodes())]
        for _ in range(NODE_LIMIT):
            if not waiting:
                return
            node, parent, depth, outer = waiting.pop()
            name = node.get("name") or node.get("id") or outer
            matrix = parent @ _transform(node)
            self.is_plain &= np.allclose(parent @ _transform_in_pybullet(node), matrix)
            for instance in children(node, "instance_geometry"):
                yield instance, matrix, name
            for instance in children(node, "instance_node"):
                self.is_plain = False  # PyBullet passes it over
                inner = self.ids.find(instance.get("url", ""), "a node")
                waiting.append((inner, matrix, depth + 1, name))
            waiting += [(inner, matrix, depth, name) for inner in children(node, "node")]
            if depth > len(self.ids):
                break
        if waiting:
            raise BrokenMeshError("has nodes that contain themselves, or far too many nodes")

    def _top_nodes(self) -> list[Element]:
        scene = child(self.root, "scene")
        instance = None if scene is None else child(scene, "instance_visual_scene")
        if instance is None:
            raise BrokenMeshError("has no <scene>: Gazebo crashes on it")
        return list(children(self.ids.find(instance.get("url", ""), "the scene"), "node"))

    def _geometry(self, url: str) -> Geometry:
        if url not in self.geometries:
            self.geometries[url] = read_geometry(
                self.ids.find(url, "a geometry"),
                self.ids,
                with_materials=self.materials is not None,
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
    """As PyBullet has it, which takes the first of each kind, in another order."""
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

"""The surfaces that are drawn: triangles of primitives, and those of mesh files.

A browser gets them as binary glTF 2.0.
"""

from __future__ import annotations

import functools
import itertools
import json
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.model.robot import Box, Capsule, Mesh, Sphere
from wsgen.model.transform import IDENTITY, Pose, quaternion_of_rpy

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Primitive

    Floats = NDArray[np.float32]


AROUND = 96  # faces around a round shape
UP = 32  # rings of a sphere


class Surface(NamedTuple):
    """Triangles, seen from their own frame: coordinates by three corners, by n."""

    corners: Floats  # 3 by 3 by n, m, without the scale of a mesh
    normals: Floats | None = None  # 3 by 3 by n, not a number where there is none; None: nowhere
    texture_points: Floats | None = None  # 2 by 3 by n; 0 0 is an image's lower left corner


@functools.cache  # robots have many that are alike
def surface_of(geometry: Primitive | str, around: int = AROUND, up: int = UP) -> Surface:
    """The surface of a shape, or of a mesh by its path; not to be changed.

    A mesh is an array that `wsgen.descriptions.meshes.appearance` wrote, or a mesh file in any
    format. A round shape has so many faces `around`, and a sphere so many rings `up`.
    """
    if isinstance(geometry, str):
        return _load(Path(geometry))
    if isinstance(geometry, Box):
        return _box(geometry.size)
    if isinstance(geometry, Sphere):
        return _turned(_arc(geometry.radius, -90, 90, 0.0, up), around)
    half, radius = geometry.length / 2, geometry.radius
    side = [[(radius, -half, 1.0, 0.0), (radius, half, 1.0, 0.0)]]
    if isinstance(geometry, Capsule):
        ends = _arc(radius, -90, 0, -half, up), _arc(radius, 0, 90, half, up)
        return _turned([*ends[0], *side, *ends[1]], around)
    bottom, top = ([(0.0, z, 0.0, z), (radius, z, 0.0, z)] for z in (-half, half))
    return _turned([bottom, *side, top[::-1]], around)


def forget_surfaces() -> None:
    """Free what was loaded: where robots are read again and again, files get new names."""
    surface_of.cache_clear()
    is_closed.cache_clear()


OUTLINE = 5_000  # corners are enough to know where a surface is
DIRECTIONS = np.array(
    [
        [x, y, z]
        for x in (-1, 0, 1)
        for y in (-1, 0, 1)
        for z in (-1, 0, 1)
        if (x, y, z) > (0, 0, 0)
    ],
    dtype=np.float32,
)


def outline(surface: Surface) -> Floats:
    """Corners (3 by n) that it lies between: of many some, and the outermost in each direction."""
    points = surface.corners.reshape(3, -1)
    count = points.shape[1]
    if count <= OUTLINE:
        return points
    along = DIRECTIONS @ points
    some = np.arange(0, count, count // OUTLINE)
    return points[:, np.concatenate([some, along.argmin(axis=1), along.argmax(axis=1)])]


HASHES = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


@functools.cache
def is_closed(geometry: Primitive | str) -> bool:
    """Whether each side of a triangle is the opposite side of another: a surface without a border.

    It compares sums over all sides, of a number that hardly two different sides have in common.
    """
    bits = (surface_of(geometry).corners + np.float32(0)).view(np.uint32).astype(np.uint64)  # no -0
    corners = _mixed(sum(row * number for row, number in zip(bits, HASHES, strict=True)))
    after = corners[[1, 2, 0]]
    sides, opposite = (_mixed(a * HASHES[0] + b) for a, b in ((corners, after), (after, corners)))
    return bool(sides.sum() == opposite.sum())


def _mixed(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    mixed: NDArray[np.uint64] = (numbers ^ (numbers >> np.uint64(29))) * HASHES[1]
    return mixed


def _load(file: Path) -> Surface:
    if file.suffix == ".npy":
        rows = np.load(file)
        normals, points = (rows[part] if len(rows) > part.start else None for part in PARTS)
        return Surface(rows[:3], normals, points)
    # Of a file that was not prepared, as a collision's is not; its readers take a while to load.
    from wsgen.descriptions.meshes.worker import read_mesh  # noqa: PLC0415

    return Surface(np.ascontiguousarray(read_mesh(file).corners.astype(np.float32).T))


PARTS = slice(3, 6), slice(6, 8)  # of an array's rows: normals, texture points


def _box(size: Sequence[float]) -> Surface:
    faces = [np.roll(np.insert(SQUARE, 0, 1, axis=0), axis, axis=0) for axis in range(3)]
    quads = np.stack([*faces, *(-face[:, ::-1] for face in faces)], axis=1)  # 3 by 6 by 4
    signs = quads[:, :, QUADS].reshape(3, -1, 3).transpose(0, 2, 1)
    corners = (signs * np.array(size)[:, None, None] / 2).astype(np.float32)
    # The whole image on each face; on those above and below, x is to the right and y up.
    places = np.stack([signs[1:], signs[[0, 2]], signs[:2]])  # by axis, 2 by 3 by 12
    axes = np.tile(np.repeat(np.arange(3), len(QUADS)), 2)  # of each triangle
    points = (places[axes, :, :, np.arange(len(axes))].transpose(1, 2, 0) + 1) / 2
    return Surface(corners, texture_points=points.astype(np.float32))


SQUARE = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]])  # the corners of a face, seen from outside
QUADS = np.array([[0, 1, 2], [0, 2, 3]])  # two triangles

End = tuple[float, float, float, float]  # radius, z, and the normal's part outwards, along z


def _arc(radius: float, start: int, end: int, shift: float, up: int) -> list[list[End]]:
    count = up * (end - start) // 180
    angles = [math.radians(start + (end - start) * step / count) for step in range(count + 1)]
    ends = [
        (
            radius * math.cos(angle),
            shift + radius * math.sin(angle),
            math.cos(angle),
            math.sin(angle),
        )
        for angle in angles
    ]
    return [[low, high] for low, high in itertools.pairwise(ends)]


def _turned(profile: list[list[End]], around: int) -> Surface:
    """Lines turned about z."""
    radius, z, outwards, along = np.array(profile, dtype=np.float64).transpose(2, 0, 1)[..., None]
    angles = np.linspace(0, 2 * np.pi, around + 1)
    cos, sin = np.cos(angles), np.sin(angles)
    cos[-1], sin[-1] = 1, 0  # the last are the first, to the bit
    radius[np.abs(radius) < np.abs(radius).max() * 1e-9] = 0
    flat = np.ones_like(cos)
    rows = np.stack(
        [radius * cos, radius * sin, z * flat, outwards * cos, outwards * sin, along * flat]
    )  # 6 by lines by their two ends by angles
    low, high = rows[:, :, 0], rows[:, :, 1]
    corners = [low[..., :-1], low[..., 1:], high[..., 1:], high[..., :-1]]
    halves = [
        np.stack([corners[number] for number in order], axis=1).reshape(6, 3, -1) for order in QUADS
    ]
    both = np.concatenate(halves, axis=2)
    points = both[:3]
    has_area = ((points[:, 0] != points[:, 1]) | (points[:, 0] != points[:, 2])).any(axis=0)
    both = both[..., has_area].astype(np.float32)
    return Surface(both[:3], both[3:])


MAGIC, VERSION = 0x46546C67, 2
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
FLOAT, ARRAY_BUFFER = 5126, 34962
SOLID = 0.999  # what has less alpha is transparent
ROUGHNESS = 0.65
IMAGE_TYPES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


class Part(NamedTuple):
    """A shape in a color or with a texture."""

    geometry: Primitive | Mesh  # a mesh whose path `surface_of` loads
    rgba: tuple[float, float, float, float]  # sRGB, 0 to 1
    pose: Pose = IDENTITY  # in the frame of the file
    texture: str | None = None  # a PNG or JPEG file


def write_glb(parts: Iterable[Part], *, opacity: float = 1.0) -> bytes | None:
    """The parts as one file; None if nothing of them can be drawn.

    glTF has y up: the file keeps the frame of the parts, as robots' viewers expect it. Shapes that
    are used more than once are written once.
    """
    writer = _Writer(opacity)
    for part in parts:
        writer.add(part)
    return writer.finish()


class _Writer:
    """Collects what is in the file."""

    def __init__(self, opacity: float) -> None:
        self._opacity = opacity
        self._nodes: list[dict[str, Any]] = []
        self._meshes: list[dict[str, Any]] = []
        self._materials: list[dict[str, Any]] = []
        self._textures: list[dict[str, Any]] = []
        self._images: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._data = bytearray()
        self._known: dict[object, int] = {}  # what is written -> its number in its list

    def add(self, part: Part) -> None:
        """Add a part, unless it has no finite place or no triangle."""
        scale = part.geometry.scale if isinstance(part.geometry, Mesh) else (1.0, 1.0, 1.0)
        numbers = (*part.pose.xyz, *part.pose.rpy, *scale)
        if not all(map(math.isfinite, numbers)) or 0.0 in scale:
            return
        mesh = self._mesh(part)
        if mesh is None:
            return
        node: dict[str, Any] = {"mesh": mesh}
        if part.pose.xyz != IDENTITY.xyz:
            node["translation"] = part.pose.xyz
        if part.pose.rpy != IDENTITY.rpy:
            node["rotation"] = quaternion_of_rpy(part.pose.rpy)
        if scale != (1.0, 1.0, 1.0):
            node["scale"] = scale
        self._nodes.append(node)

    def finish(self) -> bytes | None:
        """The bytes of the file."""
        if not self._nodes:
            return None
        document = {
            "asset": {"version": "2.0", "generator": "wsgen"},
            "scene": 0,
            "scenes": [{"nodes": [*range(len(self._nodes))]}],
            "nodes": self._nodes,
            "meshes": self._meshes,
            "materials": self._materials,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._data)}],
        }
        if self._textures:
            document |= {"textures": self._textures, "images": self._images}
        header = json.dumps(document, separators=(",", ":")).encode()
        header += b" " * (-len(header) % 4)
        size = 12 + 8 + len(header) + 8 + len(self._data)
        return b"".join(
            (
                struct.pack("<III", MAGIC, VERSION, size),
                struct.pack("<II", len(header), JSON_CHUNK),
                header,
                struct.pack("<II", len(self._data), BINARY_CHUNK),
                self._data,
            )
        )

    def _mesh(self, part: Part) -> int | None:
        geometry = part.geometry
        shape: Primitive | str
        if isinstance(geometry, Mesh):
            if geometry.path is None:
                return None
            shape = geometry.path
        else:
            shape = geometry
        key = ("mesh", shape, part.rgba, part.texture)
        if key not in self._known:
            surface = surface_of(shape)
            if not surface.corners.size:
                return None
            has_texture = part.texture is not None and surface.texture_points is not None
            primitive = {
                "attributes": self._attributes(shape, surface, has_texture=has_texture),
                "material": self._material(part.rgba, part.texture if has_texture else None),
            }
            self._known[key] = len(self._meshes)
            self._meshes.append({"primitives": [primitive]})
        return self._known[key]

    def _attributes(
        self, shape: Primitive | str, surface: Surface, *, has_texture: bool
    ) -> dict[str, int]:
        attributes = {"POSITION": self._accessor((shape, "points"), _rows(surface.corners))}
        normals = _normals(surface)
        if normals is not None:  # without them a browser shows each triangle flat
            attributes["NORMAL"] = self._accessor((shape, "normals"), _rows(normals))
        if has_texture and surface.texture_points is not None:
            points = _rows(surface.texture_points)
            points[:, 1] = 1 - points[:, 1]  # glTF's origin is the upper left corner
            attributes["TEXCOORD_0"] = self._accessor((shape, "texture points"), points)
        return attributes

    def _accessor(self, key: object, rows: Floats) -> int:
        if key not in self._known:
            self._known[key] = len(self._accessors)
            self._accessors.append(
                {
                    "bufferView": self._view(rows.tobytes(), target=ARRAY_BUFFER),
                    "componentType": FLOAT,
                    "count": len(rows),
                    "type": f"VEC{rows.shape[1]}",
                    "min": rows.min(axis=0).tolist(),
                    "max": rows.max(axis=0).tolist(),
                }
            )
        return self._known[key]

    def _view(self, data: bytes, *, target: int | None = None) -> int:
        view = {"buffer": 0, "byteOffset": len(self._data), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._data += data
        self._data += bytes(-len(data) % 4)
        self._views.append(view)
        return len(self._views) - 1

    def _material(self, rgba: Sequence[float], texture: str | None) -> int:
        key = ("material", tuple(rgba), texture)
        if key not in self._known:
            alpha = rgba[3] * self._opacity
            look: dict[str, Any] = {
                "baseColorFactor": [*map(_linear, rgba[:3]), alpha],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGHNESS,
            }
            image = None if texture is None else self._texture(texture)
            if image is not None:
                look["baseColorTexture"] = {"index": image}
            material: dict[str, Any] = {"pbrMetallicRoughness": look, "doubleSided": True}
            if alpha < SOLID:
                material["alphaMode"] = "BLEND"
            self._known[key] = len(self._materials)
            self._materials.append(material)
        return self._known[key]

    def _texture(self, file: str) -> int | None:
        data = Path(file).read_bytes()
        kind = next((kind for magic, kind in IMAGE_TYPES.items() if data.startswith(magic)), None)
        if kind is None:
            return None
        key = ("texture", file)
        if key not in self._known:
            self._known[key] = len(self._textures)
            self._images.append({"bufferView": self._view(data), "mimeType": kind})
            self._textures.append({"source": len(self._images) - 1})
        return self._known[key]


def _rows(corners: Floats) -> Floats:
    """Coordinates by three corners by n, as one row for each corner."""
    return np.ascontiguousarray(corners.transpose(2, 1, 0).reshape(-1, len(corners)))


def _normals(surface: Surface) -> Floats | None:
    """The normals of the corners, of length 1; those of the triangle where a corner has none."""
    normals = surface.normals
    if normals is None:
        return None
    lengths = np.sqrt((normals * normals).sum(axis=0, keepdims=True))
    is_known = np.isfinite(lengths) & (lengths > 0)
    if not is_known.all():
        first, second, third = surface.corners.transpose(1, 0, 2)
        flat = np.cross(second - first, third - first, axis=0)
        normals = np.where(is_known, normals, flat[:, None, :])
        lengths = np.sqrt((normals * normals).sum(axis=0, keepdims=True))
    has_length = lengths > 0
    unit = normals / np.where(has_length, lengths, 1)
    up = np.array([0, 0, 1], dtype=np.float32)[:, None, None]  # of a triangle without area
    return np.where(has_length, unit, up).astype(np.float32)


def _linear(level: float) -> float:
    """The amount of light of a level of sRGB."""
    level = min(max(level, 0.0), 1.0)
    return level / 12.92 if level <= 0.04045 else ((level + 0.055) / 1.055) ** 2.4  # noqa: PLR2004

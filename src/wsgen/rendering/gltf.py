"""Write surfaces as binary glTF 2.0, which browsers draw."""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.model.robot import Mesh
from wsgen.model.transform import IDENTITY, Pose, quaternion_of_rpy
from wsgen.rendering.surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import Primitive
    from wsgen.rendering.surfaces import Surface

    Floats = NDArray[np.float32]


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

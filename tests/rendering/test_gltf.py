"""Binary glTF: read again with trimesh, it has the same triangles in the same places."""

from __future__ import annotations

import io
import json
import math
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from wsgen.model.robot import Box, Cylinder, Mesh, Sphere
from wsgen.model.transform import Pose
from wsgen.rendering.surfaces import Part, surface_of, write_glb

if TYPE_CHECKING:
    from pathlib import Path

RED = (1.0, 0.0, 0.0, 1.0)


def parts_of(data: bytes) -> dict[str, Any]:
    """The JSON of a file."""
    magic, version, size = struct.unpack_from("<III", data)
    assert (magic, version, size) == (0x46546C67, 2, len(data))
    length, kind = struct.unpack_from("<II", data, 12)
    assert kind == 0x4E4F534A
    document: dict[str, Any] = json.loads(data[20 : 20 + length])
    return document


def read(data: bytes | None) -> Any:
    assert data is not None
    scene = trimesh.load_scene(io.BytesIO(data), file_type="glb", process=False)
    return scene.to_mesh()


def mesh_file(folder: Path, rows: int = 3) -> Mesh:
    """An array as `meshes.appearance` writes it: one triangle, perhaps with more rows."""
    points = np.array([[0, 1, 0], [0, 0, 2], [0, 0, 3]], dtype=np.float32)
    normals = np.array([[0, 0, math.nan], [0, 0, 0], [2, 1, 0]], dtype=np.float32)
    texture_points = np.array([[0, 1, 0], [0, 0.25, 1]], dtype=np.float32)
    array = np.concatenate([points, normals, texture_points])[:rows, :, None]
    file = folder / f"mesh{rows}.npy"
    np.save(file, array)
    return Mesh(uri="m", path=str(file))


def test_shapes_have_their_triangles_in_their_places() -> None:
    pose = Pose((1.0, 2.0, 3.0), (0.0, 0.0, math.pi / 2))
    mesh = read(write_glb([Part(Box(size=(2.0, 4.0, 6.0)), RED, pose)]))
    assert mesh.bounds == pytest.approx(np.array([[-1, 1, 0], [3, 3, 6]]))
    assert len(mesh.faces) == 12
    assert mesh.volume == pytest.approx(48.0)


def test_a_mirrored_mesh_is_mirrored(tmp_path: Path) -> None:
    mesh = mesh_file(tmp_path)
    mirrored = Mesh(uri="m", path=mesh.path, scale=(1.0, -1.0, 2.0))
    low, high = read(write_glb([Part(mirrored, RED)])).bounds.tolist()
    assert (low, high) == ([0, -2, 0], [1, 0, 6])


def test_normals_have_length_1_and_missing_ones_are_those_of_the_triangle(tmp_path: Path) -> None:
    data = write_glb([Part(mesh_file(tmp_path, 6), RED)])
    assert data is not None
    document = parts_of(data)
    view = document["bufferViews"][document["accessors"][1]["bufferView"]]
    start = data.index(b"BIN\0") + 4 + view["byteOffset"]
    normals = np.frombuffer(data[start : start + view["byteLength"]], dtype=np.float32)
    flat = np.cross([1, 0, 0], [0, 2, 3]) / np.linalg.norm(np.cross([1, 0, 0], [0, 2, 3]))
    assert normals.reshape(3, 3) == pytest.approx(np.array([[0, 0, 1], [0, 0, 1], flat]))


def test_a_texture_is_in_the_file_and_right_side_up(tmp_path: Path) -> None:
    image = tmp_path / "image.png"
    Image.new("RGB", (2, 2), "blue").save(image)
    data = write_glb([Part(mesh_file(tmp_path, 8), RED, texture=str(image))])
    assert data is not None
    document = parts_of(data)
    assert document["images"][0]["mimeType"] == "image/png"
    assert image.read_bytes() in data
    view = document["bufferViews"][document["accessors"][2]["bufferView"]]
    start = data.index(b"BIN\0") + 4 + view["byteOffset"]
    points = np.frombuffer(data[start : start + view["byteLength"]], dtype=np.float32)
    assert points.reshape(3, 2).tolist() == [[0, 1], [1, 0.75], [0, 0]]


def test_equal_shapes_are_written_once() -> None:
    wheel = Cylinder(radius=0.1, length=0.05)
    one = write_glb([Part(wheel, RED)])
    four = write_glb([Part(wheel, RED, Pose((x, 0.0, 0.0))) for x in range(4)])
    assert one is not None
    assert four is not None
    assert len(four) < len(one) + 500
    assert len(read(four).faces) == 4 * len(read(one).faces)


def test_what_has_no_place_or_no_size_is_left_out() -> None:
    ball = Sphere(radius=1.0)
    assert write_glb([Part(ball, RED, Pose((math.nan, 0, 0)))]) is None
    assert write_glb([Part(Mesh(uri="m", path=None), RED)]) is None
    assert write_glb([Part(Mesh(uri="m", path="x", scale=(0.0, 1.0, 1.0)), RED)]) is None
    assert write_glb([]) is None


def test_transparent_and_faint_parts_are_blended() -> None:
    ball = Sphere(radius=1.0)
    for data, alpha in (
        (write_glb([Part(ball, (1, 0, 0, 0.5))]), 0.5),
        (write_glb([Part(ball, RED)], opacity=0.3), 0.3),
    ):
        assert data is not None
        (material,) = parts_of(data)["materials"]
        assert material["alphaMode"] == "BLEND"
        assert material["pbrMetallicRoughness"]["baseColorFactor"][3] == alpha
    solid = write_glb([Part(ball, RED)])
    assert solid is not None
    assert "alphaMode" not in parts_of(solid)["materials"][0]


def test_the_surface_of_a_shape_is_not_changed() -> None:
    before = surface_of(Sphere(radius=0.7)).corners.copy()
    write_glb([Part(Sphere(radius=0.7), RED)])
    assert (surface_of(Sphere(radius=0.7)).corners == before).all()

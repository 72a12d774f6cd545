"""STL files that are text, for PyBullet; that it stands on them is in `test_engines`."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.robots import CYLINDER, body, shape, single
from wsgen.model.robot import Mesh
from wsgen.simulation.bullet_meshes import with_readable_meshes

if TYPE_CHECKING:
    from pathlib import Path

TEXT = b"""solid part
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1.5e+0 0 0
      vertex 0 1 -2
    endloop
  endfacet
endsolid part
"""
BINARY = struct.pack("<80xI12f2x", 1, 0, 0, 1, *range(9))


def mesh_of(tmp_path: Path, name: str, content: bytes) -> Mesh:
    file = tmp_path / name
    file.write_bytes(content)
    return Mesh(uri=name, path=str(file), scale=(1.0, 2.0, 3.0))


def test_text_is_written_in_binary_form_once(tmp_path: Path) -> None:
    folder = tmp_path / "new"
    folder.mkdir()
    mesh = mesh_of(tmp_path, "part.STL", TEXT)
    link = replace(body(mesh), collisions=(shape(mesh), shape(CYLINDER), shape(mesh, mu=0.1)))
    made = with_readable_meshes(single(link), folder)
    (file,) = folder.iterdir()
    first, cylinder, second = made.links[0].collisions
    assert first.geometry == replace(mesh, path=str(file))
    assert second == replace(first, surface=second.surface)
    assert (cylinder, second.surface.mu1) == (shape(CYLINDER), 0.1)
    triangle = (0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0, -2.0)
    assert file.read_bytes() == struct.pack("<80xI12x9f2x", 1, *triangle)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("part.stl", BINARY),
        ("part.stl", b"solid" + BINARY[5:]),  # some programs write that into binary files
        ("part.stl", b""),
        ("part.stl", b"solid part\nendsolid part\n"),
        ("part.stl", TEXT.replace(b"-2", b"two")),
        ("part.stl", b"\0\xff" * 500),
        ("part.obj", TEXT),
    ],
)
def test_everything_else_stays_as_it_is(tmp_path: Path, name: str, content: bytes) -> None:
    robot = single(body(mesh_of(tmp_path, name, content)))
    assert with_readable_meshes(robot, tmp_path) == robot


def test_a_mesh_that_is_not_there(tmp_path: Path) -> None:
    for mesh in (Mesh(uri="m.stl"), Mesh(uri="m.stl", path=str(tmp_path / "gone.stl"))):
        assert with_readable_meshes(single(body(mesh)), tmp_path) == single(body(mesh))

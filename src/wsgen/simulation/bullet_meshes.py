"""Mesh files that PyBullet cannot read, or not by itself.

Gazebo reads STL files that are text; PyBullet leaves such a shape out, and the robot falls through
the ground.
"""

from __future__ import annotations

import re
import struct
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.model.robot import Mesh

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Collision, Robot
    from wsgen.simulation.bullet_client import Client

HEADER = struct.Struct("<80xI")  # of a binary STL file: the number of triangles
TRIANGLE = struct.Struct("<12x9f2x")  # without the normal, which PyBullet computes
VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)")


def without_missing_meshes(tree: Robot) -> Robot:
    """The same tree without what nothing can touch, because its file is not there."""
    links = []
    for link in tree.links:
        there = tuple(
            shape
            for shape in link.collisions
            if not (isinstance(shape.geometry, Mesh) and shape.geometry.path is None)
        )
        links.append(replace(link, collisions=there))
    return replace(tree, links=tuple(links))


def with_readable_meshes(tree: Robot, folder: Path) -> Robot:
    """The same tree, with STL files that are text written anew in binary form into `folder`."""
    written: dict[str, str] = {}
    links = []
    for link in tree.links:
        collisions = tuple(_readable(shape, folder, written) for shape in link.collisions)
        links.append(replace(link, collisions=collisions))
    return replace(tree, links=tuple(links))


def unread_mesh(client: Client, body: int, tree: Robot, index_of: Mapping[str, int]) -> str | None:
    """A file of the tree that PyBullet left out without an error; `index_of` is by link name."""
    for link in tree.links:
        shapes = [shape.geometry for shape in link.collisions]
        files = [str(shape.path) for shape in shapes if isinstance(shape, Mesh)]
        if files:
            loaded = client.getCollisionShapeData(body, index_of[link.name])
            if len(loaded) < len(shapes):
                read = {shape[4].decode(errors="replace") for shape in loaded}
                return next((file for file in files if file not in read), files[0])
    return None


def _readable(shape: Collision, folder: Path, written: dict[str, str]) -> Collision:
    mesh = shape.geometry
    if not isinstance(mesh, Mesh) or mesh.path is None or not mesh.path.lower().endswith(".stl"):
        return shape
    if mesh.path not in written:
        triangles = _triangles_of_text(Path(mesh.path))
        target = Path(folder, f"{len(written)}.stl")
        if triangles is not None:
            target.write_bytes(triangles)
        written[mesh.path] = str(target) if triangles is not None else mesh.path
    return replace(shape, geometry=replace(mesh, path=written[mesh.path]))


def _triangles_of_text(file: Path) -> bytes | None:
    """A text file as a binary one; None for what is binary already, or nothing that is known."""
    try:
        with file.open("rb") as opened:
            start = opened.read(HEADER.size)
            size = file.stat().st_size
            is_binary = (
                len(start) == HEADER.size
                and size == HEADER.size + TRIANGLE.size * HEADER.unpack(start)[0]
            )
            if is_binary or not start.lstrip().startswith(b"solid"):
                return None
            text = start + opened.read()
        numbers = [float(part) for vertex in VERTEX.findall(text) for part in vertex]
    except (OSError, ValueError):
        return None
    corners = [numbers[at : at + 9] for at in range(0, len(numbers) - 8, 9)]
    if not corners:
        return None
    return HEADER.pack(len(corners)) + b"".join(TRIANGLE.pack(*nine) for nine in corners)

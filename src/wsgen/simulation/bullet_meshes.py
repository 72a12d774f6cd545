"""Mesh files that PyBullet does not take."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.robot import Mesh, Triangulated

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Robot
    from wsgen.simulation.bullet_client import Client


def without_missing_meshes(tree: Robot) -> Robot:
    """The same tree without what nothing can touch: meshes without a file, unknown shapes."""
    links = []
    for link in tree.links:
        there = tuple(
            shape
            for shape in link.collisions
            if not isinstance(shape.geometry, Triangulated)
            and not (isinstance(shape.geometry, Mesh) and shape.geometry.path is None)
        )
        links.append(replace(link, collisions=there))
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

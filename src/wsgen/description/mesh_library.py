"""GLB, glTF and PLY files; the one place that imports trimesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Content,
    Material,
    Patch,
    flat_normals,
)

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray


def read_with_library(file: Path, kind: str, *, with_look: bool = False) -> Content:
    """The triangles of all meshes of the file, in its own frame; with their look if asked for.

    The nodes' transforms are applied and glTF's y stays where it is, as Gazebo has it.

    Args:
        file: The file.
        kind: `glb`, `gltf` or `ply`.
        with_look: Whether to read materials and normals as well.
    """
    # It takes longer to import than most robots' meshes to read, and is seldom needed.
    import trimesh  # noqa: PLC0415

    try:
        scene = trimesh.load_scene(str(file), file_type=kind, process=False)
        corners = np.asarray(scene.to_mesh().triangles, dtype=np.float64)
        patches = tuple(_patches(scene)) if with_look else ()
    except Exception as error:  # the library raises anything on a broken file
        raise BrokenMeshError(
            f"cannot be read as {kind.upper()} ({type(error).__name__}: {error})"
        ) from error
    return Content(corners=corners.reshape(-1, 3, 3), is_plain=False, patches=patches)


def _patches(scene: Any) -> Iterator[Patch]:
    """The triangles of each node with a mesh; Gazebo shows no colours of vertices."""
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph.get(node)
        mesh = scene.geometry[name]
        faces = np.asarray(getattr(mesh, "faces", ()), dtype=np.int64)
        if not len(faces):
            continue  # lines, or points
        linear = np.asarray(matrix, dtype=np.float64)[:3, :3]
        if np.linalg.det(linear) < 0:  # mirrored, it is seen from the other side
            faces = faces[:, ::-1]
        vertices = np.asarray(mesh.vertices, dtype=np.float64) @ linear.T + matrix[:3, 3]
        uv = getattr(mesh.visual, "uv", None)
        texture_points = None if uv is None else np.asarray(uv, dtype=np.float64)[faces]
        yield Patch(
            corners=vertices[faces],
            normals=_smooth_normals(vertices, faces)[faces],
            texture_points=texture_points,
            material=_material(getattr(mesh.visual, "material", None)),
        )


def _smooth_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Of vertices: the formats have one vertex for each side of a sharp edge."""
    flat = flat_normals(vertices[faces])
    return np.stack(
        [
            np.bincount(faces.ravel(), np.repeat(flat[:, axis], 3), minlength=len(vertices))
            for axis in range(3)
        ],
        axis=-1,
    )


def _material(material: Any) -> Material:
    """A material of glTF."""
    factor = getattr(material, "baseColorFactor", None)
    image = getattr(material, "baseColorTexture", None)
    if factor is None and image is None:
        return Material()
    rgba = np.asarray([255] * 4 if factor is None else factor, dtype=np.float64).ravel() / 255
    red, green, blue, alpha = (float(part) for part in (*rgba[:3], *rgba[3:], 1.0)[:4])
    is_solid = getattr(material, "alphaMode", None) in {None, "OPAQUE"}
    return Material(rgba=(red, green, blue, 1.0 if is_solid else alpha), image=image)

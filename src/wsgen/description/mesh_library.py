"""GLB, glTF and PLY files; the one place that imports trimesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.description.mesh_content import BrokenMeshError, Content

if TYPE_CHECKING:
    from pathlib import Path


def read_with_library(file: Path, kind: str) -> Content:
    """The triangles of all meshes of the file, in its own frame.

    The nodes' transforms are applied and glTF's y stays where it is, as Gazebo has it.

    Args:
        file: The file.
        kind: `glb`, `gltf` or `ply`.
    """
    # It takes longer to import than most robots' meshes to read, and is seldom needed.
    import trimesh  # noqa: PLC0415

    try:
        mesh = trimesh.load_scene(str(file), file_type=kind, process=False).to_mesh()
        corners = np.asarray(mesh.triangles, dtype=np.float64)
    except Exception as error:  # the library raises anything on a broken file
        raise BrokenMeshError(
            f"cannot be read as {kind.upper()} ({type(error).__name__}: {error})"
        ) from error
    return Content(corners=corners.reshape(-1, 3, 3), is_plain=False)

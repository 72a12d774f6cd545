"""The child process that inspects mesh files.

Reads a mesh file of any format: STL, OBJ and COLLADA here, GLB, glTF and PLY with trimesh.
"""

from __future__ import annotations

import json
import os
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast
from urllib.parse import unquote

import numpy as np

from wsgen.descriptions.meshes.appearance import AppearanceWriter
from wsgen.descriptions.meshes.content import (
    FILE_LIMIT,
    BrokenMeshError,
    Content,
    EnormousMeshError,
    Material,
    Patch,
    bounds_of,
    check_part,
    damaged,
    flat_normals,
    refuse_lfs_pointer,
    refuse_triangles,
)
from wsgen.descriptions.meshes.dae import is_dae, read_dae
from wsgen.descriptions.meshes.obj import is_obj, read_obj
from wsgen.descriptions.meshes.requests import InspectedMesh, MeshRequest, Solid, UnusableMesh
from wsgen.descriptions.meshes.stl import is_stl, read_stl, write_stl
from wsgen.isolation.child import announce
from wsgen.text.files import irregular_kind, read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from wsgen.model.robot import MeshPart
    from wsgen.model.transform import Vector


GLB_SIZE = slice(8, 12)  # the bytes of a GLB that say how many it has


class _Neighbors:
    """What the library asks for the files that a mesh names."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def get(self, name: str) -> bytes:
        """The bytes of a file; raises BrokenMeshError where they cannot be had."""
        needed = f"needs the file `{name[:200]}`, which"
        try:
            data = read_regular(self.folder / unquote(name.strip()), FILE_LIMIT)
        except FileNotFoundError:
            problem = f"{needed} does not exist"
        except (OSError, ValueError) as error:
            problem = f"{needed} cannot be read ({getattr(error, 'strerror', None) or error})"
        else:
            if len(data) <= FILE_LIMIT:
                return data
            problem = f"{needed} has more than {FILE_LIMIT / 1e6:.0f} MB"
        raise BrokenMeshError(
            problem, hint="Copy it next to the mesh, or export the mesh as one GLB file."
        )

    __getitem__ = get


def read_with_library(
    data: bytes, kind: str, folder: Path, part: str | None = None, *, with_materials: bool = False
) -> Content:
    """The triangles of all meshes of the file, in its own frame; with their materials if asked for.

    The nodes' transforms are applied and glTF's y stays where it is, as Gazebo has it.

    Args:
        data: The bytes of the file.
        kind: `glb`, `gltf` or `ply`.
        folder: Where the file is, and those that it names.
        part: The name of the only node to read.
        with_materials: Whether to read materials and normals as well.
    """
    # It takes longer to import than most robots' meshes to read, and is seldom needed.
    import trimesh  # noqa: PLC0415

    claimed = int.from_bytes(data[GLB_SIZE], "little")
    if kind == "glb" and claimed > len(data):
        raise BrokenMeshError(
            f"says that it has {claimed} bytes, but ends after {len(data)}: it is cut short"
        )
    try:
        if kind == "gltf":
            json.loads(data)  # the library reads another file where this one is broken
        scene = trimesh.load_scene(
            BytesIO(data), file_type=kind, resolver=cast("Any", _Neighbors(folder)), process=False
        )
        if part is not None:
            check_part(part, scene.graph.nodes_geometry)
        patches = tuple(_patches(scene, part)) if with_materials or part is not None else ()
        if part is None:
            corners = np.asarray(scene.to_mesh().triangles, dtype=np.float64)
        else:
            corners = np.concatenate([np.empty((0, 3, 3)), *(one.corners for one in patches)])
    except (BrokenMeshError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  the library raises anything on a broken file
        raise damaged(kind) from None
    return Content(corners=corners.reshape(-1, 3, 3), is_plain=False, patches=patches)


def _patches(scene: Any, part: str | None) -> Iterator[Patch]:
    """The triangles of each node with a mesh, or of one; Gazebo shows no colors of vertices."""
    for node in scene.graph.nodes_geometry:
        if part not in {None, node}:
            continue
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


RECOGNIZE: dict[str, Callable[[bytes], bool]] = {  # by the extension that files of the format have
    "glb": lambda data: data.startswith(b"glTF"),
    "ply": lambda data: data.startswith((b"ply\n", b"ply\r")),
    "dae": is_dae,
    "stl": is_stl,
    "obj": is_obj,
    "gltf": lambda data: data[:1024].lstrip().startswith(b"{") and b'"asset"' in data,
}
READ: dict[str, Callable[[bytes, Path | None, str | None], Content]] = {
    "dae": read_dae,
    "stl": read_stl,
    "obj": read_obj,
}


def read_mesh(file: Path, part: MeshPart | None = None, *, with_materials: bool = False) -> Content:
    """The triangles of a mesh file, or of one part of it; with their materials if asked for.

    Raises:
        BrokenMeshError: It cannot be used.
        OSError: It cannot be read.
    """
    _check_is_there(file)
    kind = file.suffix[1:].lower()
    if kind not in RECOGNIZE:
        raise BrokenMeshError(
            f"has a format that wsgen does not read ({file.suffix or 'no extension'})",
            hint="Convert it to STL, OBJ or COLLADA.",
        )
    data = file.read_bytes()
    if not data:
        raise BrokenMeshError("is empty (0 bytes)")
    refuse_lfs_pointer(data)
    if not RECOGNIZE[kind](data):
        other = next((name for name, looks_so in RECOGNIZE.items() if looks_so(data)), None)
        if other is not None:
            raise BrokenMeshError(
                f"contains {other.upper()}, but simulators read it as {kind.upper()} because of "
                "its extension",
                hint=f"Give the file the extension .{other}.",
            )
    try:
        name = None if part is None else part.name
        if kind in READ:
            content = READ[kind](data, file.parent if with_materials else None, name)
        else:
            content = read_with_library(
                data, kind, file.parent, name, with_materials=with_materials
            )
    except (BrokenMeshError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  the numbers of a damaged file lead anywhere
        raise damaged(kind) from None
    return content if part is None else _alone(content, part)


def _alone(content: Content, part: MeshPart) -> Content:
    """What was read of a part, which no engine reads from the file by itself."""
    content = content._replace(is_plain=False, cleaned=None)
    if not (part.is_centered and len(content.corners)):
        return content
    low, high = bounds_of(content.corners)
    middle = np.add(low, high) / 2
    return content._replace(
        corners=content.corners - middle,
        patches=tuple(one._replace(corners=one.corners - middle) for one in content.patches),
    )


def _check_is_there(file: Path) -> None:
    """That it is a regular file of bearable size; opening anything else may wait for ever."""
    kind = irregular_kind(file)
    if kind is not None:
        raise BrokenMeshError(f"is {kind}", hint="Give a mesh file.")
    size = file.stat().st_size
    if size > FILE_LIMIT:
        raise EnormousMeshError(
            f"has {size / 1e6:.0f} MB; wsgen reads at most {FILE_LIMIT / 1e6:.0f} MB"
        )
    # It is missing only where the file system ignores upper and lower case.
    if file.name not in os.listdir(file.parent):  # noqa: PTH208  names suffice
        raise BrokenMeshError(
            "differs from the description in upper and lower case",
            hint="Write the exact name of the file; case matters on other file systems.",
        )


CRASHING = 1e18  # m; squares of it are beyond single precision, in which engines calculate


def inspect(requests: Sequence[MeshRequest], folder: Path) -> list[InspectedMesh | UnusableMesh]:
    """Inspect every file; announces the number of the one it is at.

    What PyBullet would not read, or not as Gazebo does, is rewritten into `folder`: every COLLADA
    file for collisions, as PyBullet's loader knows only a part of the format and crashes on much of
    it.
    """
    answers = []
    writer = AppearanceWriter(folder)
    for number, request in enumerate(requests):
        announce(str(number))
        answers.append(_inspect(request, number, folder, writer))
    return answers


def _inspect(
    request: MeshRequest, number: int, folder: Path, writer: AppearanceWriter
) -> InspectedMesh | UnusableMesh:
    file, rewritten = Path(request.path), folder / f"{number}.stl"
    try:
        content = read_mesh(file, request.part, with_materials=bool(request.showings))
        low, high = _bounds(content.corners)
        colored, problems = writer.write(file, content, request.showings)
    except BrokenMeshError as error:
        is_enormous = isinstance(error, EnormousMeshError)
        return UnusableMesh(problem=error.problem, hint=error.hint, is_enormous=is_enormous)
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        return UnusableMesh(problem=problem, hint="Check that the file exists and is readable.")
    except MemoryError:
        problem = "needs more memory to be read than wsgen allows"
        return UnusableMesh(problem=problem, hint="Reduce its triangles.")
    if content.cleaned is not None:
        file = folder / f"{number}.obj"
        file.write_bytes(content.cleaned)
    is_collision_plain = content.is_plain and file.suffix.lower() != ".dae"
    is_rewritten = (request.is_collision and not is_collision_plain) or (
        request.is_visual and not content.is_plain
    )
    if is_rewritten:
        write_stl(content.corners, rewritten)
    return InspectedMesh(
        triangles=len(content.corners),
        low=low,
        high=high,
        inconsistency=content.inconsistency,
        collision=str(file if is_collision_plain else rewritten),
        visual=str(file if content.is_plain else rewritten),
        colored=tuple(colored),
        material_problems=tuple(problems),
    )


def _bounds(corners: NDArray[Any]) -> tuple[Vector, Vector]:
    """The corners of the box around triangles, m."""
    if not len(corners):
        raise BrokenMeshError("has no triangles: Gazebo silently ignores it")
    refuse_triangles(len(corners))
    low, high = bounds_of(corners)
    if not np.isfinite([*low, *high]).all() or max(-min(low), *high) > CRASHING:
        raise BrokenMeshError(
            "has a vertex with an infinite, huge or undefined coordinate, which cannot be drawn or "
            "simulated"
        )
    return low, high


def measure(requests: Sequence[tuple[str, Vector]]) -> list[Solid | None]:
    """What meshes have as solid bodies of density 1, by path and scale; None of one without volume.

    One that is not closed has the volume of its convex hull, or of the box around it.
    """
    return [_solid(read_mesh(Path(path)).corners * scale) for path, scale in requests]


def _solid(corners: NDArray[np.float64]) -> Solid | None:
    import trimesh  # noqa: PLC0415  see above

    is_closed = _is_closed(corners)
    if not is_closed:
        mesh = _mesh_of(corners)
        try:
            mesh = mesh.convex_hull
        except Exception:  # noqa: BLE001  without scipy, or of a flat mesh
            mesh = trimesh.creation.box(bounds=mesh.bounds)
        corners = np.asarray(mesh.triangles, dtype=np.float64)
    # The integrals of the tetrahedra over a point within, whose sum is the body.
    middle = corners.mean(axis=(0, 1))
    tetrahedra = corners - middle
    sums = tetrahedra.sum(axis=1)
    volumes = np.linalg.det(tetrahedra) / 6
    volume = volumes.sum()
    volumes, volume = (-volumes, -volume) if volume < 0 else (volumes, volume)  # seen from inside
    if not volume > 0:
        return None
    center = volumes @ sums / 4 / volume
    second = np.einsum("t,tci,tcj->ij", volumes, tetrahedra, tetrahedra)
    second = (second + np.einsum("t,ti,tj->ij", volumes, sums, sums)) / 20
    second -= volume * np.outer(center, center)
    inertia = np.trace(second) * np.eye(3) - second
    x, y, z = map(float, center + middle)
    return Solid(
        volume=float(volume),
        center=(x, y, z),
        inertia=tuple(map(float, inertia[np.triu_indices(3)])),
        is_closed=is_closed,
    )


def _is_closed(corners: NDArray[np.float64]) -> bool:
    """Whether each edge of a triangle is one of another triangle, the other way round."""
    points, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = numbers.reshape(-1, 3)
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    is_edge = starts != ends  # triangles without an area have others
    starts, ends = starts[is_edge], ends[is_edge]
    forth, back = starts * len(points) + ends, ends * len(points) + starts
    return bool(len(forth)) and np.array_equal(np.sort(forth), np.sort(back))


def _mesh_of(corners: NDArray[np.float64]) -> Any:
    import trimesh  # noqa: PLC0415  see above

    faces = np.arange(corners.size // 3).reshape(-1, 3)
    return trimesh.Trimesh(vertices=corners.reshape(-1, 3), faces=faces)  # equal corners merged


def write_mirrored(requests: Sequence[tuple[str, Vector, str]]) -> None:
    """Write meshes as they are with some axes mirrored, as STL: path, signs and new path."""
    for path, signs, target in requests:
        corners = read_mesh(Path(path)).corners * signs
        if np.prod(signs) < 0:  # else it would be seen from inside
            corners = corners[:, ::-1]
        write_stl(corners, Path(target))


def write_hull(path: str, target: str) -> bool:
    """Write the convex hull of a mesh, as STL; False where scipy, which computes it, is missing."""
    try:
        hull = _mesh_of(read_mesh(Path(path)).corners).convex_hull
    except ImportError:
        return False
    write_stl(np.asarray(hull.triangles, dtype=np.float64), Path(target))
    return True


# Sixteen hulls of at most 124 triangles; a mesh of 100,000 triangles takes some seconds.
DECOMPOSITION = {
    "threshold": 0.1,
    "max_convex_hull": 16,
    "decimate": True,
    "max_ch_vertex": 64,
    "preprocess_mode": "on",
    "preprocess_resolution": 30,
    "resolution": 500,
    "mcts_iterations": 30,
    "mcts_nodes": 10,
}


def write_parts(path: str, folder: str) -> list[str]:
    """Write convex bodies that together have the shape of a mesh, as STL; returns their paths.

    They are none where coacd, which finds them, is not installed.
    """
    try:
        import coacd  # noqa: PLC0415  0.1 s, and it is an extra
    except (ImportError, OSError):  # without a library that it loads
        return []
    coacd.set_log_level("off")
    mesh = _mesh_of(read_mesh(Path(path)).corners)
    parts = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), **DECOMPOSITION)
    places = []
    for number, (vertices, faces) in enumerate(parts, 1):
        places.append(Path(folder, f"{number}.stl"))
        write_stl(np.asarray(vertices, dtype=np.float64)[np.asarray(faces)], places[-1])
    return [str(place) for place in places]

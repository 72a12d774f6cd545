"""Meshes that other people have published, read by us and by trimesh."""

from __future__ import annotations

import math
import re
import tempfile
from collections import defaultdict
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.meshes import worker
from wsgen.descriptions.meshes.requests import InspectedMesh, MeshRequest, UnusableMesh

if TYPE_CHECKING:
    from collections.abc import Sequence

    Corners = Sequence[Sequence[float]]  # the lowest and the highest of a box

PACKAGES = (
    *("pybullet", "example-robot-data", "icub-models", "jvrc-description"),
    *("gym-ignition-models", "rtb-data", "upkie_description"),
)
REFUSED = {
    "168.obj": "infinite, huge or undefined",  # of PyBullet's random objects
    "link6.stl-old.stl": "Macintosh",  # of a Puma 560
}
LARGEST = 2_000_000  # bytes, of a mesh of the sample
SAMPLE = 2  # meshes of one kind in one folder, or in folders that have numbers for names
SHOWINGS = (False,)


def meshes_of(distribution: str, *, every: bool) -> list[Path]:
    """The meshes of a package that is installed; or a sample, and those that are refused."""
    try:
        found = files(distribution) or []
    except PackageNotFoundError:
        return []
    extensions = {".stl", ".obj", ".dae", ".glb", ".gltf", ".ply"}
    meshes = sorted(
        Path(str(file.locate())).resolve() for file in found if file.suffix.lower() in extensions
    )
    if every:
        return meshes
    alike: dict[tuple[str, str], list[Path]] = defaultdict(list)
    for mesh in (mesh for mesh in meshes if mesh.stat().st_size < LARGEST):
        alike[re.sub(r"\d+", "", str(mesh.parent)), mesh.suffix.lower()].append(mesh)
    return sorted(
        {file for kind in alike.values() for file in kind[:: math.ceil(len(kind) / SAMPLE)]}
        | {file for file in meshes if file.name in REFUSED}
    )


def differences(meshes: Sequence[Path]) -> list[str]:
    """What is wrong with what we read, a line for each of these meshes at most."""
    found = [(file, _difference(file)) for file in meshes]
    return [f"{file}: {words}" for file, words in found if words]


def _difference(file: Path) -> str | None:
    with tempfile.TemporaryDirectory() as folder:
        plain, seen = (
            worker.inspect([_request(file, showings)], Path(folder))[0]
            for showings in ((), SHOWINGS)
        )
    if isinstance(plain, UnusableMesh) or isinstance(seen, UnusableMesh) or file.name in REFUSED:
        if _problem(plain) != _problem(seen):
            return f"{_problem(plain)}, and with colors {_problem(seen)}"
        is_expected = file.name in REFUSED and REFUSED[file.name] in _problem(plain)
        return None if is_expected else _problem(plain)
    mine = (plain.low, plain.high)
    extent = max(high - low for low, high in zip(*mine, strict=True))
    corners = [corner for part in seen.colored[0] for corner in (part.low, part.high)]
    shown = tuple([of(along) for along in zip(*corners, strict=True)] for of in (min, max))
    if _distance(mine, shown) > 1e-6 * extent:
        return f"{mine}, and with colors {shown}"
    theirs = _bounds_of_trimesh(file)
    if theirs is not None and _distance(mine, theirs) > 1e-5 * extent:
        return f"{mine}, and trimesh says {theirs}"
    return None


def _request(file: Path, showings: tuple[bool, ...]) -> MeshRequest:
    return MeshRequest(
        path=str(file), is_collision=False, is_visual=not showings, showings=showings
    )


def _problem(answer: InspectedMesh | UnusableMesh) -> str:
    return answer.problem if isinstance(answer, UnusableMesh) else "can be used"


def _bounds_of_trimesh(file: Path) -> Corners | None:
    import trimesh  # noqa: PLC0415  it may be missing where the module is imported

    try:
        scene = trimesh.load_scene(file)
    except Exception as error:
        if "Malformed" in type(error).__name__:  # one has text behind its end
            return None
        raise
    if scene.bounds is None:
        return None  # it drops triangles of no area, and of one file all
    units = scene.units or ""  # "0.0254 * meters"; as another scale trimesh knows none
    unit = float(units.split()[0]) if "*" in units else 1.0
    return tuple([unit * part for part in side] for side in scene.bounds)


def _distance(one: Corners, other: Corners) -> float:
    """The largest between two pairs of corners, along an axis, m."""
    return max(
        abs(mine - their)
        for side, opposite in zip(one, other, strict=True)
        for mine, their in zip(side, opposite, strict=True)
    )

"""Packages with the examples of the rules' documentation, and what is reported about them."""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING

import trimesh
from PIL import Image

from mesh_samples import binary_stl, dae
from planted_examples import cmake, finish_robot, manifest
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.reported import Filters, filter_outcome

if TYPE_CHECKING:
    from pathlib import Path

    from planted_examples import Files
    from wsgen.diagnostics import Diagnostic


def complete(files: Files, distro: str) -> dict[str, str]:
    """The files of a whole package: with a manifest and a build file, where they are not given."""
    folders = sorted({name.partition("/")[0] for name in files if "/" in name} - {"src", "scripts"})
    given = {
        name: finish_robot(text) if name.endswith((".urdf", ".xacro")) and text else text
        for name, text in files.items()
    }
    whole = {
        "package.xml": manifest(distro),
        "CMakeLists.txt": cmake(" ".join(folders)),
    } | given
    return {name: text for name, text in whole.items() if text is not None}


def _glb() -> bytes:
    return bytes(trimesh.creation.box((1, 1, 1)).export(file_type="glb"))


def _stl(edge: float) -> bytes:
    return bytes(trimesh.creation.box((edge, edge, edge)).export(file_type="stl"))


def _png() -> bytes:
    buffer = io.BytesIO()
    Image.new("L", (33, 33), 100).save(buffer, "png")
    return buffer.getvalue()


CONTENT = {
    "STL": binary_stl(),
    "STL_MM": _stl(200),
    "STL_OF_50": _stl(50),
    "DAE": dae().encode(),
    "GLB": _glb(),
    "PNG": _png(),
}


def write(folder: Path, name: str, files: dict[str, str]) -> None:
    for path, text in files.items():
        file = folder / name / path.replace("my_robot", name)
        if path.endswith("/"):
            file.mkdir(parents=True)
            continue
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(CONTENT.get(text) or text.replace("my_robot", name).encode())


SOURCED: dict[str, dict[str, str]] = {"fortress": {"ROS_DISTRO": "humble"}, "unknown": {}}


def check_all(folder: Path, distro: str) -> dict[str, list[Diagnostic]]:
    """What is reported, by package."""
    environment = {
        "PATH": os.environ["PATH"],
    } | SOURCED.get(distro, {"ROS_DISTRO": distro})
    outcome = check(CheckRequest(paths=[folder]), environment=environment)
    found: dict[str, list[Diagnostic]] = {}
    for one in filter_outcome(outcome, Filters()).diagnostics:
        name = one.file.relative_to(folder).parts[0] if one.file else ""
        found.setdefault(name, []).append(one)
    return found

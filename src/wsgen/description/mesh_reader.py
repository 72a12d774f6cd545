"""A mesh file of any format that is read."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.description.mesh_content import (
    FILE_LIMIT,
    BrokenMeshError,
    EnormousMeshError,
    damaged,
)
from wsgen.description.mesh_dae import is_dae, read_dae
from wsgen.description.mesh_library import read_with_library
from wsgen.description.mesh_obj import is_obj, read_obj
from wsgen.description.mesh_stl import is_stl, read_stl
from wsgen.files import irregular_kind

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.description.mesh_content import Content

RECOGNISE: dict[str, Callable[[bytes], bool]] = {  # by the extension that files of the format have
    "glb": lambda data: data.startswith(b"glTF"),
    "ply": lambda data: data.startswith((b"ply\n", b"ply\r")),
    "dae": is_dae,
    "stl": is_stl,
    "obj": is_obj,
    "gltf": lambda data: data[:1024].lstrip().startswith(b"{") and b'"asset"' in data,
}
READ: dict[str, Callable[[bytes, Path | None], Content]] = {
    "dae": read_dae,
    "stl": read_stl,
    "obj": read_obj,
}


def read_mesh(file: Path, *, with_look: bool = False) -> Content:
    """The triangles of a mesh file; with their look if asked for.

    Raises:
        BrokenMeshError: It cannot be used.
        OSError: It cannot be read.
    """
    _check_is_there(file)
    kind = file.suffix[1:].lower()
    if kind not in RECOGNISE:
        raise BrokenMeshError(
            f"is of a format that is not read ({file.suffix or 'no extension'})",
            hint="Convert it to STL, OBJ or COLLADA.",
        )
    data = file.read_bytes()
    if not data:
        raise BrokenMeshError("is empty (0 bytes)")
    if not RECOGNISE[kind](data):
        other = next((name for name, looks_so in RECOGNISE.items() if looks_so(data)), None)
        if other is not None:
            raise BrokenMeshError(
                f"is called .{kind} and holds {other.upper()}: simulators go by the name",
                hint=f"Give the file the extension .{other}.",
            )
    try:
        if kind in READ:
            return READ[kind](data, file.parent if with_look else None)
        return read_with_library(data, kind, file.parent, with_look=with_look)
    except (BrokenMeshError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  the numbers of a damaged file lead anywhere
        raise damaged(kind) from None


def _check_is_there(file: Path) -> None:
    """That it is a regular file of bearable size; opening anything else may wait for ever."""
    kind = irregular_kind(file)
    if kind is not None:
        raise BrokenMeshError(f"is {kind}", hint="Name a mesh file.")
    size = file.stat().st_size
    if size > FILE_LIMIT:
        raise EnormousMeshError(
            f"has {size / 1e6:.0f} MB; more than {FILE_LIMIT / 1e6:.0f} are not read"
        )
    # It is not there only where the file system takes small letters for capitals.
    if file.name not in os.listdir(file.parent):  # noqa: PTH208  names suffice
        raise BrokenMeshError(
            "has other capitals in its name than the description",
            hint="Write the name as the file has it: elsewhere capitals count.",
        )

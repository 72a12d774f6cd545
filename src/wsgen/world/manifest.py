"""`model.config`: which file in the folder of a model is the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.files import read_regular
from wsgen.world.lookup import is_file
from wsgen.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST_LIMIT = 2**20  # bytes


def file_of_model(folder: Path) -> Path | None:
    """The newest SDF file that model.config names, else model.sdf."""
    manifest = folder / "model.config"
    named: list[tuple[tuple[int, ...], str]] = []
    content = _read(manifest)
    if content is not None:
        root = parse(content)
        if not isinstance(root, Malformed):
            named = [
                (_digits(sdf.get("version") or ""), (sdf.text or "").strip())
                for sdf in children(root, "sdf")
                if (sdf.text or "").strip()
            ]
    if named:
        return folder / max(named)[1]
    plain = folder / "model.sdf"
    return plain if is_file(plain) else None


def _read(manifest: Path) -> bytes | None:
    """What is in it; None where there is no such file, or none that may be read."""
    try:
        return read_regular(manifest, MANIFEST_LIMIT)
    except OSError:
        return None


def _digits(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".") if part.isascii() and part.isdigit())

"""A robot from elsewhere, before it is a package."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  a NamedTuple
from pathlib import Path  # noqa: TC003  a NamedTuple
from typing import NamedTuple

from wsgen.porting.ported import Unported  # noqa: TC001  a NamedTuple


class Description(NamedTuple):
    """A robot from elsewhere, as a URDF and the files that it names."""

    name: str  # as its source calls the robot
    text: str  # URDF
    file: Path  # that it was read from
    meshes: Mapping[str, Path | bytes]  # by file name as `text` writes it: its file, or its bytes
    notes: tuple[Unported, ...]  # what a URDF cannot say

"""A robot from elsewhere, before it is a package."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  a NamedTuple
from pathlib import Path  # noqa: TC003  a NamedTuple
from typing import NamedTuple

from wsgen.model.inertia import Six  # noqa: TC001  a NamedTuple
from wsgen.model.transform import Vector  # noqa: TC001  a NamedTuple
from wsgen.porting.ported import Unported  # noqa: TC001  a NamedTuple


class Configuration(NamedTuple):
    """Where the masses of a robot are with some positions of its joints."""

    positions: Mapping[str, float]  # rad or m, by joint
    centers: Mapping[str, Vector]  # of mass, by link; m, seen from the root link
    # By link: about its center of mass, along the axes of the root link, of each kg; m².
    inertias: Mapping[str, Six]


class Reference(NamedTuple):
    """What another program has of a robot."""

    program: str
    mass: float  # kg, of all links
    configurations: tuple[Configuration, ...]


class Description(NamedTuple):
    """A robot from elsewhere, as a URDF and the files that it names."""

    name: str  # as its source calls the robot
    text: str  # URDF
    file: Path  # that it was read from
    meshes: Mapping[str, Path | bytes]  # by file name as `text` writes it: its file, or its bytes
    notes: tuple[Unported, ...]  # what a URDF cannot say
    included: tuple[Path, ...] = ()  # other files that it was read from
    reference: Reference | None = None
    taken: tuple[str, ...] = ()  # of `meshes`, names that stood for no file: one was found

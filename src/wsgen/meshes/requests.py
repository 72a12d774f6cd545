"""What the child processes of this package are asked for, and what they answer.

Lengths are in m. A problem goes on after the name of the mesh or shape.
"""

from __future__ import annotations

from dataclasses import dataclass

from wsgen.diagnostics import Rule  # noqa: TC001  the type hints of answers are read
from wsgen.model.transform import Vector  # noqa: TC001

Rgba = tuple[float, float, float, float]  # 0 to 1


@dataclass(frozen=True)
class Showing:
    """A way in which a robot shows a mesh."""

    is_painted: bool  # all of it in one color, which is not the file's
    scale: Vector
    times: int  # in so many places


@dataclass(frozen=True, kw_only=True)
class MeshRequest:
    """A mesh file to inspect, and what it is used for."""

    path: str
    is_collision: bool
    is_visual: bool  # seen, and its materials are not asked for
    showings: tuple[Showing, ...] = ()  # the ways in which it is seen with its materials


@dataclass(frozen=True)
class MaterialProblem:
    """What is wrong with the materials of a mesh."""

    rule: Rule
    problem: str
    hint: str


@dataclass(frozen=True, kw_only=True)
class ColoredMesh:
    """A file that a renderer draws in one color."""

    path: str
    rgba: Rgba | None  # None: the simulator's default
    texture: str | None  # an image, multiplied with the color
    low: Vector  # the corners of the box around its triangles, unscaled
    high: Vector
    triangles: int


@dataclass(frozen=True, kw_only=True)
class InspectedMesh:
    """A mesh file that can be used."""

    triangles: int
    low: Vector  # the corners of the box around them, unscaled
    high: Vector
    inconsistency: str | None  # a problem that Gazebo reads over
    collision: str  # the file to take instead for a collision, which may be the same
    visual: str  # likewise for a visual
    colored: tuple[tuple[ColoredMesh, ...], ...] = ()  # for each showing of the request
    material_problems: tuple[MaterialProblem, ...] = ()


@dataclass(frozen=True, kw_only=True)
class UnusableMesh:
    """A mesh file that cannot be used."""

    problem: str
    hint: str
    is_enormous: bool = False


@dataclass(frozen=True, kw_only=True)
class BuiltShape:
    """The surface of a shape as a mesh."""

    path: str
    low: Vector  # the corners of the box around it
    high: Vector
    pixels: int = 0  # of a heightmap's image, on a side
    rows: int = 0  # of a heightmap's corners


@dataclass(frozen=True, kw_only=True)
class UnbuildableShape:
    """A shape of which no mesh can be made."""

    problem: str
    hint: str

"""What the child processes of this package are asked for, and what they answer.

Lengths are in m. A problem goes on after the name of the mesh or shape.
"""

from __future__ import annotations

from wsgen.diagnostics import Rule, Severity
from wsgen.model.robot import MeshPart  # noqa: TC001
from wsgen.model.transform import Vector  # noqa: TC001
from wsgen.text.values import dataclass

Rgba = tuple[float, float, float, float]  # 0 to 1

# Checked by the child that reads the files; here, so that listing all rules loads no NumPy.
MISSING_TEXTURE = Rule(
    code="ROB073",
    name="missing-texture",
    severity=Severity.WARNING,
    summary="A mesh file names a texture that does not exist.",
    what="Looks for the images of a COLLADA or OBJ file next to the mesh and in "
    "`../materials/textures`, as Gazebo does. Runs only where a picture or a video is drawn.",
    why="Gazebo draws the part without its texture. Often the image is not installed, or the mesh "
    "names a path of the machine on which it was exported.",
    example="<init_from>C:/Users/me/wood.png</init_from>",
    instead="<init_from>wood.png</init_from>",
)

UNUSABLE_TEXTURE = Rule(
    code="ROB074",
    name="unusable-texture",
    severity=Severity.WARNING,
    summary="A texture of a mesh is damaged, too large or of an unknown format.",
    what="Opens the images of the meshes. Runs only where a picture or a video is drawn.",
    why="A renderer draws the part without its texture, or needs long to load it.",
    example="A PNG of 16384 by 16384 pixels.",
    instead="A PNG of at most 2048 by 2048 pixels.",
)

MISSING_MATERIAL_LIBRARY = Rule(
    code="ROB075",
    name="missing-material-library",
    severity=Severity.INFO,
    summary="The .mtl file that an OBJ file names cannot be read.",
    what="Opens the files of `mtllib`. Runs only where a picture or a video is drawn.",
    why="The colors and textures of an OBJ file are in its .mtl file: without it the part is gray.",
    example="mtllib /home/me/cad/arm.mtl",
    instead="mtllib arm.mtl",
)

MISSING_EFFECT = Rule(
    code="ROB076",
    name="missing-effect",
    severity=Severity.WARNING,
    summary="A material of a COLLADA file names an effect that the file does not have.",
    what="Resolves the materials of COLLADA files. Runs only where a picture or a video is drawn.",
    why="Gazebo crashes when it loads such a file.",
    example='<material id="red"><instance_effect url="#missing"/></material>',
    instead='<material id="red"><instance_effect url="#red-effect"/></material>',
)


@dataclass(frozen=True, kw_only=True)
class MeshRequest:
    """A mesh file to inspect, and what it is used for."""

    path: str
    part: MeshPart | None = None  # of the file; None: all of it
    is_collision: bool
    is_visual: bool  # seen, and its materials are not asked for
    # The ways in which it is seen with its materials: True where all of it has one color, which is
    # not the file's.
    showings: tuple[bool, ...] = ()


@dataclass(frozen=True)
class MaterialProblem:
    """What is wrong with the materials of a mesh."""

    rule: Rule
    problem: str
    hint: str


@dataclass(frozen=True, kw_only=True)
class ColoredMesh:
    """An array that a renderer draws in one color; see `AppearanceWriter`."""

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


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A mesh as a solid body of density 1, in its own frame."""

    volume: float  # m³
    center: Vector  # of mass, m
    inertia: tuple[float, ...]  # about the center of mass, m⁵: ixx ixy ixz iyy iyz izz
    is_closed: bool = True  # else it is what its convex hull has, or the box around it

"""What a page shows of the end of a simulation: a picture, and surfaces to turn."""

from __future__ import annotations

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class ViewPart:
    """Triangles of one link that have one color.

    A corner is three numbers, x, y, z: `low` + `step` × the number is its position in the world.
    Arrays are little-endian, in base64.
    """

    entity: str
    link: str
    rgba: tuple[float, float, float, float]  # 0 to 1
    is_round: bool = False  # to be shaded smoothly
    is_robot: bool = True  # not a static model of the world
    low: tuple[float, float, float]  # m
    step: tuple[float, float, float]  # m
    corners: str  # uint16
    triangles: str  # three numbers of corners each: uint16, or uint32 if there are more corners
    has_wide_numbers: bool = False  # uint32


@dataclass(frozen=True, kw_only=True)
class SceneView:
    """The robots at the end of the simulation, before their behaviors."""

    picture: str | None = None  # WebP, in base64
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: str | None = None  # likewise of all that is around, if there is more
    parts: tuple[ViewPart, ...] = ()
    has_ground: bool = True
    tile: float = 1.0  # m, edge of a square of the ground that fits the robots
    triangles: int = 0  # of all parts
    triangles_before: int = 0  # before they were simplified
    problem: str | None = None  # why something of it is missing; goes on after "Cannot draw it:"

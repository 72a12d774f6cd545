"""Models of the database of Gazebo Classic that Fuel may lack, as plain shapes of their size.

Those that public worlds have, of one link. Source: osrf/gazebo_models, the shapes of the collisions
or, where these are meshes, what the meshes fill.
"""

from __future__ import annotations

from typing import NamedTuple


class Shape(NamedTuple):
    """A shape: m."""

    kind: str  # of SDF: `box` with its edges, `cylinder` with radius and length
    sizes: tuple[float, ...]
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in the frame of the link, or the mesh


class PlainModel(NamedTuple):
    """A model."""

    shape: Shape
    above: float = 0.0  # m, where its link is, or the model if nothing says where that is
    # kg, and the moments of inertia (kg m²) about the center of the shape; None: it is static.
    inertia: tuple[float, float, float, float] | None = None


_JERSEY_BARRIER = Shape("box", (0.6082, 1.8014, 1.05), (0, -0.0305, 0.525))
_CYLINDER = Shape("cylinder", (0.2794, 0.8634), (0, 0, 0.4317))
_MAZE_WALL = Shape("box", (1.2, 0.01, 1.2), (0, 0.6, 0.6))
_PARKING_BLOCK = Shape("box", (0.1609, 1.8041, 0.1016), (0, 0, 0.0508))
_BLOCK_WALL = Shape("box", (1.5875, 0.1429, 0.7745), (-0.1475, 0, 0.078))
_POSTBOX = Shape("box", (0.6818, 0.6849, 1.524), (0, 0, 0.762))
_TIN = Shape("cylinder", (0.04, 0.028), (0, 0, 0.014))
_DISK = Shape("cylinder", (0.15678, 0.0579), (0, 0, 0.02895))
_ARM = Shape("box", (0.29824, 0.43206, 0.20367), (0, -0.12223, 0.101835))
_VALVE_WALL = Shape("box", (1.2192, 0.00952, 2.4384), (0.6096, 0.00476, 1.2192))

PLAIN_MODELS = {
    "arm_part": PlainModel(_ARM, inertia=(0.5, 0.00950655, 0.00543452, 0.01148429)),
    "asphalt_plane": PlainModel(Shape("box", (20, 20, 0.1))),
    "brick_box_3x1x3": PlainModel(Shape("box", (3, 1, 3)), above=1.5),
    "cube_20k": PlainModel(Shape("box", (1, 1, 1)), above=0.5, inertia=(1, 1, 1, 1)),
    "disk_part": PlainModel(_DISK, inertia=(0.5, 0.00321218, 0.00321218, 0.00614499)),
    "drc_practice_block_wall": PlainModel(_BLOCK_WALL, above=0.30924),
    "drc_practice_blue_cylinder": PlainModel(_CYLINDER),
    "drc_practice_orange_jersey_barrier": PlainModel(_JERSEY_BARRIER),
    "drc_practice_valve_wall": PlainModel(
        _VALVE_WALL, inertia=(2.5, 1.23872608, 1.548384, 0.30969568)
    ),
    "drc_practice_white_jersey_barrier": PlainModel(_JERSEY_BARRIER),
    "drc_practice_yellow_parking_block": PlainModel(_PARKING_BLOCK),
    "grey_wall": PlainModel(Shape("box", (7.5, 0.2, 2.8)), above=1.4),
    "mud_box": PlainModel(Shape("box", (8, 10, 0.2))),
    "nist_maze_wall_120": PlainModel(_MAZE_WALL),
    "postbox": PlainModel(_POSTBOX),
    "round_tin_base": PlainModel(_TIN, inertia=(0.0223, 1.931e-5, 1.931e-5, 3.568e-5)),
}
# Their meshes, which worlds that Gazebo Classic has saved name.
PLAIN_MESHES = {
    "arm_part/meshes/arm.dae": _ARM,
    "brick_box_3x1x3/meshes/simple_box.dae": Shape("box", (1, 1, 1)),
    "cube_20k/meshes/cube_20k.stl": Shape("box", (2, 2, 2)),
    "disk_part/meshes/disk.dae": _DISK,
    "drc_practice_block_wall/meshes/block_wall.dae": _BLOCK_WALL,
    "drc_practice_blue_cylinder/meshes/cylinder.dae": _CYLINDER,
    "drc_practice_orange_jersey_barrier/meshes/jersey_barrier.dae": _JERSEY_BARRIER,
    "drc_practice_valve_wall/meshes/five_dice_wall.dae": _VALVE_WALL,
    "drc_practice_white_jersey_barrier/meshes/jersey_barrier.dae": _JERSEY_BARRIER,
    "drc_practice_yellow_parking_block/meshes/block.dae": _PARKING_BLOCK,
    "nist_maze_wall_120/meshes/nist_maze_wall_120.dae": _MAZE_WALL,
    "postbox/meshes/postbox.dae": _POSTBOX,
    "round_tin_base/meshes/round_tin_base.dae": _TIN,
}

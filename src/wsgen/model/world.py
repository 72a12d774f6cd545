"""A world that robots are spawned into. SI units; poses are seen from the world frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.model.transform import IDENTITY, Pose

if TYPE_CHECKING:
    from pathlib import Path


_SUN = (-0.5, 0.1, -0.9)  # where the light of Gazebo's own sun goes
SUN_DIRECTION = (
    _SUN[0] / math.hypot(*_SUN),
    _SUN[1] / math.hypot(*_SUN),
    _SUN[2] / math.hypot(*_SUN),
)
SUN_COLOR = (0.8, 0.8, 0.8)


@dataclass(frozen=True, kw_only=True)
class PlacedModel:
    """A model in a world."""

    name: str
    uri: str | None = None  # what it was included by; None: written in the world file
    pose_in_world: Pose = IDENTITY
    is_static: bool = False


@dataclass(frozen=True, kw_only=True)
class World:
    """What an SDF world file says, as far as a simulation needs it; the defaults are Gazebo's."""

    name: str
    file: Path | None = None  # None: the empty world that wsgen supplies
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.8)  # m/s²
    step: float = 0.001  # s, of the physics engine
    models: tuple[PlacedModel, ...] = ()
    has_ground_plane: bool = False  # a plane at z = 0 that carries the robots
    lights: tuple[str, ...] = ()
    # Of the first directional light that shines down: which way it goes, of length 1, in the world
    # frame, and its red, green and blue from 0 to 1. Without one these are Gazebo's own sun's.
    sun_direction: tuple[float, float, float] = SUN_DIRECTION
    sun_color: tuple[float, float, float] = SUN_COLOR
    plugins: tuple[str, ...] = ()  # file names of the plugin libraries

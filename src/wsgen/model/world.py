"""A world that robots are spawned into. SI units; poses are seen from the world frame.

What a plan puts into the simulator, and which simulator it starts.
"""

from __future__ import annotations

import math
from pathlib import Path  # noqa: TC003  the file of a live run is decoded by type hints
from typing import TYPE_CHECKING

from wsgen.model.transform import IDENTITY, Pose
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from wsgen.model.plan import Process


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
    iterations: tuple[float | None, int | None] = (None, None)  # of ODE's solver, and their line
    # <contact_max_correcting_vel>, and its line.
    correcting_speed: tuple[float | None, int | None] = (None, None)
    models: tuple[PlacedModel, ...] = ()
    has_ground_plane: bool = False  # a plane at z = 0 that carries the robots
    ground_friction: float = 1.0  # its coefficient; of it and the other one, the smaller counts
    # Of the first directional light that shines down: which way it goes, of length 1, in the world
    # frame, and its red, green and blue from 0 to 1. Without one these are Gazebo's own sun's.
    sun_direction: tuple[float, float, float] = SUN_DIRECTION
    sun_color: tuple[float, float, float] = SUN_COLOR
    plugins: tuple[str, ...] = ()  # file names of the plugin libraries
    simulator: str | None = None  # that loads it, "classic" or "gz"; None: it is not known

    @property
    def is_classic(self) -> bool:
        """Whether Gazebo Classic loads it, whose physics are those of ODE."""
        return self.simulator == "classic"


@dataclass(frozen=True, kw_only=True)
class SpawnHeight:
    """Where a launch file says how high a robot is spawned, or where it could say so."""

    file: Path | None
    line: int | None
    option: str  # "-z", or "z" among the parameters or launch arguments
    holder: str  # what has the option: "the arguments of spawn_entity.py"
    is_given: bool = False  # if not, the spawner takes its default
    launch_argument: str | None = None  # the one whose value it is


@dataclass(frozen=True, kw_only=True)
class Spawn:
    """A robot that the plan puts into the simulator."""

    entity: str
    description: str  # text of a URDF or SDF; empty: the model of `model_uri`
    model_uri: str | None = None  # the address of a model that Gazebo looks up
    description_file: Path | None = None  # where it was read from, when that is known
    pose_in_world: Pose = IDENTITY
    process: Process | None = None  # the spawner
    height: SpawnHeight | None = None
    is_assumed: bool = False  # the spawner is not known, nor where it puts the robot


@dataclass(frozen=True, kw_only=True)
class Simulator:
    """The simulator that the plan starts."""

    kind: str  # "classic" or "gz"
    world: str | None  # path or name as the launch gives it; None: the simulator's default world
    is_headless: bool = False
    is_world_known: bool = True  # if not, `world` is None in its place

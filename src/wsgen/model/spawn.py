"""What a plan puts into the simulator, and which simulator it starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.model.transform import IDENTITY, Pose

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.plan import Process


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
    description: str  # URDF text
    description_file: Path | None = None  # where it was read from, when that is known
    pose_in_world: Pose = IDENTITY
    process: Process | None = None  # the spawner
    height: SpawnHeight | None = None


@dataclass(frozen=True, kw_only=True)
class Simulator:
    """The simulator that the plan starts."""

    kind: str  # "classic" or "gz"
    world: str | None  # path or name as the launch gives it; None: the simulator's default world
    is_headless: bool = False

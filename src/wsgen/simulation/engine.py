"""What a trial needs of a physics engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.scene import SpawnedRobot


@dataclass(frozen=True)
class Loaded:
    """What the engine made of a robot."""

    links: int
    movable_joints: int
    mass: float  # kg


@dataclass(frozen=True)
class Refused:
    """The engine does not simulate the robot."""

    reason: str


@dataclass(frozen=True)
class State:
    """How a robot is at this moment, seen from the world."""

    xyz: tuple[float, float, float]  # m, of the root link's frame
    xyzw: tuple[float, float, float, float]  # orientation of the root link, unit quaternion
    speed: float  # m/s, of the root link's centre of mass
    turning: float  # rad/s, of the root link
    joint_speed: float  # rad/s or m/s, of the fastest joint; 0 without movable joints


class Engine(Protocol):
    """A world in a physics engine; robots are addressed by their entity names.

    An engine makes its world when it is constructed, with the ground plane, gravity and step of a
    `World`.
    """

    step_seconds: float

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """Put a robot into the world, at rest, its joints passive."""

    def state(self, entity: str) -> State:
        """Where the robot is and how it moves."""

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m; that of the root without any."""

    def advance(self, steps: int) -> None:
        """Let time pass."""

    def draw(self, file: Path) -> float:
        """Write a PNG in which all robots are seen; gives the edge of the ground's squares, m."""

    def close(self) -> None:
        """Give everything back; the engine is not used afterwards."""

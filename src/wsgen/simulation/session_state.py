"""What the child process of a session answers. SI units; poses are seen from the world frame."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  the type hints of answers are read

from wsgen.model.transform import Pose  # noqa: TC001
from wsgen.simulation.engine import Loaded, Refused  # noqa: TC001
from wsgen.simulation.scene import RobotRun  # noqa: TC001
from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class RobotState:
    """How a robot is at a moment."""

    entity: str
    pose_in_world: Pose  # of the root link's frame
    links: Mapping[str, Pose]  # the frames of the lumped links in the world, by name
    joint_positions: Mapping[str, float]  # rad or m, of the movable joints
    joint_velocities: Mapping[str, float]  # rad/s or m/s
    speed: float  # m/s, of the root link's center of mass
    turning: float  # rad/s, of the root link
    tilt: float  # rad, between what was up in the robot when spawned and up
    is_finite: bool  # no pose or speed is infinite or not-a-number

    @property
    def joint_speed(self) -> float:
        """The velocity of the fastest joint, rad/s or m/s, never negative; 0 without any."""
        return max(map(abs, self.joint_velocities.values()), default=0.0)


@dataclass(frozen=True, kw_only=True)
class Moment:
    """How the robots are that can move."""

    seconds: float  # simulated, since the beginning
    states: tuple[RobotState, ...]


@dataclass(frozen=True, kw_only=True)
class Opened:
    """What the engine made of a scene, and how all robots are, also the static ones."""

    loaded: Mapping[str, Loaded]  # by entity
    spawn_poses: Mapping[str, Pose]  # of the root links' frames
    refused: Mapping[str, Refused]
    step_seconds: float
    states: tuple[RobotState, ...]


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What was measured while time passed, and how the robots are then."""

    robot_runs: tuple[RobotRun, ...]
    moment: Moment

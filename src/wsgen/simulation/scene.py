"""What is simulated, and what was measured. SI units; poses are seen from the world frame."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.engine import HullGap

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.robot import Robot
    from wsgen.model.world import World


# What the child process announces; by it the parent knows what the engine died of.
LOADING = "loading the robot `{entity}`"
TRYING = "trying the behavior `{name}` of `{entity}`"
DRAWING = "drawing the picture"
RECORDING = "drawing the video"  # goes on with how far it is


@dataclass(frozen=True, kw_only=True)
class SpawnedRobot:
    """A robot to be put into the world."""

    entity: str  # its name in the simulator; unique in a scene
    robot: Robot  # as Gazebo has it: lumped
    pose_in_world: Pose = IDENTITY  # of the root link's frame
    on_the_ground: bool = False  # spawned at that pose, but as low as it can stand
    is_static_model: bool = False  # a part of the world: pictures are not about it


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A world with robots in it, for some seconds."""

    world: World
    robots: tuple[SpawnedRobot, ...]
    seconds: float = 3.0  # simulated
    behavior_runs: tuple[
        BehaviorRun, ...
    ] = ()  # afterwards, one by one, from where all were spawned
    engine: str = "bullet"  # a key of `run.MODULES`
    picture: Path | None = None  # where to put a PNG of the end; its folder must exist
    world_picture: Path | None = None  # likewise of all around, if there is scenery
    record: Path | None = None  # where to put a video of the simulation, .gif or .mp4; likewise
    progress: Path | None = None  # where to write, now and then, how far the video is


@dataclass(frozen=True, kw_only=True)
class Overlapping:
    """A link of the robot that is in another link."""

    link: str
    other_entity: str | None  # None: of the same robot
    other_link: str
    depth: float  # m


class Behaved(NamedTuple):
    """What was measured of a behavior, at its end."""

    name: str
    # m, m, rad: the root link's frame, along x and y of where it was when it began, and how far it
    # has turned, whole turns included
    moved: tuple[float, float, float]
    positions: Mapping[str, float]  # rad or m, of the movable joints
    is_finite: bool = True  # if not, the rest is what was measured before


@dataclass(frozen=True, kw_only=True)
class RobotRun:
    """What was measured of one robot. It states facts; `wsgen.checks` checks them."""

    entity: str
    links: int  # that the engine simulates
    movable_joints: int
    mass: float  # kg, as the engine has it
    spawn_pose: Pose  # of the root link's frame
    overlaps: tuple[Overlapping, ...]  # when spawned; links that a joint joins are left out
    lowest_point: float  # m, z of what can touch, when spawned
    penetration: float  # m, how deep that is in the ground; 0 without a ground plane
    lowest_point_at_end: float  # m
    is_finite: bool  # no pose or speed was infinite or not-a-number
    settled_after: float | None  # s; from then on it was at rest; None: it still moved at the end
    rest_pose: Pose  # of the root link's frame (not the center of mass), at the end
    speed: float  # m/s, of the root link's center of mass, at the end
    turning: float  # rad/s, of the root link, at the end
    joint_speed: float  # rad/s or m/s, of the fastest joint, at the end
    highest_speed: float  # m/s, of the root link's center of mass
    highest_point: float  # m, z of the root link's frame
    tilt: float  # rad, between what was up in the robot when spawned and up, at the end
    energy_gain: float  # J, the most that it had above what it had when spawned
    joint_positions: Mapping[str, float]  # rad or m, of the movable joints at the end
    joint_travel: Mapping[str, float]  # rad or m, the farthest that each was from its start
    climb: float = 0.0  # m/s, upwards, of the root link's frame, over the last looks
    is_cut_short: bool = False  # it ended before its time: another robot's state was not finite
    is_falling: bool = False  # nothing holds it up: at the end it gets faster with gravity
    hull_gaps: tuple[HullGap, ...] = ()  # at the end
    behaviors: tuple[Behaved, ...] = ()  # that were tried


@dataclass(frozen=True, kw_only=True)
class Video:
    """A video of a simulation: of its behaviors, or of the robot from spawning to the end."""

    file: Path
    frames: int
    frames_per_second: float  # of simulated time, which is also the video's
    width: int  # pixels
    height: int
    triangles: int  # that a frame shows
    is_coarse: bool = False  # smaller or with fewer frames than is usual, to be done in time


@dataclass(frozen=True, kw_only=True)
class SimulationOutcome:
    """How a scene went. Without simulations it could not be played, and the diagnostics say why."""

    robot_runs: tuple[RobotRun, ...] = ()  # of the robots that the engine accepted
    diagnostics: tuple[Diagnostic, ...] = ()
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of the ground's squares in it, if any are seen
    world_picture: Path | None = None
    video: Video | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)  # wall-clock: load, simulate, draw


def robot_run_to_json(robot_run: RobotRun) -> dict[str, Any]:
    """The simulation as JSON has it; `robot_run_from_json` is the way back."""
    return asdict(robot_run)


def robot_run_from_json(value: Mapping[str, Any]) -> RobotRun:
    """The simulation that `robot_run_to_json` made this of."""
    poses = {
        key: Pose(tuple(value[key]["xyz"]), tuple(value[key]["rpy"]))
        for key in ("spawn_pose", "rest_pose")
    }
    overlaps = tuple(Overlapping(**overlap) for overlap in value["overlaps"])
    gaps = tuple(HullGap(*gap) for gap in value["hull_gaps"])
    behaved = tuple(
        Behaved(name, tuple(moved), positions, is_finite)
        for name, moved, positions, is_finite in value["behaviors"]
    )
    return RobotRun(
        **{**value, **poses, "overlaps": overlaps, "hull_gaps": gaps, "behaviors": behaved}
    )

"""What is simulated, and what was measured. SI units; poses are seen from the world frame."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  the type hints of answers are read
from dataclasses import field
from pathlib import Path  # noqa: TC003
from typing import TYPE_CHECKING

from wsgen.model.behavior import BehaviorRun, DiffDrive, TimeSeries  # noqa: TC001  live runs decode a scene
from wsgen.model.outcome import SceneView  # noqa: TC001
from wsgen.model.robot import Robot  # noqa: TC001
from wsgen.model.transform import IDENTITY, Pose, Vector
from wsgen.model.world import World  # noqa: TC001
from wsgen.simulation.engine import HullGap, Refused  # noqa: TC001
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic


# What the child process announces; by it the parent knows what the engine died of.
LOADING = "loading the robot `{entity}`"
RUNNING = "running the behavior `{name}` of `{entity}`"
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
    is_of_world: bool = False  # in the file of the world: pictures are about what is spawned there
    drive: DiffDrive | None = None  # its plugin keeps the wheels still while nobody drives them


@dataclass(frozen=True, kw_only=True)
class Push:
    """A force that acts on a robot for a while, at the center of mass of a link."""

    entity: str
    link: str
    force: Vector  # N, in the world
    begin: float  # s, simulated, since the robots were spawned
    seconds: float  # how long it acts


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A world with robots in it, for some seconds."""

    world: World
    robots: tuple[SpawnedRobot, ...]
    seconds: float = 3.0  # simulated
    # Afterwards, one by one, from where all were spawned.
    behavior_runs: tuple[BehaviorRun, ...] = ()
    pushes: tuple[Push, ...] = ()  # while the robots stand; several on one link add up
    engine: str = "bullet"  # a key of `ENGINES`
    samples: int = 0  # of each robot over the simulated time, and of each of its behaviors
    picture: Path | None = None  # where to put a PNG of the end; its folder must exist
    world_picture: Path | None = None  # likewise of all around, if there are static models
    record: Path | None = None  # where to put a video of the simulation, .gif or .mp4; likewise
    view_triangles: int = 0  # of a view of the end, at most; 0: no view is wanted
    progress: Path | None = None  # where to write, now and then, how far the video is


@dataclass(frozen=True, kw_only=True)
class Overlapping:
    """A link of the robot that is in another link."""

    link: str
    other_entity: str | None  # None: of the same robot
    other_link: str
    depth: float  # m


@dataclass(frozen=True)
class BehaviorMeasurement:
    """What was measured of a behavior at its end."""

    name: str
    # m, m, rad: the root link's frame, along x and y of where it was when it began, and how far it
    # has turned, whole turns included
    moved: tuple[float, float, float]
    positions: Mapping[str, float]  # rad or m, of the movable joints
    is_finite: bool = True  # if not, the rest is what was measured before


@dataclass(frozen=True, kw_only=True)
class RobotRun:
    """What was measured of one robot. It states facts; `wsgen.checks.rules` checks them."""

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
    highest_joint_speed: float = 0.0  # rad/s or m/s, of whatever joint was the fastest at a look
    seconds: float = 0.0  # simulated, until the end
    tilt: float  # rad, between what was up in the robot when spawned and up, at the end
    energy_gain: float  # J, the most that it had above what it had when spawned
    joint_positions: Mapping[str, float]  # rad or m, of the movable joints at the end
    joint_travel: Mapping[str, float]  # rad or m, the farthest that each was from its start
    climb: float = 0.0  # m/s, upwards, of the root link's frame, over the last looks
    is_cut_short: bool = False  # it ended before its time: another robot's state was not finite
    is_falling: bool = False  # nothing holds it up: at the end it gets faster with gravity
    hull_gaps: tuple[HullGap, ...] = ()  # at the end
    behaviors: tuple[BehaviorMeasurement, ...] = ()  # that were run
    # While it stood, then during each behavior; none where the scene wants no samples.
    time_series: tuple[TimeSeries, ...] = ()


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
class Picture:
    """A picture that was drawn."""

    tile: float | None  # m, edge of the ground's squares in it, if any are seen


@dataclass(frozen=True, kw_only=True)
class NotDrawn:
    """A picture or a video that was asked for and could not be made."""

    problem: str  # goes on after "Cannot draw it:"


@dataclass(frozen=True, kw_only=True)
class SceneResult:
    """What the child process of a simulation answers."""

    robot_runs: tuple[RobotRun, ...]  # of the robots that the engine accepted
    refused: Mapping[str, Refused]  # the others, by entity
    # None where it was not asked for, or there is nothing that it could show.
    picture: Picture | NotDrawn | None = None
    world_picture: Picture | NotDrawn | None = None
    video: Video | NotDrawn | None = None
    view: SceneView | None = None
    seconds: Mapping[str, float]  # wall-clock: simulate, draw


@dataclass(frozen=True, kw_only=True)
class SimulationOutcome:
    """How a scene went. Without robot runs, the diagnostics say why it could not be simulated."""

    robot_runs: tuple[RobotRun, ...] = ()  # of the robots that the engine accepted
    diagnostics: tuple[Diagnostic, ...] = ()
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of the ground's squares in it, if any are seen
    world_picture: Path | None = None
    video: Video | None = None
    view: SceneView | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)  # wall-clock: load, simulate, draw

"""What a robot must do beyond standing, its differential drive, and the result. SI units.

"Ahead" is the x axis of the root link as the robot stands when a behavior begins; headings are
those of this axis on the ground. A differential drive is that of Gazebo's plugins.
"""

from __future__ import annotations

import math
from collections.abc import Mapping  # noqa: TC003  the file of a live run is decoded by type hints
from dataclasses import field

from wsgen.model.world import Spawn  # noqa: TC001  as above
from wsgen.text.values import dataclass

ELEMENT = "behavior `{}`"  # of a diagnostic; with its name
LEAST_TOLERANCE = 0.02  # m or rad; no engine is more exact


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Drive the robot as a Twist on /cmd_vel says, and see where it gets."""

    linear: float = 0.0  # m/s, ahead
    angular: float = 0.0  # rad/s, about z
    # Where it should be at the end, seen from where it began; None is not checked.
    x: float | None = None  # m, ahead
    y: float | None = None  # m, to the left
    yaw: float | None = None  # rad, whole turns included
    tolerance: float = 0.1  # share of the way

    def slack(self, *way: float | None) -> float:
        """By how much a way with these parts (m or rad) may be missed."""
        length = math.hypot(*(part or 0.0 for part in way))
        return max(LEAST_TOLERANCE, self.tolerance * length)

    @property
    def expected(self) -> Mapping[str, float | None]:
        """What is checked, by name; None is not."""
        return {"x": self.x, "y": self.y, "yaw": self.yaw}


@dataclass(frozen=True, kw_only=True)
class Reach:
    """Give joints positions to go to and to hold."""

    positions: Mapping[str, float]  # rad or m, by joint
    within: float = 0.05  # rad or m from these at the end

    @property
    def expected(self) -> Mapping[str, float | None]:
        """What is checked, by name."""
        return dict(self.positions)


@dataclass(frozen=True, kw_only=True)
class LaunchTask:
    """Run the launch file, whose nodes move the robot, and see where it gets."""

    # Where it should be at the end, seen from where it was spawned; None is not checked.
    x: float | None = None  # m, ahead
    y: float | None = None  # m, to the left
    yaw: float | None = None  # rad, whole turns included
    tolerance: float = 0.1  # share of the way
    travels: float | None = None  # m, the least length of its way; None is not checked
    positions: Mapping[str, float] = field(default_factory=dict)  # rad or m, at the end, by joint
    within: float = 0.05  # rad or m from these

    @property
    def as_drive(self) -> Drive:
        """Where it should be, as a drive has it."""
        return Drive(x=self.x, y=self.y, yaw=self.yaw, tolerance=self.tolerance)

    @property
    def as_reach(self) -> Reach:
        """Where its joints should be, as a task for them has it."""
        return Reach(positions=self.positions, within=self.within)

    @property
    def expected(self) -> Mapping[str, float | None]:
        """What is checked, by name; None is not."""
        place = {"x": self.x, "y": self.y, "yaw": self.yaw, "traveled": self.travels}
        return {**place, **self.positions}


Task = Drive | Reach | LaunchTask


@dataclass(frozen=True, kw_only=True)
class Behavior:
    """One `[[behavior]]` of a package's `wsgen.toml`."""

    name: str
    task: Task
    seconds: float
    robot: str | None = None  # entity; None: the only one there is
    line: int | None = None  # in wsgen.toml, 1-based

    @property
    def runs_launch_file(self) -> bool:
        """Whether it has `run = true`."""
        return isinstance(self.task, LaunchTask)


@dataclass(frozen=True, kw_only=True)
class BehaviorRun:
    """A behavior that can be simulated, with its robot."""

    entity: str  # empty: the first robot that comes into the world while the launch file runs
    behavior: Behavior
    drive: DiffDrive | None = None  # of the robot, for a task that drives it


@dataclass(frozen=True, kw_only=True)
class BehaviorOutcome:
    """The result of a behavior."""

    name: str
    task: Task
    passed: bool
    is_left_out: bool = False  # its launch file was not run, which is no failure
    # What was measured at the end; None where it was not simulated or the task is another one.
    moved: tuple[float, float, float] | None = None  # m, m, rad: x, y, yaw
    positions: Mapping[str, float] | None = None  # rad or m, of the joints that the task names
    traveled: float | None = None  # m, the length of its way
    seconds: float | None = None  # simulated, for which it ran; None: it was not simulated
    wall_seconds: float = 0.0  # of the clock, that its launch file ran for
    printed: tuple[str, ...] = ()  # the last lines of its nodes, where it failed


@dataclass(frozen=True, kw_only=True)
class LiveMeasurement:
    """How a robot did while its launch file ran."""

    name: str  # of the behavior
    launched: str = "PACKAGE FILE"  # the words for `wsgen launch`, for a shell
    entity: str = ""  # the robot that was looked at; empty: none has come
    spawned: tuple[Spawn, ...] = ()  # what nodes have spawned that the launch file does not name
    seconds: float = 0.0  # simulated, for which it ran
    is_there: bool = False  # the robot is in the world at the end
    is_finite: bool = True  # all states of the robot were
    moved: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m, m, rad, from where it was spawned
    traveled: float = 0.0  # m, the length of its way
    tilt: float = 0.0  # rad, between what was up in the robot when spawned and up
    positions: Mapping[str, float] = field(default_factory=dict)  # rad or m, by joint
    # Why it did not run to the end: a process has failed.
    problem: str | None = None
    left_out: Mapping[str, str] = field(default_factory=dict)  # what did not run, with the reason
    wall_seconds: float = 0.0  # of the clock
    printed: tuple[str, ...] = ()  # the last lines, "[PROCESS] LINE"; of one that failed, its own
    # Its way; seconds are negative before the nodes had joined. None: not wanted, or not spawned.
    time_series: TimeSeries | None = None


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """How fast a speed may be and change; m/s and m/s², or rad/s and rad/s²."""

    slowest: float = -math.inf
    fastest: float = math.inf
    braking: float = -math.inf  # the lowest acceleration
    acceleration: float = math.inf
    least_jerk: float = -math.inf  # of the acceleration; m/s³ or rad/s³
    jerk: float = math.inf

    def next(
        self, speed: float, wanted: float, seconds: float, before: float | None = None
    ) -> float:
        """The speed after so many seconds of going from one to the wanted one.

        As `gz::math::SpeedLimiter` has it; without the speed before, jerk has no limits.
        """
        if seconds <= 0:
            return _clamp(wanted, self.slowest, self.fastest)
        new = (wanted - speed) / seconds
        if before is not None:
            old = (speed - before) / seconds
            new = old + _clamp((new - old) / seconds, self.least_jerk, self.jerk) * seconds
        new = _clamp(new, self.braking, self.acceleration)
        return _clamp(speed + new * seconds, self.slowest, self.fastest)


def _clamp(value: float, low: float, high: float) -> float:
    return min(high, max(low, value))


@dataclass(frozen=True, kw_only=True)
class WheelPair:
    """Two wheels on one axle."""

    left: str  # joint
    right: str  # joint
    separation: float  # m, between the wheels
    radius: float  # m

    def speeds(self, linear: float, angular: float) -> tuple[float, float]:
        """How fast the rims of the left and the right wheel are for these (m/s), in m/s."""
        half = angular * self.separation / 2
        return linear - half, linear + half


@dataclass(frozen=True, kw_only=True)
class DiffDrive:
    """The configuration of a diff drive plugin."""

    simulator: str  # that has the plugin: "classic" or "gz"
    pairs: tuple[WheelPair, ...]
    grip: float = 1.0  # friction coefficient of the wheels; where they differ, the least
    torque: float | None = None  # N m, of each wheel; None: what the limits of the joints say
    linear: Bounds = field(default_factory=Bounds)
    angular: Bounds = field(default_factory=Bounds)
    rim: Bounds = field(default_factory=Bounds)  # of each wheel's rim


@dataclass(frozen=True, kw_only=True)
class TimeSeries:
    """Samples of one robot while it stood, or during one behavior; all of them equally long."""

    behavior: str | None = None  # its name; None: from spawning to the end of the simulation
    seconds: tuple[float, ...]  # simulated, since it was spawned or began the behavior
    positions: tuple[tuple[float, float, float], ...]  # m, of the root link's frame
    speeds: tuple[float, ...]  # m/s, of the root link's center of mass
    tilts: tuple[float, ...]  # rad, between what was up in the robot when spawned and up
    joint_positions: Mapping[str, tuple[float, ...]]  # rad or m, of the movable joints by name
    heading: float = 0.0  # rad, of the root link's x axis on the ground, at the first sample

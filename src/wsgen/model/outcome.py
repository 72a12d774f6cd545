"""The results of `wsgen validate`, ready for a report. SI units; poses in the world frame.

Diagnostics of one cause, which differ only in what they name, become one (`summed_up`).
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import has_errors
from wsgen.model.engines import RESULT_NAMES
from wsgen.text.suggestions import some_of
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorOutcome, TimeSeries
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Pose
    from wsgen.model.world import World


@dataclass(frozen=True, kw_only=True)
class Rest:
    """How the robot was at the end of the simulation."""

    pose_in_world: Pose  # of the root link's frame
    settled_after: float | None  # s; None: it still moved at the end
    speed: float  # m/s, at the end
    tilt: float = 0.0  # rad, between what was up in the robot when spawned and up, at the end
    joint_positions: Mapping[str, float] = field(default_factory=dict)  # rad or m, at the end


@dataclass(frozen=True, kw_only=True)
class Simulated:
    """What the engine says it simulates."""

    engine: str  # a key of `RESULT_NAMES`
    links: int
    movable_joints: int
    mass: float  # kg


@dataclass(frozen=True, kw_only=True)
class EngineOutcome:
    """How a robot did in one engine."""

    engine: str  # a key of `RESULT_NAMES`
    version: str = ""  # of the user's own Gazebo
    simulated: Simulated | None = None  # None: it was not simulated
    rest: Rest | None = None
    behaviors: tuple[BehaviorOutcome, ...] = ()  # what it must do beyond standing
    passed: bool = False  # no error is reported about the robot in this engine
    is_untried: bool = False  # only behaviors that cannot be simulated keep it from passing
    codes: frozenset[str] = frozenset()  # of the rules that are reported about it in this engine
    time_series: tuple[TimeSeries, ...] = ()  # standing, then its behaviors; if they are wanted

    @property
    def name(self) -> str:
        """The engine's, for people."""
        return f"{RESULT_NAMES[self.engine]} {self.version}".rstrip()


@dataclass(frozen=True, kw_only=True)
class RobotOutcome:
    """One spawned robot; the counts are those of the description as written."""

    entity: str
    spawn_pose: Pose
    links: int
    joints: int
    movable_joints: int
    mass: float  # kg
    engines: tuple[EngineOutcome, ...] = ()  # all in which it was to be simulated
    behaviors: tuple[BehaviorOutcome, ...] = ()  # of the first engine; passed if in every engine
    passed: bool = False  # no error is reported about this robot
    description: Robot | None = None  # as written

    @property
    def simulated(self) -> Simulated | None:
        """What the first engine simulated; None if it did not."""
        return self.engines[0].simulated if self.engines else None

    @property
    def rest(self) -> Rest | None:
        """How the robot was at the end, in the first engine."""
        return self.engines[0].rest if self.engines else None


@dataclass(frozen=True, kw_only=True)
class PackageOutcome:
    """One validated package, or a file that was validated without one."""

    package: str | None
    file: Path | None = None  # of the robot or world, where there is no package
    share: Path | None
    launch_file: Path | None
    world: World | None = None
    robots: tuple[RobotOutcome, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: Path | None = None  # of all that is in the world, where that is more
    video: Path | None = None
    plan: LaunchPlan | None = None  # of the launch file
    view: SceneView | None = None  # for a page, if one is wanted
    seconds: Mapping[str, float] = field(default_factory=dict)  # wall-clock, by stage

    @property
    def passed(self) -> bool:
        """Whether there is a robot and no error; a world file may have no robot."""
        is_world = self.file is not None and self.world is not None and self.world.file is not None
        return (bool(self.robots) or is_world) and not has_errors(self.diagnostics)


@dataclass(frozen=True, kw_only=True)
class NotValidated:
    """A package that spawns no robot, or a launch file that is not simulated, and why."""

    package: str
    launch_file: Path | None = None  # None: the package has none that spawns a robot
    reason: str
    robot_files: tuple[Path, ...] = ()  # of the package, that can be validated by themselves


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The whole run."""

    packages: tuple[PackageOutcome, ...]
    not_validated: tuple[NotValidated, ...] = ()
    is_complete: bool = True  # False: the run was stopped, and `packages` are those that ended

    @property
    def passed(self) -> bool:
        """Whether every package was validated and passed."""
        return self.is_complete and all(package.passed for package in self.packages)


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


MANY = 3  # so many are one
NAMED = 3  # of the others in the message
# What is quoted, addresses, paths.
NAMES = lazy_pattern(r"`[^`]*`|\b\w+://[^\s`']+|(?<!\w)'[^']*'(?!\w)|(?<=[\s(])/[^\s)]+")
NAMED_IN = lazy_pattern(r"@name='([^']*)'")
QUOTES = "`'"
NUMBERS = lazy_pattern(r"\d+(\.\d+)?(e[+-]?\d+)?")


class _Cause(NamedTuple):
    """What diagnostics of one cause have in common."""

    code: str
    severity: str
    file: str
    message: str
    hint: str


def summed_up(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The diagnostics, of several that differ only in names and numbers the first, with the names.

    They have one rule, severity and file, and the same hint except for what the message names.
    What is reported twice in the same words stays once.
    """
    different = dict.fromkeys(diagnostics)
    groups: dict[_Cause, list[Diagnostic]] = {}
    for found in different:
        groups.setdefault(_cause_of(found), []).append(found)
    reported: dict[Diagnostic, Diagnostic | None] = {}  # None: a part of another one
    for group in groups.values():
        # In one line several are made: of a macro that is called more than once.
        is_one_line = group[0].line is not None and len({one.line for one in group}) == 1
        if len(group) >= (2 if is_one_line else MANY):
            reported |= {**dict.fromkeys(group), group[0]: _with_names(group)}
    kept = (reported.get(found, found) for found in different)
    return tuple(found for found in kept if found is not None)


def _cause_of(found: Diagnostic) -> _Cause:
    hint = found.hint or ""
    for name in _names(found.message):
        hint = hint.replace(name.strip(QUOTES), "…")
    message = NUMBERS.sub("0", NAMES.sub("…", found.message))
    return _Cause(found.code, found.severity.value, str(found.file), message, hint)


def _names(message: str) -> list[str]:
    return [match.group() for match in NAMES.finditer(message)]


def _with_names(group: Sequence[Diagnostic]) -> Diagnostic:
    """The first, with what distinguishes the others from it."""
    labels: dict[str, str] = {}
    for name, found in zip(_distinguishing(group), group, strict=True):
        line = f"line {found.line}" if found.line and found.line != group[0].line else ""
        labels.setdefault(name or line, f"{name} ({line})" if name and line else name or line)
    others = list(labels.values())[1:]
    if not others:
        return group[0]
    same = f"The same holds for {some_of(others, NAMED)}."
    return replace(group[0], message=f"{group[0].message} {same}")


def _distinguishing(group: Sequence[Diagnostic]) -> Sequence[str]:
    """The first name in the message or the element that distinguishes them; or the element."""
    of_each = ((*_names(found.message), *NAMED_IN.findall(found.element or "")) for found in group)
    columns = zip(*of_each)  # noqa: B905  elements may be nested differently
    important = next((column for column in columns if len(set(column)) > 1), None)
    if important is not None:
        return [f"`{name.strip(QUOTES)}`" for name in important]
    is_element = len({found.element for found in group}) > 1
    return [f"`{found.element}`" if is_element else "" for found in group]

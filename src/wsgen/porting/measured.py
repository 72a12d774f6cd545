"""The robots that launch files spawn, as they are simulated: what a proof compares.

Nothing is built: install spaces are laid out with links to the sources.
"""

from __future__ import annotations

import math
from cmath import phase
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.node_topics import STAMPED, TWIST
from wsgen.descriptions.sdf.worlds import default_world
from wsgen.diagnostics import has_errors
from wsgen.errors import RequestError, WsgenError
from wsgen.isolation.parent import make_part, make_scratch
from wsgen.launching.simulators import kind_of_project
from wsgen.model.behavior import Behavior, BehaviorRun, Drive, LaunchTask
from wsgen.model.target import CLASSIC, SIM
from wsgen.packages.workspace.settings import Settings
from wsgen.pipeline.behavior_plan import plan_behaviors
from wsgen.pipeline.candidates import simulation_of
from wsgen.pipeline.check_package import PackageCheck
from wsgen.pipeline.installed_as_built import lay_out
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.parallel import start_children
from wsgen.pipeline.requests import SelectedLaunchFile, SelectedPackage, ValidateRequest
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.porting.robot_topics import RosTopic, topics_of_robot
from wsgen.text.files import remembering
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.isolation.parent import Run
    from wsgen.model.behavior import TimeSeries
    from wsgen.model.outcome import RobotOutcome
    from wsgen.model.transform import Pose
    from wsgen.model.world import World
    from wsgen.pipeline.candidates import Candidate
    from wsgen.pipeline.check import Targets
    from wsgen.pipeline.clock import Clock
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import RunLive


Way = tuple[float, float, float]  # m, m, rad
# What stays the same: the share of a way; a shorter one than this, in m or rad, counts as long.
SHARE, LEAST_WAY = 0.05, 0.2
# What drives show: in m/s and rad/s, each for so many seconds.
DRIVES = {"drive ahead": Drive(linear=0.3), "turn": Drive(angular=0.5)}
SECONDS = 3.0
# How other drives are tried: the launch file runs, with the same command all the time. What a robot
# does before it has come to its speed depends on when the command comes.
LIVE, _SECONDS_LIVE, _STEADY_AFTER = "drive live", 6.0, 2.0
NODES = "driven by its nodes"  # likewise, without that command
# A program that a build makes of an entry point of setup.py.
_PROGRAM = """\
#!/usr/bin/env python3
import sys
sys.path.insert(0, {folder!r})
from {module} import {function}
sys.exit({function}())
"""
_STEP = 5  # samples, over which it is seen where it goes
_STANDS = 0.02  # m
_COMMAND = "{linear: {x: 0.3}, angular: {z: 0.3}}"
_COMMANDS = {TWIST: _COMMAND, STAMPED: f"{{twist: {_COMMAND}}}"}
_LAUNCH = """\
from launch import LaunchDescription
from launch.actions import ExecuteProcess, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource


def generate_launch_description():
    return LaunchDescription([
        IncludeLaunchDescription(AnyLaunchDescriptionSource({file!r})),
        *(ExecuteProcess(cmd=['ros2', 'topic', 'pub', '-r', '20', *words]) for words in {words!r}),
    ])
"""
# Of how many launch files a robot is simulated: many packages have one for each of their worlds.
MOST_WORLDS = 3
_REQUEST = ValidateRequest(is_live=True, seconds=SECONDS)
_PLUGIN = "libgazebo_ros"  # how the file names of Classic's begin


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A robot that a launch file spawns, as it is simulated."""

    package: str
    launch_file: str  # its file name
    entity: str
    links: frozenset[str]
    joints: frozenset[str]
    mass: float  # kg
    topics: frozenset[RosTopic]
    rest: Pose | None = None  # in the world, of the root link; None: it was not simulated
    # Where it got, seen from where it began: m, m, rad, by what it did.
    ways: Mapping[str, Way]
    problem: str = ""  # why it was not simulated
    problem_live: str = ""  # why it was not driven with its launch file
    # Whether its nodes did the same twice; None: it was tried once.
    is_repeated: bool | None = None
    is_left_out: bool = False  # it was simulated for other launch files


class Side(NamedTuple):
    """The robots before or after a port."""

    robots: tuple[Measured, ...]
    problems: Mapping[str, str]  # by names of launch files: what is wrong with them


class Spawners(NamedTuple):
    """What launch files spawn, without a look at it."""

    of_classic: int  # of those for Gazebo Classic, how many plugins their robots have; 0: no robot
    are_any: bool  # for any simulator
    problems: Mapping[str, str]  # as above


class _Evaluated(NamedTuple):
    """The launch files of packages that spawn something, each simulation once."""

    launches: list[tuple[PackageCheck, Candidate]]
    problems: dict[str, str]
    run: Run
    folder: Path  # for files that engines read


@contextmanager
def _evaluated(
    targets: Targets, environment: Mapping[str, str], distro: str | None
) -> Iterator[_Evaluated]:
    # Each side is for its own distribution, whatever is sourced.
    variables = {name: value for name, value in environment.items() if name != "ROS_DISTRO"}
    with (
        remembering(),
        make_scratch(in_memory=True) as scratch,
        make_scratch() as folder,
        start_children() as run,
    ):
        found = _Evaluated([], {}, run, folder)
        installed = lay_out(targets, scratch, variables)
        for package in targets.packages:
            check = PackageCheck(package, installed, distro, None, run, folder)
            known = set()
            for candidate in () if package.diagnostics else check.evaluate():
                started = candidate.started
                wrong = [one for one in started.plan.diagnostics if has_errors((one,))]
                if wrong:
                    found.problems[candidate.file.name] = installed.text(wrong[0].message)
                # Two with the same robots and world may have other bridges.
                same = simulation_of(candidate), tuple(map(str, started.plan.processes))
                if started.is_evaluated and started.has_spawner and same not in known:
                    known.add(same)
                    found.launches.append((check, candidate))
        yield found


def find_spawners(targets: Targets, environment: Mapping[str, str]) -> Spawners:
    """What the launch files of packages spawn."""
    with _evaluated(targets, environment, None) as found:
        plugins = 0
        for _, candidate in found.launches:
            started = candidate.started
            simulator = started.simulator
            kind = simulator.kind if simulator else kind_of_project(started.plan)
            if kind == CLASSIC:
                plugins += 1 + sum(one.description.count(_PLUGIN) for one in started.spawns)
        return Spawners(plugins, bool(found.launches), found.problems)


def measure(  # noqa: PLR0913  two have defaults
    targets: Targets,
    environment: Mapping[str, str],
    distro: str | None,
    clock: Clock,
    run_live: RunLive | None = None,
    *,
    repeats: bool = False,
) -> Side:
    """Simulate the robots that the launch files of packages spawn.

    Args:
        targets: The packages.
        environment: That of the command.
        distro: What they are for; None: what they say.
        clock: Posts each simulation.
        run_live: Runs a launch file; without it, robots with other drives than a differential one
            are not driven.
        repeats: Whether to run nodes that drive a robot twice.
    """
    robots: list[Measured] = []
    simulated: dict[tuple[str, str], list[tuple[PreparedRobot, str | None, Measured]]] = {}
    with _evaluated(targets, environment, distro) as found:
        for check, candidate in found.launches:
            spawns = candidate.started.spawns
            known = [simulated.get((one.entity, one.description), []) for one in spawns]
            if known and all(len(one) >= MOST_WORLDS for one in known):
                robots += (_left_out(candidate, *one[0]) for one in known)
                continue
            name = candidate.file.name
            with make_part(found.folder) as folder, clock.step("simulate", name) as step:
                launch = _Launch(check, candidate, folder, found.run)
                live = _Live(launch, run_live, is_new=not any(known), repeats=repeats)
                measured = [*launch.robots(live)]
                if not measured and launch.errors:
                    problem = check.installed.text(launch.errors[0])
                    found.problems.setdefault(name, problem)
                step.succeeded = not launch.errors
                for prepared, one in measured:
                    robots.append(one)
                    for spawn in spawns:
                        if spawn.entity == prepared.entity:
                            key = spawn.entity, spawn.description
                            simulated.setdefault(key, []).append((prepared, launch.kind, one))
        return Side(tuple(robots), found.problems)


def _left_out(
    candidate: Candidate, prepared: PreparedRobot, kind: str | None, like: Measured
) -> Measured:
    """A robot that is simulated for other launch files already."""
    return replace(
        like,
        launch_file=candidate.file.name,
        topics=topics_of_robot(prepared, candidate.started, kind, None),
        rest=None,
        ways={},
        problem="",
        is_left_out=True,
    )


class _Launch:
    """A launch file, with what it puts into its world."""

    def __init__(self, check: PackageCheck, candidate: Candidate, folder: Path, run: Run) -> None:
        self.check = check
        self.candidate = candidate
        self.run = run
        self.folder = folder
        selected = SelectedPackage(
            name=check.package.name,
            source=check.package.path,
            share=check.overlay.share(check.package.name),
            launch_file=candidate.file,
            started=candidate.started,
        )
        self.validation = Validation(selected, check.overlay, _REQUEST, None, run)
        self.world, self.scene = self.validation.read(folder)
        self.kind = self.validation.simulator_kind
        self.errors = [one.message for one in self.validation.diagnostics if has_errors((one,))]

    def robots(self, live: _Live) -> Iterator[tuple[PreparedRobot, Measured]]:
        """Simulate, and measure."""
        outcomes = {} if self.world is None else self._simulate(self.world)
        name = None if self.validation.world_file is None or not self.world else self.world.name
        for one in self.scene:
            if one.is_static_model or one.may_move:
                continue
            outcome = outcomes.get(one.entity)
            rest = None if outcome is None or outcome.rest is None else outcome.rest.pose_in_world
            behaviors = () if outcome is None else outcome.behaviors
            moved = {behavior.name: behavior.moved for behavior in behaviors}
            topics = topics_of_robot(one, self.candidate.started, self.kind, name)
            ways = {
                drive: way
                for drive in DRIVES
                if (way := moved.get(_behavior_name(drive, one.entity))) is not None
            }
            driven = _Driven() if rest is None else live.drive(one, topics)
            yield (
                one,
                Measured(
                    package=self.check.package.name,
                    launch_file=self.candidate.file.name,
                    entity=one.entity,
                    links=frozenset(link.name for link in one.written.links),
                    joints=frozenset(joint.name for joint in one.written.joints),
                    mass=sum(link.inertial.mass for link in one.written.links if link.inertial),
                    topics=topics,
                    rest=rest,
                    ways={**ways, **driven.ways},
                    problem=self.check.installed.text(self.errors[0]) if self.errors else "",
                    problem_live=driven.problem,
                    is_repeated=driven.is_repeated,
                ),
            )

    def _simulate(self, world: World) -> dict[str, RobotOutcome]:
        driven = [one.entity for one in self.scene if one.drive is not None]
        behaviors = tuple(
            Behavior(name=_behavior_name(drive, entity), task=task, seconds=SECONDS, robot=entity)
            for entity in driven
            for drive, task in DRIVES.items()
        )
        if self.candidate.started.simulator is None:
            world = default_world(CLASSIC)  # another launch file starts it: the same one for both
        settings = Settings(file=self.check.package.path / "package.xml", behaviors=behaviors)
        simulated = simulate_robots(
            # With the physics of one simulator: what they do differently is not of the port.
            replace(world, simulator=SIM),
            self.scene,
            _REQUEST,
            self.check.package.name,
            run=self.run,
            behavior_plan=plan_behaviors(settings, self.scene, simulator=self.kind),
        )
        found = simulated.diagnostics_after(self.validation.diagnostics)
        self.errors = [one.message for one in found if has_errors((one,))]
        return {one.entity: one for one in simulated.robots}


class _Driven(NamedTuple):
    """What a robot did while its launch file ran."""

    ways: Mapping[str, Way] = MappingProxyType({})
    problem: str = ""
    is_repeated: bool | None = None


class _Live:
    """Runs a launch file for the robots in its world."""

    def __init__(
        self, launch: _Launch, run_live: RunLive | None, *, is_new: bool, repeats: bool
    ) -> None:
        self._launch = launch
        self._run_live = run_live
        self._is_new = is_new
        self._repeats = repeats

    def drive(self, robot: PreparedRobot, topics: Iterable[RosTopic]) -> _Driven:
        """Drive a robot that has a drive of another kind, and look where own nodes drive one."""
        started = self._launch.candidate.started
        words = [
            (one.name, one.type, _COMMANDS[one.type])
            for one in sorted(topics)
            if one.type in _COMMANDS and not one.is_published
        ]
        if self._run_live is None or not words or started.simulator is None:
            return _Driven()
        ways: dict[str, Way] = {}
        is_repeated = None
        try:
            if self._is_new and robot.drive is None:
                ways[LIVE] = self._run(self._run_live, robot.entity, words)
            if self._make_programs():
                way = self._run(self._run_live, robot.entity, ())
                ways |= {NODES: way} if any(way) else {}
                if any(way) and self._repeats:
                    again = self._run(self._run_live, robot.entity, ())
                    is_repeated = difference(way, again) < SHARE / 2
        except WsgenError as error:
            return _Driven(ways, error.message, is_repeated)
        return _Driven(ways, "", is_repeated)

    def _make_programs(self) -> bool:
        """Write the own programs that the launch file starts, where that is simple; whether any."""
        processes = self._launch.candidate.started.plan.processes
        installed = self._launch.check.installed
        is_any = False
        for process in processes:
            facts = installed.facts.get(process.package or "")
            for one in facts.executables if facts else ():
                if one.name != process.executable:
                    continue
                is_any |= one.source is not None or one.entry_point is not None
                place = installed.folder / "lib" / (process.package or "") / one.name
                if one.entry_point is not None and place.is_symlink():
                    module, _, function = one.entry_point.partition(":")
                    place.unlink()
                    folder = str(one.file.parent)
                    text = _PROGRAM.format(folder=folder, module=module, function=function)
                    place.write_text(text, encoding="utf-8")
                    place.chmod(0o755)
        return is_any

    def _run(self, run_live: RunLive, entity: str, words: Sequence[tuple[str, ...]]) -> Way:
        """The way of a robot.

        Raises:
            WsgenError: It cannot be run here, or something failed.
        """
        file = self._launch.folder / "driven.launch.py"
        own = str(self._launch.candidate.file)
        file.write_text(_LAUNCH.format(file=own, words=words), encoding="utf-8")
        selected = SelectedLaunchFile(file, None, (), None, self._launch.check.overlay)
        behavior = Behavior(name=LIVE, task=LaunchTask(), seconds=_SECONDS_LIVE, robot=entity)
        request = replace(_REQUEST, samples=round(_SECONDS_LIVE * 10), physics=SIM)
        found = run_live(selected, request, [BehaviorRun(entity=entity, behavior=behavior)])[LIVE]
        if found.problem or found.time_series is None:
            problem = found.problem or f"`{entity}` has not come into the world."
            raise RequestError(problem, hint="Run `wsgen launch --run`, which shows more.")
        return _steady_way(found.time_series)


def difference(way: Way, other: Way) -> float:
    """By which share one way differs from another; a short one counts as longer."""
    away, turned = math.dist(way[:2], other[:2]), abs(way[2] - other[2])
    return max(away / max(math.hypot(*way[:2]), LEAST_WAY), turned / max(abs(way[2]), LEAST_WAY))


def _steady_way(series: TimeSeries) -> Way:
    """How far a robot goes and turns in the time after it has come to its speed: m, 0, rad."""
    points = [
        (seconds, complex(*xyz[:2]))
        for seconds, xyz in zip(series.seconds, series.positions, strict=True)
        if seconds >= _STEADY_AFTER
    ][::_STEP]
    steps = [(end[0] - begin[0], end[1] - begin[1]) for begin, end in pairwise(points)]
    length = sum(abs(step) for _, step in steps)
    if length < _STANDS:
        return 0.0, 0.0, 0.0
    going = [(seconds, step) for seconds, step in steps if abs(step) > _STANDS / len(steps)]
    turn = sum(phase(after / before) for (_, before), (_, after) in pairwise(going))
    # From the middle of the first step to that of the last one.
    turned_for = points[-1][0] - points[0][0] - (going[0][0] + going[-1][0]) / 2
    seconds = _SECONDS_LIVE - _STEADY_AFTER
    return (
        length / (points[-1][0] - points[0][0]) * seconds,
        0.0,
        turn / turned_for * seconds if turned_for > 0 else 0.0,
    )


def _behavior_name(drive: str, entity: str) -> str:
    return f"{drive} {entity}"

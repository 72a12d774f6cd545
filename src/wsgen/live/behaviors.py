"""Run a launch file for the behaviors that ask for it, and measure; `wsgen.checks.rules` checks."""

from __future__ import annotations

import math
import shlex
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError, SessionDiedError
from wsgen.live.prepare import RunRequest
from wsgen.live.python_failures import LastTraceback, find_source
from wsgen.live.session import BrokenLaunchError, open_live
from wsgen.model.behavior import LiveMeasurement, TimeSeries
from wsgen.model.transform import rotation_of_quaternion
from wsgen.packages.workspace.layout import find_packages
from wsgen.pipeline.changed_since_build import shares_of
from wsgen.simulation.engine import State
from wsgen.simulation.sampling import DIGITS, TOLERANCE, Odometer, heading_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.live.journal import Journal
    from wsgen.live.session import LiveSession, LiveState
    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.transform import Vector
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest

MOST_LINES = 20  # of what was printed
LONGEST_LINE = 300  # characters


def run_live(
    selected: SelectedLaunchFile, request: ValidateRequest, behavior_runs: Sequence[BehaviorRun]
) -> Mapping[str, LiveMeasurement]:
    """Run the launch file from its start for each behavior; gives what was measured, by name.

    Raises:
        NotFoundError, NotReadableError: It cannot be run on this machine.
    """
    return {one.behavior.name: _run(selected, request, one) for one in behavior_runs}


def _run(
    selected: SelectedLaunchFile, request: ValidateRequest, behavior_run: BehaviorRun
) -> LiveMeasurement:
    behavior = behavior_run.behavior
    every = behavior.seconds / request.samples if request.samples else None
    entity = behavior.robot or behavior_run.entity  # nodes may spawn it under that name
    way = Way(entity, every=every)
    begun: list[float] = []
    problem = None
    sessions: list[LiveSession] = []

    def opened(session: LiveSession) -> None:
        sessions.append(session)
        if behavior.robot is None and entity in session.assumed:
            way.take_any()

    try:
        with open_live(
            selected,
            RunRequest(prepared_as=request, rate=None),
            opened=opened,
            observe=way.go,
        ) as session:
            # `assumed` ones have come, perhaps under another name than the behavior has.
            known = session.entities if behavior.robot else (*session.entities, *session.assumed)
            if entity not in known:
                session.wait_for_robot(entity)  # a node may spawn it
            way.begin()
            begun.append(session.state.seconds)
            session.run_for(behavior.seconds)
    except (SessionDiedError, RequestError) as error:
        problem = f"{error.message.rstrip('.')}{_cause(error.hint, _shares(selected))}"
    except BrokenLaunchError as broken:
        problem = str(broken)
    measured = way.measured(behavior.name, begun[0] if begun else None, problem)
    left_out = {what: why for one in sessions for what, why in one.journal.left_out.items()}
    return replace(
        measured,
        launched=_launched(selected, request),
        left_out=left_out,
        spawned=tuple(spawn for one in sessions for spawn in one.spawned),
        wall_seconds=sum(one.wall_seconds for one in sessions),
        printed=tuple(line for one in sessions for line in _last_lines(one.journal)),
    )


def _launched(selected: SelectedLaunchFile, request: ValidateRequest) -> str:
    """What `wsgen launch` takes to run the same."""
    arguments = (f"{name}:={value}" for name, value in request.launch_arguments.items())
    place = (selected.package, selected.file.name) if selected.package else (str(selected.file),)
    return shlex.join((*place, *arguments))


def _last_lines(journal: Journal) -> Iterator[str]:
    """What the process has printed last that has failed, or what says most of all, with names."""
    failed = next(iter(journal.failed), None)
    lines = (
        list(journal.important)
        if failed is None or not failed.lines
        else [f"[{failed.name}] {line}" for line in failed.lines]
    )
    for line in lines[-MOST_LINES:]:
        yield line if len(line) <= LONGEST_LINE else f"{line[: LONGEST_LINE - 1]}…"


def _shares(selected: SelectedLaunchFile) -> Mapping[Path, Path]:
    """Of the packages of the workspace: share folder -> source."""
    if selected.workspace is None:
        return {}
    return shares_of(find_packages(selected.workspace), selected.overlay)


def _cause(hint: str, shares: Mapping[Path, Path]) -> str:
    """What a process has printed last, where that is an exception: `: ValueError: …, at FILE:4`.

    The file is the source, where a traceback names what was installed of it.
    """
    lines = [line.strip() for line in hint.splitlines() if line.strip()]
    if not lines or not any(line.startswith("Traceback") for line in lines):
        return ""
    printed = LastTraceback()
    printed.take(hint.encode())
    frames = tuple(printed.innermost_first())
    source = find_source(frames, shares)
    place = ""
    if source is not None:
        place = f", in {source.place}"
    elif frames:
        place = f", in {frames[0][0]}:{frames[0][1]}"
    return f": {lines[-1]}{place}"


class Way:
    """What a robot does while its launch file runs.

    All robots are looked at from when they come into the world, as the one that counts may come
    after others.

    Args:
        entity: The robot; empty: whichever comes.
        every: Simulated seconds between the samples of its time series; None: it has none.
    """

    def __init__(self, entity: str, *, every: float | None = None) -> None:
        self._entity = entity
        self._takes_any = not entity
        self._every = every
        self._tracks: dict[str, _Track] = {}  # by robot, in the order in which they have come
        self._last: LiveState | None = None
        self._chosen = ""  # when the behavior began, for one that takes any

    def take_any(self) -> None:
        """Look at another robot while there is none of this name."""
        self._takes_any = True

    def begin(self) -> None:
        """Choose the robot from those that are in the world now."""
        self._chosen = "" if self._last is None else next(iter(self._last.poses), "")

    def go(self, state: LiveState) -> None:
        """Take in the next state."""
        before, self._last = self._last, state
        for entity in state.poses:
            if entity == self._entity or self._takes_any:
                track = self._tracks.setdefault(entity, _Track(entity, self._every))
                track.go(state, before)

    def _seen(self) -> _Track | None:
        """What is known of the robot that counts."""
        if self._entity in self._tracks or not self._takes_any:
            return self._tracks.get(self._entity)
        return self._tracks.get(self._chosen) or next(iter(self._tracks.values()), None)

    def measured(self, name: str, begun: float | None, problem: str | None) -> LiveMeasurement:
        """What was measured; `begun` is the simulated time when the behavior began."""
        last, track = self._last, self._seen()
        seconds = 0.0 if last is None or begun is None else last.seconds - begun
        found = LiveMeasurement(
            name=name,
            entity=self._entity if track is None else track.entity,
            seconds=seconds,
            is_finite=track is None or track.odometer.is_finite,
            problem=problem,
            time_series=None if track is None else track.time_series(name, begun),
        )
        if last is None or track is None or track.entity not in last.poses:
            return found
        return replace(
            found,
            is_there=True,
            moved=track.odometer.moved,
            traveled=track.traveled,
            tilt=track.tilt(last),
            positions=last.joints[track.entity],
        )


class _Track:
    """The way of one robot, from when it came into the world.

    Attributes:
        entity: The robot.
        odometer: How far it has moved.
        traveled: The length of its way, m.
    """

    odometer: Odometer

    def __init__(self, entity: str, every: float | None) -> None:
        self.entity = entity
        self.traveled = 0.0
        self._up: tuple[float, float, float] | None = None  # in the robot, when it was spawned
        self._heading = 0.0  # rad, when it was spawned
        self._every = every
        self._samples: list[_Sample] = []
        self._newest: _Sample | None = None

    def go(self, state: LiveState, before: LiveState | None) -> None:
        """Take in the next state, in which the robot is in the world."""
        seen = self._state(state)
        if self._up is None:
            self.odometer = Odometer(seen)
            self._up = rotation_of_quaternion(seen.xyzw)[2]
            self._heading = heading_of(seen)
            self._sample(state, 0.0)
            return
        self.odometer.go(seen)
        if before is not None and self.entity in before.poses:
            here, there = before.poses[self.entity].xyz, seen.xyz
            self.traveled += math.dist(here[:2], there[:2])
            passed = state.seconds - before.seconds
            if passed > 0:
                self._sample(state, math.dist(here, there) / passed)

    def _sample(self, state: LiveState, speed: float) -> None:
        """Keep the state, if the next sample is due; the last one is always kept."""
        joints = state.joints[self.entity]
        xyz = state.poses[self.entity].xyz
        if self._every is None or not all(map(math.isfinite, (*xyz, speed, *joints.values()))):
            return
        self._newest = _Sample(state.seconds, xyz, speed, self.tilt(state), joints)
        if not self._samples or state.seconds - self._samples[-1].seconds > self._every - TOLERANCE:
            self._samples.append(self._newest)

    def tilt(self, state: LiveState) -> float:
        """The angle between what was up in the robot and up, rad."""
        assert self._up is not None  # noqa: S101  it has been spawned
        rotation = rotation_of_quaternion(self._state(state).xyzw)
        up = sum(a * b for a, b in zip(rotation[2], self._up, strict=True))
        return math.acos(max(-1.0, min(1.0, up)))

    def time_series(self, name: str, begun: float | None) -> TimeSeries | None:
        """Its samples, in seconds from `begun`, a simulated time; None: it has none."""
        samples = self._samples
        if not samples or self._newest is None:
            return None
        if samples[-1] is not self._newest:
            samples = [*samples, self._newest]
        zero = samples[0].seconds if begun is None else begun
        return TimeSeries(
            behavior=name,
            seconds=tuple(round(one.seconds - zero, DIGITS) for one in samples),
            positions=tuple(_rounded(one.xyz) for one in samples),
            heading=round(self._heading, DIGITS),
            speeds=tuple(round(one.speed, DIGITS) for one in samples),
            tilts=tuple(round(one.tilt, DIGITS) for one in samples),
            joint_positions={
                joint: tuple(round(one.joints.get(joint, 0.0), DIGITS) for one in samples)
                for joint in samples[0].joints
            },
        )

    def _state(self, state: LiveState) -> State:
        x, y, z, w = state.quaternions[self.entity]
        xyz = state.poses[self.entity].xyz
        return State(xyz=xyz, xyzw=(x, y, z, w), speed=0.0, turning=0.0, joint_speed=0.0)


class _Sample(NamedTuple):
    """Where the robot was at a moment."""

    seconds: float  # simulated
    xyz: Vector  # m, of the root link in the world
    speed: float  # m/s, of the root link's frame, since the state before
    tilt: float  # rad
    joints: Mapping[str, float]  # rad or m


def _rounded(xyz: Vector) -> Vector:
    x, y, z = (round(value, DIGITS) for value in xyz)
    return x, y, z

"""Samples of how robots move, taken while they are simulated."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.behavior import TimeSeries
from wsgen.model.transform import multiply, rotation_of_quaternion, transpose
from wsgen.simulation.engine import is_finite

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.transform import Matrix
    from wsgen.simulation.engine import Engine, State
    from wsgen.simulation.scene import RobotRun, Scene


class Odometer:
    """How far a robot has come since it began.

    Attributes:
        moved: m, m, rad: of the root link's frame, along x and y of where it was, and how far it
            has turned, whole turns included.
        is_finite: Whether all states were; if not, `moved` is what was measured before.
    """

    def __init__(self, start: State) -> None:
        self.is_finite = is_finite(start)
        self._xyz = start.xyz
        self._heading = self._last = heading_of(start) if self.is_finite else 0.0
        self.moved = (0.0, 0.0, 0.0)  # m, m, rad

    def go(self, state: State) -> None:
        """Take in where it is an update later."""
        self.is_finite = self.is_finite and is_finite(state)
        if not self.is_finite:
            return
        heading = heading_of(state)
        turned = self.moved[2] + math.remainder(heading - self._last, math.tau)
        self._last = heading
        east, north = state.xyz[0] - self._xyz[0], state.xyz[1] - self._xyz[1]
        sin, cos = math.sin(self._heading), math.cos(self._heading)
        self.moved = (cos * east + sin * north, cos * north - sin * east, turned)


def heading_of(state: State) -> float:
    """Of the root link's x axis on the ground, rad."""
    rotation = rotation_of_quaternion(state.xyzw)
    return math.atan2(rotation[1][0], rotation[0][0])


DIGITS = 6  # of m, rad and s that are kept: engines are less exact
TOLERANCE = 1e-9  # s, of the time of a sample


class Sampler:
    """An observer of a simulation: keeps `scene.samples` samples of each robot, and not many more.

    While they stand, of all robots; then of each behavior those of the robot that it is about.
    Models of the world are left out.
    """

    def __init__(self, engine: Engine, scene: Scene) -> None:
        self._engine = engine
        self._scene = scene
        self._robots = {robot.entity for robot in scene.robots if not robot.is_static_model}
        self._behavior_runs: Iterator[BehaviorRun] | None = None  # that are still to come
        self._upright: dict[str, Matrix] = {}  # what turns the robot back to how it was spawned
        # Standing, then each behavior: its name, and the samples by entity.
        self._parts: list[tuple[str | None, dict[str, _Samples]]] = [(None, {})]
        self._began = 0.0  # s, the part
        self._every = scene.seconds / scene.samples  # s
        self._count = 0  # of the moments of the part that have been sampled
        self._only: str | None = None  # the robot that the part is about

    def begin(self, name: str, seconds: float) -> None:
        """The next behavior begins now."""
        behavior_run = next(self._behavior_runs or iter(()))
        assert behavior_run.behavior.name == name  # noqa: S101  they are run in their order
        self._parts.append((name, {}))
        self._began, self._count, self._only = seconds, 0, behavior_run.entity
        self._every = behavior_run.behavior.seconds / self._scene.samples

    def __call__(self, seconds: float, entities: Sequence[str]) -> None:
        """Look, if it is time for the next sample."""
        if self._behavior_runs is None:  # only now it is known which robots are there
            there = [one for one in self._scene.behavior_runs if one.entity in entities]
            self._behavior_runs = iter(there)
        since = seconds - self._began
        if since < self._every * self._count - TOLERANCE:
            return
        self._count = math.floor((since + TOLERANCE) / self._every) + 1
        for entity in entities:
            if entity in self._robots and self._only in {None, entity}:
                self._sample(entity, since)

    def _sample(self, entity: str, since: float) -> None:
        state = self._engine.state(entity)
        joints = self._engine.joint_positions(entity)
        if not (is_finite(state) and all(map(math.isfinite, joints.values()))):
            return
        rotation = rotation_of_quaternion(state.xyzw)
        upright = self._upright.setdefault(entity, transpose(rotation))
        cosine = multiply(rotation, upright)[2][2]
        tilt = math.acos(min(1.0, max(-1.0, cosine)))
        _, samples = self._parts[-1]
        samples.setdefault(entity, _Samples()).add(since, state, tilt, joints)

    def add_to(self, robot_runs: Sequence[RobotRun]) -> list[RobotRun]:
        """The runs with the samples."""
        return [
            replace(
                robot_run,
                time_series=tuple(
                    samples[robot_run.entity].read(name)
                    for name, samples in self._parts
                    if robot_run.entity in samples
                ),
            )
            for robot_run in robot_runs
        ]


class _Samples:
    """The samples of a robot while it stood, or during one behavior."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, State, float]] = []  # s, state, tilt
        self.joints: list[Mapping[str, float]] = []

    def add(self, seconds: float, state: State, tilt: float, joints: Mapping[str, float]) -> None:
        self.rows.append((seconds, state, tilt))
        self.joints.append(joints)

    def read(self, behavior: str | None) -> TimeSeries:
        states = [state for _, state, _ in self.rows]
        return TimeSeries(
            behavior=behavior,
            seconds=tuple(round(seconds, DIGITS) for seconds, _, _ in self.rows),
            positions=tuple(
                (round(x, DIGITS), round(y, DIGITS), round(z, DIGITS))
                for x, y, z in (state.xyz for state in states)
            ),
            heading=round(heading_of(states[0]), DIGITS),
            speeds=tuple(round(state.speed, DIGITS) for state in states),
            tilts=tuple(round(tilt, DIGITS) for _, _, tilt in self.rows),
            joint_positions={
                name: tuple(round(positions[name], DIGITS) for positions in self.joints)
                for name in self.joints[0]
            },
        )

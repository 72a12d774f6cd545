"""Trajectories of joints, as joint_trajectory_controller follows them.

Source: ros-controls/ros2_controllers, joint_trajectory_controller/src/trajectory.cpp and
joint_trajectory_controller.cpp (Humble to Kilted): which spline joins two points, what a point
without positions means, when tolerances count.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from copy import deepcopy
from dataclasses import field, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

_NO_VELOCITY = 1.2e-7  # rad/s or m/s: the epsilon of a float of 32 bits
_CLOSE_TO_HALF_TURN = 1e-9  # rad


@dataclass
class Point:
    """Where the joints are at a time; what is not known is an empty list."""

    positions: list[float] = field(default_factory=list)  # rad or m
    velocities: list[float] = field(default_factory=list)  # rad/s or m/s
    accelerations: list[float] = field(default_factory=list)  # rad/s² or m/s²
    effort: list[float] = field(default_factory=list)  # N m or N
    seconds: float = 0.0  # from the start of the trajectory


FIELDS = ("positions", "velocities", "accelerations", "effort")


class Sample(NamedTuple):
    """A trajectory at one time."""

    point: Point
    next: int  # index of the point that is reached next; after the last one, how many there are


class Tolerance(NamedTuple):
    """How far off one joint may be; 0 where it does not matter."""

    position: float = 0.0  # rad or m
    velocity: float = 0.0  # rad/s or m/s
    acceleration: float = 0.0  # rad/s² or m/s²

    def allows(self, error: tuple[float, float, float]) -> bool:
        """Whether a joint is near enough: errors of position, velocity and acceleration."""
        return all(
            bound <= 0.0 or abs(off) <= bound for bound, off in zip(self, error, strict=True)
        )


@dataclass
class Tolerances:
    """Those of all joints of a controller, in its order."""

    path: list[Tolerance]
    goal: list[Tolerance]
    goal_seconds: float = 0.0  # after the end; 0: any time


def wrapped(angle: float) -> float:
    """The same angle, from -pi to pi."""
    return math.remainder(angle, math.tau)


def nearest_turn(position: float, target: float) -> float:
    """The position of a joint without ends, by whole turns as near to a target as it can be."""
    distance = wrapped(target - position)
    if abs(abs(distance) - math.pi) < _CLOSE_TO_HALF_TURN:
        distance = math.copysign(math.pi, target - position)
    return target - distance


class Trajectory:
    """Points that are reached one after the other, and how the joints get from one to the next."""

    def __init__(
        self,
        points: Sequence[Point],
        *,
        start: float | None = None,
        wraps: Sequence[bool] = (),
        interpolates: bool = True,
    ) -> None:
        self.points = deepcopy(list(points))
        self.start = start  # s, of the clock; None: when it is begun
        self._wraps = wraps
        self._interpolates = interpolates
        self._before: Point | None = None
        self._before_time = 0.0
        self._segment = (-2, 0.0, 0.0)  # which one the coefficients are for, its start and length
        self._coefficients: list[tuple[float, ...]] = []
        self._efforts: list[tuple[float, float]] = []
        self._deduced_from_first = False

    @property
    def is_begun(self) -> bool:
        """Whether it is known from where it goes to its first point."""
        return self._before is not None

    @property
    def end(self) -> float:
        """The time of the last point, s of the clock."""
        return (self.start or 0.0) + self.points[-1].seconds

    def begin(self, time: float, point: Point) -> None:
        """Go on from a point, where the joints are at a time (s of the clock)."""
        before = deepcopy(point)
        first = self.points[0]
        for name in ("velocities", "accelerations"):
            if not getattr(before, name) and getattr(first, name):
                setattr(before, name, [0.0] * len(getattr(first, name)))
        if first.positions:
            for index, wraps in enumerate(self._wraps):
                if wraps:
                    before.positions[index] = nearest_turn(
                        before.positions[index], first.positions[index]
                    )
        self._before, self._before_time = before, time
        if self.start is None:
            self.start = time
        self._deduce()

    def _deduce(self) -> None:
        """Give each point positions: where there are none, its derivatives give them."""
        before, start = self._before, self.start
        if before is None or start is None or self._deduced_from_first:
            return
        self._deduced_from_first = True
        last, last_time = before, self._before_time
        for point in self.points:
            time = start + point.seconds
            _deduce(last, point, len(before.positions), time - last_time)
            last, last_time = point, time

    def sample(self, time: float) -> Sample:
        """Where the joints are meant to be at a time (s of the clock), after it was begun."""
        before, start = self._before, self.start
        assert before is not None  # noqa: S101  it was begun
        assert start is not None  # noqa: S101
        points = self.points
        since = time - start
        if since < points[0].seconds:
            if not self._interpolates:
                return Sample(before, 0)
            return Sample(self._between(-1, time), 0)
        if since < points[-1].seconds:
            index = bisect_right(points, since, key=lambda point: point.seconds) - 1
            if not self._interpolates:
                return Sample(points[index + 1], index + 1)
            return Sample(self._between(index, time), index + 1)
        return Sample(_complete(points[-1]), len(points))

    def _between(self, index: int, time: float) -> Point:
        """Between a point and the next one; -1 is where the joints were before."""
        if self._segment[0] != index:
            self._prepare(index)
        _, begin, length = self._segment
        passed = time - begin
        if not 0.0 <= passed <= length:
            passed = min(length, max(0.0, passed))
        positions, velocities, accelerations = [], [], []
        for a, b, c, d, e, f in self._coefficients:
            positions.append(
                a + passed * (b + passed * (c + passed * (d + passed * (e + passed * f))))
            )
            velocities.append(
                b + passed * (2 * c + passed * (3 * d + passed * (4 * e + passed * 5 * f)))
            )
            accelerations.append(2 * c + passed * (6 * d + passed * (12 * e + passed * 20 * f)))
        effort = [first + passed * slope for first, slope in self._efforts]
        return Point(positions, velocities, accelerations, effort, self.points[index + 1].seconds)

    def _prepare(self, index: int) -> None:
        before, start = self._before, self.start
        assert before is not None  # noqa: S101  it was begun
        assert start is not None  # noqa: S101
        first = before if index < 0 else self.points[index]
        begin = self._before_time if index < 0 else start + first.seconds
        last = self.points[index + 1]
        length = start + last.seconds - begin
        self._segment = (index, begin, length)
        self._coefficients = list(_splines(first, last, length))
        number = len(first.positions)
        if first.effort and last.effort:
            self._efforts = [
                (one, (other - one) / length if length else 0.0)
                for one, other in zip(first.effort, last.effort, strict=False)
            ]
        else:
            self._efforts = [(0.0, 0.0)] * number


def _complete(point: Point) -> Point:
    """The last point, at which joints stay: what it does not say is 0."""
    zeros = [0.0] * len(point.positions)
    missing: dict[str, Any] = {name: zeros for name in FIELDS[1:] if not getattr(point, name)}
    return replace(point, **missing)


def _deduce(first: Point, second: Point, joints: int, length: float) -> None:
    if second.positions:
        return
    zeros = [0.0] * joints
    begin = first.velocities or zeros
    if not second.velocities:
        rates = zip(first.accelerations or zeros, second.accelerations or zeros, strict=False)
        second.velocities = [
            speed + (one + other) / 2 * length
            for speed, (one, other) in zip(begin, rates, strict=False)
        ]
    if not first.velocities:
        first.velocities = list(begin)
    speeds = zip(begin, second.velocities, strict=False)
    second.positions = [
        position + (one + other) / 2 * length
        for position, (one, other) in zip(first.positions, speeds, strict=False)
    ]


Coefficients = tuple[float, float, float, float, float, float]


def _splines(first: Point, last: Point, length: float) -> Iterator[Coefficients]:
    """The polynomial of each joint between two points: linear, cubic or quintic."""
    has_velocity = bool(first.velocities and last.velocities)
    has_acceleration = has_velocity and bool(first.accelerations and last.accelerations)
    for index, (p0, p1) in enumerate(zip(first.positions, last.positions, strict=False)):
        v0, v1 = (first.velocities[index], last.velocities[index]) if has_velocity else (0.0, 0.0)
        if length <= 0.0:
            acceleration = first.accelerations[index] if has_acceleration else 0.0
            yield p0, v0, acceleration / 2, 0.0, 0.0, 0.0
        elif not has_velocity:
            yield p0, (p1 - p0) / length, 0.0, 0.0, 0.0, 0.0
        elif not has_acceleration:
            step = p1 - p0
            yield (
                p0,
                v0,
                (3 * step - (2 * v0 + v1) * length) / length**2,
                ((v0 + v1) * length - 2 * step) / length**3,
                0.0,
                0.0,
            )
        else:
            a0, a1 = first.accelerations[index], last.accelerations[index]
            # Of what uniform acceleration a0 leaves to be done until the end.
            step = p1 - p0 - v0 * length - a0 * length**2 / 2
            speed = (v1 - v0 - a0 * length) * length
            rate = (a1 - a0) * length**2
            yield (
                p0,
                v0,
                a0 / 2,
                (10 * step - 4 * speed + rate / 2) / length**3,
                (-15 * step + 7 * speed - rate) / length**4,
                (6 * step - 3 * speed + rate / 2) / length**5,
            )


class Message(NamedTuple):
    """A trajectory as it was sent."""

    joints: tuple[str, ...]
    points: tuple[Point, ...]
    start: float | None  # s of the clock; None: at once


@dataclass(frozen=True)
class Accepted:
    """Which trajectories a controller takes."""

    joints: tuple[str, ...]  # its own, in its order
    allows_partial: bool = False
    allows_integration: bool = False
    allows_moving_end: bool = True
    has_effort: bool = False

    def refusal(self, message: Message, now: float) -> str | None:
        """Why a trajectory is refused; None if it is not."""
        return (
            self._refused_joints(message)
            or self._refused_end(message, now)
            or next(self._refused_points(message), None)
        )

    def _refused_joints(self, message: Message) -> str | None:
        if not self.allows_partial and len(message.joints) != len(self.joints):
            return "Joints on incoming trajectory don't match the controller joints."
        if not message.joints:
            return "Empty joint names on incoming trajectory."
        if not message.points:
            return "Empty trajectory received."
        for name in message.joints:
            if name not in self.joints:
                return f"Incoming joint {name} doesn't match the controller's joints."
        return None

    def _refused_end(self, message: Message, now: float) -> str | None:
        if not self.allows_moving_end:
            for name, speed in zip(message.joints, message.points[-1].velocities, strict=False):
                if abs(speed) > _NO_VELOCITY:
                    return (
                        f"Velocity of last trajectory point of joint {name} is not zero: "
                        f"{speed:.15f}"
                    )
        if message.start is not None:
            end = message.start + message.points[-1].seconds
            if end < now:
                return (
                    f"Received trajectory with non-zero start time ({message.start:f}) "
                    f"that ends in the past ({end:f})"
                )
        return None

    def _refused_points(self, message: Message) -> Iterator[str]:
        last = 0.0
        for index, point in enumerate(message.points):
            if index and point.seconds <= last:
                yield (
                    f"Time between points {index - 1} and {index} is not strictly increasing, "
                    f"it is {last:f} and {point.seconds:f} respectively"
                )
            last = point.seconds
            filled = [name for name in FIELDS[:3] if getattr(point, name)]
            if self.allows_integration and not filled:
                yield "The given trajectory has no position, velocity, or acceleration points."
            for name in filled if self.allows_integration else ("positions", *filled):
                size = len(getattr(point, name))
                if size != len(message.joints):
                    yield (
                        f"Mismatch between joint_names size ({len(message.joints)}) and {name} "
                        f"({size}) at point #{index}."
                    )
                if not all(map(math.isfinite, getattr(point, name))):
                    yield f"A value in {name} at point #{index} is not a finite number."
            if point.effort and not self.has_effort:
                yield (
                    "Trajectories with effort fields are only supported for controllers using "
                    "the 'effort' command interface."
                )

    def in_order(self, message: Message, now: Mapping[str, float]) -> tuple[Point, ...]:
        """The points with the joints in the controller's order; missing ones stay where they are.

        `now` has a position for each joint.
        """
        index_of = {name: index for index, name in enumerate(message.joints)}
        places = [index_of.get(name) for name in self.joints]
        rest = [now[name] for name in self.joints]
        zeros = [0.0] * len(self.joints)

        def in_order(values: list[float], missing: list[float]) -> list[float]:
            if not values:
                return []
            return [
                missing[index] if place is None else values[place]
                for index, place in enumerate(places)
            ]

        def sorted_point(point: Point) -> Point:
            values: dict[str, Any] = {
                name: in_order(getattr(point, name), rest if name == FIELDS[0] else zeros)
                for name in FIELDS
            }
            return replace(point, **values)

        return tuple(map(sorted_point, message.points))


class Outcome(Enum):
    """How a trajectory ended."""

    REACHED = "Goal successfully reached!"
    OFF_PATH = "Aborted due to path tolerance violation"
    OFF_GOAL = "Aborted due to goal_time_tolerance exceeding by {:f} seconds"
    TIMED_OUT = "Aborted due to command timeout"


class Step(NamedTuple):
    """What a follower says at one update."""

    desired: Point  # now
    command: Point  # for the time until the next update
    errors: Point  # desired less actual
    next: int  # index of the point that is reached next
    outcome: Outcome | None = None
    overdue: float = 0.0  # s since the end, with an outcome


class Follower:
    """Follows one trajectory after the other, and holds still between them."""

    def __init__(
        self,
        wraps: Sequence[bool],
        period: float,
        tolerances: Tolerances,
        *,
        timeout: float = 0.0,
        compares_velocities: bool = False,
    ) -> None:
        self._compares_velocities = compares_velocities
        self._wraps = tuple(wraps)
        self._period = period  # s between two updates
        self.tolerances = tolerances
        self._timeout = timeout  # s after the end; 0: none
        self.trajectory: Trajectory | None = None
        self.is_holding = True
        self.has_goal = False  # somebody waits for its end
        self._is_first = True
        self._last: Step | None = None
        self._time = 0.0  # s, of the trajectory's own clock
        self.speed = 1.0  # how fast that clock goes

    def hold(self, positions: Sequence[float]) -> None:
        """Stay at positions (rad or m)."""
        self.follow(Trajectory([Point(list(positions))]))
        self.is_holding = True

    def follow(self, trajectory: Trajectory) -> None:
        """Follow a trajectory from the next update on."""
        self.trajectory = trajectory
        self.is_holding = False
        self._is_first = True
        self._last = None

    def errors(self, desired: Point, actual: Point) -> Point:
        """What the joints are off."""
        positions = [
            wrapped(aim - at) if wraps else aim - at
            for aim, at, wraps in zip(desired.positions, actual.positions, self._wraps, strict=True)
        ]
        velocities = (
            [aim - at for aim, at in zip(desired.velocities, actual.velocities, strict=False)]
            if self._compares_velocities
            else []
        )
        return Point(positions, velocities)

    def update(self, now: float, elapsed: float, actual: Point) -> Step:
        """What to do until the next update; `actual` is where the joints are at `now` (s)."""
        trajectory = self.trajectory
        assert trajectory is not None  # noqa: S101  it holds or follows from the beginning
        is_first = self._is_first
        if is_first:
            if not trajectory.is_begun:
                trajectory.begin(now, actual)
            self._time = now
            self._is_first = False
        else:
            self._time += elapsed * self.speed
        if self.is_holding and self._last is not None:
            return self._last._replace(errors=self.errors(self._last.desired, actual))
        desired, _ = trajectory.sample(self._time)
        command, index = trajectory.sample(self._time + self._period)
        errors = self.errors(desired, actual)
        is_over = index >= len(trajectory.points)
        overdue = self._time - trajectory.end
        step = Step(desired, command, errors, index)
        if self.is_holding:
            self._last = step if is_over else None
            return step
        outcome = self._outcome(errors, overdue, is_over=is_over, is_first=is_first)
        if outcome is not None:
            return step._replace(outcome=outcome, overdue=overdue)
        return step

    def _outcome(
        self, errors: Point, overdue: float, *, is_over: bool, is_first: bool
    ) -> Outcome | None:
        tolerances = self.tolerances
        if is_over and 0.0 < self._timeout < overdue:
            return Outcome.TIMED_OUT
        if not is_over or is_first:
            return None if _allowed(tolerances.path, errors) else Outcome.OFF_PATH
        if _allowed(tolerances.goal, errors):
            return Outcome.REACHED if self.has_goal else None
        if 0.0 < tolerances.goal_seconds < overdue:
            return Outcome.OFF_GOAL
        return None


def _allowed(tolerances: Sequence[Tolerance], errors: Point) -> bool:
    for index, tolerance in enumerate(tolerances):
        if any(tolerance):
            speed = errors.velocities[index] if errors.velocities else 0.0
            if not tolerance.allows((errors.positions[index], speed, 0.0)):
                return False
    return True


def effective(default: float, asked: float) -> float:
    """The tolerance of a goal: 0 leaves the default, -1 takes it away; ValueError below that.

    Source: control_msgs/msg/JointTolerance.msg.
    """
    if asked > 0.0:
        return asked
    if abs(asked + 1.0) < _NO_VELOCITY:
        return 0.0
    if asked < 0.0:
        raise ValueError(asked)
    return default

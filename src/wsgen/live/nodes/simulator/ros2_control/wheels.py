"""What controllers of wheels compute: limits of speeds, commands, and odometry. SI units.

Sources: ros-controls/ros2_controllers, diff_drive_controller/src/odometry.cpp and
speed_limiter.cpp (Humble, Kilted), control_toolbox's rate_limiter.hpp, and
steering_controllers_library/src/steering_kinematics.cpp. Wheels of one axle that is steered are in
the order right, left.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters


_STRAIGHT = 1e-6  # rad, of one update: less is no curve
_SHORTEST = 1e-4  # s, between two updates of odometry


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Of one of the two speeds; None is no limit."""

    least: float | None = None  # m/s or rad/s, not above 0
    most: float | None = None  # not below 0
    speeding_up: float | None = None  # m/s² or rad/s², when it goes forward; not below 0
    slowing_down: float | None = None  # likewise; not above 0
    speeding_back: float | None = None  # when it goes backward; not above 0
    slowing_back: float | None = None  # likewise; not below 0
    least_jerk: float | None = None  # m/s³ or rad/s³
    most_jerk: float | None = None

    @classmethod
    def read(cls, parameters: Parameters, prefix: str, *, is_former: bool) -> Limits:
        """Of `linear.x` or `angular.z`; Humble's are switched on by `has_…_limits`."""

        def bounds(name: str) -> tuple[float | None, float | None]:
            if is_former and not parameters.flag(f"{prefix}.has_{name}_limits"):
                return None, None
            most = parameters.bound(f"{prefix}.max_{name}")
            least = parameters.bound(f"{prefix}.min_{name}")
            return (-most if least is None and most is not None else least), most

        least, most = bounds("velocity")
        least_jerk, most_jerk = bounds("jerk")
        if is_former:
            down, up = speeding_back, slowing_back = bounds("acceleration")
        else:
            up = parameters.bound(f"{prefix}.max_acceleration")
            down = parameters.bound(f"{prefix}.max_deceleration")
            if up is not None and down is None:
                down = -up
            back = parameters.bound(f"{prefix}.max_acceleration_reverse")
            slower_back = parameters.bound(f"{prefix}.max_deceleration_reverse")
            speeding_back = _mirrored(up) if back is None else back
            slowing_back = _mirrored(down) if slower_back is None else slower_back
        return cls(
            least=least,
            most=most,
            speeding_up=up,
            slowing_down=down,
            speeding_back=speeding_back,
            slowing_back=slowing_back,
            least_jerk=least_jerk,
            most_jerk=most_jerk,
        )

    def next(self, wanted: float, last: float, before: float, seconds: float) -> float:
        """The speed after `last`, which came after `before`, a time later."""
        speed = wanted
        if self.least_jerk is not None and self.most_jerk is not None:
            rate = last - before
            change = (speed - last) - rate
            bound = 2.0 * seconds * seconds
            speed = last + rate + min(self.most_jerk * bound, max(self.least_jerk * bound, change))
        speed = self._accelerated(speed, last, seconds)
        if self.most is not None and self.least is not None:
            speed = min(self.most, max(self.least, speed))
        return speed

    def _accelerated(self, speed: float, last: float, seconds: float) -> float:
        if abs(last) < 1e-6:  # noqa: PLR2004  it stands: either way is speeding up
            low, high = self.speeding_back, self.speeding_up
        elif last > 0.0:
            low, high = self.slowing_down, self.speeding_up
        else:
            low, high = self.speeding_back, self.slowing_back
        change = speed - last
        if high is not None:
            change = min(high * seconds, change)
        if low is not None:
            change = max(low * seconds, change)
        return last + change


def _mirrored(value: float | None) -> float | None:
    return None if value is None else -value


class Odometry:
    """Where a robot is, by the speeds that its wheels have.

    Attributes:
        x: m, in the frame of odometry.
        y: m.
        heading: rad.
        linear: m/s, forward: the mean of the last updates.
        angular: rad/s, to the left, likewise.
    """

    def __init__(self, window: int) -> None:
        """Of how many updates speeds are the mean."""
        self._speeds: deque[tuple[float, float]] = deque(maxlen=max(1, window))
        self.x = self.y = self.heading = 0.0
        self.linear = self.angular = 0.0

    def by_commands(self, linear: float, angular: float, seconds: float) -> None:
        """The robot is believed to follow its command, m/s and rad/s."""
        self.linear, self.angular = linear, angular
        self._integrate(linear * seconds, angular * seconds)

    def by_speeds(self, linear: float, angular: float, seconds: float) -> None:
        """It has gone like that (m/s, rad/s) since the last update."""
        if seconds < _SHORTEST:
            return
        self._integrate(linear * seconds, angular * seconds)
        self._speeds.append((linear, angular))
        self.linear = sum(one for one, _ in self._speeds) / len(self._speeds)
        self.angular = sum(one for _, one in self._speeds) / len(self._speeds)

    def _integrate(self, way: float, turn: float) -> None:
        if abs(turn) < _STRAIGHT:
            direction = self.heading + turn / 2
            self.x += way * math.cos(direction)
            self.y += way * math.sin(direction)
            self.heading += turn
            return
        old, radius = self.heading, way / turn
        self.heading += turn
        self.x += radius * (math.sin(self.heading) - math.sin(old))
        self.y -= radius * (math.cos(self.heading) - math.cos(old))


class WheelOdometry(Odometry):
    """That of a robot with two wheels, by how these have turned."""

    def __init__(self, separation: float, left: float, right: float, window: int) -> None:
        """Distance of the wheels and their radii (m); of how many updates speeds are the mean."""
        super().__init__(window)
        self._separation, self._left, self._right = separation, left, right
        self._last: tuple[float, float] | None = None

    def by_positions(self, left: float, right: float, seconds: float) -> None:
        """The wheels are at these positions (rad) now."""
        way = (left * self._left, right * self._right)
        last, self._last = self._last or (0.0, 0.0), way
        if seconds >= _SHORTEST:
            self._go((way[0] - last[0]) / seconds, (way[1] - last[1]) / seconds, seconds)

    def by_velocities(self, left: float, right: float, seconds: float) -> None:
        """The wheels turn that fast (rad/s) now."""
        self._go(left * self._left, right * self._right, seconds)

    def _go(self, left: float, right: float, seconds: float) -> None:
        self.by_speeds((left + right) / 2, (right - left) / self._separation, seconds)


_STEERED_STRAIGHT = 1e-6  # rad, of the steering: less is straight ahead
_NEAR, _FAR = math.pi / 6, 1.5608  # rad, that the steering is off: full speed, almost none


@dataclass(frozen=True, kw_only=True)
class SteeringBase:
    """The measures of a robot with driven wheels on one axle and steered ones on another, m."""

    wheelbase: float  # between the axles
    radius: float  # of the driven wheels
    traction_track: float = 0.0  # between driven wheels; 0 for one
    steering_track: float = 0.0  # between steered wheels; 0 for one
    driven: int = 1
    steered: int = 1

    def angle(self, linear: float, angular: float) -> float:
        """The angle of a wheel in the middle of the steered axle for a motion, rad."""
        if linear == 0.0:
            return math.copysign(math.pi / 2, angular) if angular else 0.0
        return math.atan(angular * self.wheelbase / linear)

    def commands(
        self, linear: float, angular: float, *, steered: float | None, waits: bool
    ) -> tuple[list[float], list[float]]:
        """Speeds (rad/s) of driven wheels and angles (rad) of steered ones.

        Args:
            linear: m/s.
            angular: rad/s.
            steered: How the wheels are steered, rad; None: as the command has it.
            waits: Whether the wheels turn less until they are steered as commanded.
        """
        angle = self.angle(linear, angular)
        there = angle if steered is None else steered
        speed = linear / self.radius
        if steered is not None and waits and (off := abs(steered - angle)) >= _NEAR:
            speed *= math.cos(min(off, _FAR)) / math.cos(_NEAR)
        return self._traction(speed, there), self._steering(angle, there)

    def _traction(self, speed: float, steered: float) -> list[float]:
        if self.driven == 1 or abs(steered) < _STEERED_STRAIGHT:
            return [speed] * self.driven
        share = self.traction_track / 2 * math.tan(steered) / self.wheelbase
        return [speed * (1 + share), speed * (1 - share)]

    def _steering(self, angle: float, steered: float) -> list[float]:
        if self.steered == 1 or abs(steered) < _STEERED_STRAIGHT:
            return [angle] * self.steered
        way = 2 * self.wheelbase * math.sin(angle)
        ahead = 2 * self.wheelbase * math.cos(angle)
        side = self.steering_track * math.sin(angle)
        return [math.atan2(way, ahead + side), math.atan2(way, ahead - side)]

    def steered_by(self, angles: Sequence[float]) -> float:
        """The angle in the middle of the steered axle, by those of its wheels (rad)."""
        if len(angles) == 1:
            return angles[0]
        half = self.steering_track / 2
        found = [
            math.atan(
                self.wheelbase * math.tan(angle) / (self.wheelbase - sign * half * math.tan(angle))
            )
            for angle, sign in zip(angles, (1.0, -1.0), strict=True)
        ]
        return sum(found) / 2

    def motion(self, wheels: Sequence[float], steered: float) -> tuple[float, float]:
        """How fast it goes (m/s) and turns (rad/s) by speeds of its driven wheels (rad/s)."""
        rims = [speed * self.radius for speed in wheels]
        tangent = math.tan(steered)
        if len(rims) > 1:
            share = self.traction_track / 2 * tangent / self.wheelbase
            rims = [rims[0] / (1 + share), rims[1] / (1 - share)]
        linear = sum(rims) / len(rims)
        return linear, tangent * linear / self.wheelbase

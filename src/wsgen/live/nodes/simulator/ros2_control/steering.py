"""What the steering controllers compute: commands of wheels, and odometry. SI units.

Source: ros-controls/ros2_controllers, steering_controllers_library/src/steering_kinematics.cpp.
Wheels of one axle are in the order right, left.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

_STRAIGHT = 1e-6  # rad, of the steering: less is straight ahead
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
        if self.driven == 1 or abs(steered) < _STRAIGHT:
            return [speed] * self.driven
        share = self.traction_track / 2 * math.tan(steered) / self.wheelbase
        return [speed * (1 + share), speed * (1 - share)]

    def _steering(self, angle: float, steered: float) -> list[float]:
        if self.steered == 1 or abs(steered) < _STRAIGHT:
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

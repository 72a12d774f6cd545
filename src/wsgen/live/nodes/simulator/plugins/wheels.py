"""Where a robot is by how its wheels have turned. SI units."""

from __future__ import annotations

import math

STRAIGHT = 1e-6  # rad, of an arc that is as good as straight


class WheelOdometry:
    """Where a robot is by how far its two wheels have turned, as `gz::math::DiffDriveOdometry`.

    Attributes:
        x: m, where it began to the front.
        y: m, to the left.
        heading: rad, whole turns included.
        linear: m/s, in the last update.
        angular: rad/s, likewise.
    """

    def __init__(self, separation: float, left_radius: float, right_radius: float) -> None:
        self._separation = separation
        self._radii = left_radius, right_radius
        self._last: tuple[float, float, float] | None = None
        self.x = self.y = self.heading = self.linear = self.angular = 0.0

    def update(self, left: float, right: float, now: float) -> None:
        """Take in the positions of the wheels (rad) at a time (s)."""
        last, self._last = self._last, (left, right, now)
        if last is None or now <= last[2]:
            return
        ways = (left - last[0]) * self._radii[0], (right - last[1]) * self._radii[1]
        way, turn = (ways[0] + ways[1]) / 2, (ways[1] - ways[0]) / self._separation
        if abs(turn) < STRAIGHT:
            direction = self.heading + turn / 2
            self.x += way * math.cos(direction)
            self.y += way * math.sin(direction)
        else:
            radius, after = way / turn, self.heading + turn
            self.x += radius * (math.sin(after) - math.sin(self.heading))
            self.y -= radius * (math.cos(after) - math.cos(self.heading))
        self.heading += turn
        self.linear, self.angular = way / (now - last[2]), turn / (now - last[2])

    def reset(self) -> None:
        """Begin again where it is."""
        self._last = None
        self.x = self.y = self.heading = self.linear = self.angular = 0.0

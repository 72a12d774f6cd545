"""PID controllers as Gazebo Sim has them.

Source: gazebosim/gz-math, src/PID.cc: the error is where it is less where it should be, the gain of
the integral is applied as it grows, and a bound counts where the upper one is not below the lower.
"""

from __future__ import annotations

import math

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class Gains:
    """What <p_gain> and the like say."""

    p: float
    i: float
    d: float
    i_max: float = -1.0  # below `i_min`: none
    i_min: float = 0.0
    most: float = -1.0  # of the output; below `least`: none
    least: float = 0.0
    offset: float = 0.0  # of the output


class GzPid:
    """A PID controller."""

    def __init__(self, gains: Gains) -> None:
        self._gains = gains
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self._integral = self._last = 0.0

    def command(self, error: float, seconds: float) -> float:
        """What to do about an error, that time after the last one."""
        if seconds <= 0.0 or not math.isfinite(error):
            return 0.0
        gains = self._gains
        self._integral += gains.i * seconds * error
        if gains.i_max >= gains.i_min:
            self._integral = min(gains.i_max, max(gains.i_min, self._integral))
        rate, self._last = (error - self._last) / seconds, error
        command = gains.offset - gains.p * error - self._integral - gains.d * rate
        if gains.most >= gains.least:
            command = min(gains.most, max(gains.least, command))
        return command

"""The noise of sensors, as Gazebo's Gaussian model has it, from a seed.

Source: gazebosim/gz-sensors, src/GaussianNoiseModel.cc; Gazebo Classic's is the same (gazebo,
gazebo/sensors/GaussianNoiseModel.cc).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.live.nodes.simulator.elements import number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.devices import Element

    Floats = NDArray[np.float64]

GAUSSIAN = ("gaussian", "gaussian_quantized")


class Noise:
    """What one channel of a sensor adds to what is true.

    Attributes:
        deviation: The standard deviation of the white noise, in the unit of the channel.
    """

    def __init__(self, element: Element | None, random: np.random.Generator) -> None:
        """Take what a <noise> says; its type is an attribute, or an element in Gazebo Classic.

        Raises:
            CannotWorkError: A number of it is none.
        """
        self._random = random
        self.deviation = self._mean = self._bias = self._precision = 0.0
        self._drift = self._correlation = 0.0
        kind = "none" if element is None else element.attributes.get("type") or element.get("type")
        self.is_there = element is not None and kind in GAUSSIAN
        if element is None or not self.is_there:
            return
        self._mean, self.deviation = number(element, "mean", 0.0), number(element, "stddev", 0.0)
        spread = number(element, "bias_stddev", 0.0)
        self._bias = number(element, "bias_mean", 0.0)
        if spread > 0:
            self._bias = random.normal(self._bias, spread)
        if random.random() < 0.5:  # noqa: PLR2004  as often negative
            self._bias = -self._bias
        self._precision = number(element, "precision", 0.0)
        self._drift = number(element, "dynamic_bias_stddev", 0.0)
        self._correlation = number(element, "dynamic_bias_correlation_time", 0.0)

    @property
    def variance(self) -> float:
        """That of the white noise."""
        return self.deviation**2

    def apply(self, true: Floats, seconds: float = 0.0) -> Floats:
        """What is measured of what is true, any shape, so many seconds after the last time."""
        if not self.is_there:
            return true
        if self._drift > 0 and self._correlation > 0 and seconds > 0:
            share = seconds / self._correlation
            spread = math.sqrt(-(self._drift**2) * self._correlation / 2 * math.expm1(-2 * share))
            self._bias = math.exp(-share) * self._bias + self._random.normal(0.0, spread)
        measured: Floats = true + (self._bias + self._mean)
        if self.deviation > 0:
            measured += self._random.normal(0.0, self.deviation, np.shape(true))
        if self._precision > 0:
            measured = np.round(measured / self._precision) * self._precision
        return measured

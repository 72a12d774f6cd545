"""Draws the samples of distributions: the same ones on every machine, for the same seed.

Each sampler gives points of the unit cube, which the quantile functions of the distributions turn
into values. Values have nine significant digits: mathematical libraries differ in the last bits of
a logarithm, and a table that depends on them would differ between machines.
"""

from __future__ import annotations

import math
import threading
from hashlib import sha256
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.sweep import Design, Distribution, Value
    from wsgen.sweeping.space_filling import SobolPoints

    Points = NDArray[np.float64]  # samples x distributions, each in [0, 1)


BLOCK = 4096  # samples that are drawn together; a power of two, as Sobol' sequences want it
DIGITS = 9  # significant, of a value
_TINY = 2.0**-53  # nearer to 0 or 1, a normal distribution has no finite value


class Samples:
    """The samples of a design by their numbers; threads may share it.

    Of the samplers "random" and "sobol" it holds one block; "lhs" permutes all samples, so their
    points are held: 8 bytes for each value.

    Raises:
        NotFoundError: The sampler needs scipy, which is not installed.
    """

    def __init__(self, design: Design) -> None:
        self._design = design
        self._lock = threading.Lock()
        self._block: tuple[int, Points] | None = None  # its number
        self._all: Points | None = None
        self._sobol: SobolPoints | None = None
        width = len(design.distributions)
        if design.sampler in {"lhs", "sobol"} and width:
            # Only these samplers need scipy.
            from wsgen.sweeping.space_filling import SobolPoints, latin_hypercube  # noqa: PLC0415

            if design.sampler == "lhs":
                self._all = latin_hypercube(width, design.samples, design.seed)
            else:
                self._sobol = SobolPoints(width, design.seed)

    def values(self, number: int) -> dict[str, Value]:
        """The values of one sample, by parameter."""
        point = self._points(number // BLOCK)[number % BLOCK]
        return {
            one.name: quantile(one, float(place))
            for one, place in zip(self._design.distributions, point, strict=True)
        }

    def extremes(self, index: int) -> tuple[float, float]:
        """The least and the greatest place in [0, 1) that a distribution is asked for."""
        low, high = 1.0, 0.0
        for block in range(-(-self._design.samples // BLOCK)):
            rows = min(BLOCK, self._design.samples - block * BLOCK)
            column = self._points(block)[:rows, index]
            low, high = min(low, float(column.min())), max(high, float(column.max()))
        return low, high

    def _points(self, block: int) -> Points:
        if self._all is not None:
            return self._all[block * BLOCK : (block + 1) * BLOCK]
        with self._lock:
            if self._block is None or self._block[0] != block:
                self._block = block, self._draw(block)
            return self._block[1]

    def _draw(self, block: int) -> Points:
        if self._sobol is not None:
            return self._sobol.draw(block * BLOCK, BLOCK)
        columns = [
            _random_points(one.name, self._design.seed, block * BLOCK)
            for one in self._design.distributions
        ]
        return np.stack(columns, axis=1) if columns else np.empty((BLOCK, 0))


def _random_points(name: str, seed: int, start: int) -> Points:
    """A block of uniform random numbers, of a stream of the parameter's own.

    Another parameter beside it, or more samples, leave its values as they are. They are made of the
    raw numbers of the generator, which NumPy promises not to change.
    """
    of_name = int.from_bytes(sha256(name.encode()).digest()[:8], "little")
    generator = np.random.PCG64(np.random.SeedSequence([seed, of_name]))
    generator.advance(start)
    raw = generator.random_raw(BLOCK) >> np.uint64(12)
    points: Points = (raw.astype(np.float64) + 0.5) * 2.0**-52
    return points


def quantile(distribution: Distribution, place: float) -> Value:
    """The value below which a share `place` of the distribution lies."""
    if distribution.kind == "choice":
        choices = distribution.choices
        return choices[min(int(place * len(choices)), len(choices) - 1)]
    first, second = distribution.numbers
    if distribution.kind == "normal":
        return _round(first + second * _STANDARD.inv_cdf(min(max(place, _TINY), 1 - _TINY)))
    if distribution.kind == "uniform":
        value = first + place * (second - first)
    else:
        value = math.exp(math.log(first) + place * (math.log(second) - math.log(first)))
    return min(max(_round(value), first), second)


_STANDARD = NormalDist()


def _round(value: float) -> float:
    return float(f"{value:.{DIGITS - 1}e}")

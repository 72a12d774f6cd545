"""Draws the samples of distributions: the same ones on every machine, for the same seed.

Each sampler gives points of the unit cube, which the quantile functions of the distributions turn
into values. Values have nine significant digits: mathematical libraries differ in the last bits of
a logarithm, and a table that depends on them would differ between machines. Those that fill their
space more evenly than random ones are scipy's.
"""

from __future__ import annotations

import math
import threading
from hashlib import sha256
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from types import ModuleType

    from numpy.typing import NDArray

    from wsgen.model.sweep import Design, Distribution, Value

    Points = NDArray[np.float64]  # samples x distributions, each in [0, 1)


def _qmc() -> ModuleType:
    try:
        from scipy.stats import qmc  # noqa: PLC0415  0.5 s, and it is an extra
    except ImportError as error:
        raise NotFoundError(
            f"scipy, which draws the samples of --sampler lhs and sobol, cannot be used: {error}.",
            hint="Install it: pip install 'wsgen[sweep]'; or use --sampler random.",
        ) from error
    return qmc


def latin_hypercube(width: int, samples: int, seed: int) -> NDArray[np.float64]:
    """A Latin hypercube: in each column every one of `samples` equal intervals has one point.

    Returns:
        samples x width numbers in [0, 1).

    Raises:
        NotFoundError: scipy is not installed.
    """
    generator = np.random.default_rng(seed)
    points: NDArray[np.float64] = _qmc().LatinHypercube(width, rng=generator).random(samples)
    return points


class SobolPoints:
    """A scrambled Sobol' sequence, any part of it.

    Raises:
        NotFoundError: scipy is not installed.
    """

    def __init__(self, width: int, seed: int) -> None:
        self._qmc = _qmc()
        self._width = width
        self._seed = seed
        self._start()

    def _start(self) -> None:
        generator = np.random.default_rng(self._seed)
        self._sequence = self._qmc.Sobol(self._width, scramble=True, rng=generator)
        self._next = 0  # number of the next point

    def draw(self, start: int, count: int) -> NDArray[np.float64]:
        """Points from a number on: count x width numbers in [0, 1).

        `count` is a power of two, and `start` a multiple of it; scipy warns otherwise.
        """
        if start < self._next:
            self._start()
        if start > self._next:
            self._sequence.fast_forward(start - self._next)
        points: NDArray[np.float64] = self._sequence.random(count)
        self._next = start + count
        return points


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
            from wsgen.sweeping.samples import SobolPoints, latin_hypercube  # noqa: PLC0415

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

"""Samples that fill their space more evenly than random ones: the one place that imports scipy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from types import ModuleType

    from numpy.typing import NDArray


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

"""All variants of a design, computed when they are asked for: a sweep may have millions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.model.sweep import MOST_VARIANTS, Variant

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.sweep import Design


class Variants:
    """The variants of a design: each point of the grid with each sample.

    The first axis varies slowest, the samples fastest. The same design has the same variants on
    every machine, in any order that they are asked for; threads may share them.

    Raises:
        RequestError: The design varies nothing, or has more than ten million variants.
        NotFoundError: The sampler needs scipy, which is not installed.
    """

    def __init__(self, design: Design) -> None:
        if not design.names:
            raise RequestError(
                "Nothing varies.",
                hint="Write for example: --over world.friction=0.1:1:10, or "
                "--random 'robot.mass_scale=uniform(0.8, 1.2)' --samples 100",
            )
        self.design = design
        self.samples = design.samples if design.distributions else 1
        self.count = self.samples * math.prod(len(axis.values) for axis in design.axes)
        if self.count > MOST_VARIANTS:
            shape = [f"{len(axis.values):,} of {axis.name}" for axis in design.axes]
            shape += [f"{self.samples:,} samples"] if design.distributions else []
            raise RequestError(
                f"The sweep has {self.count:,} variants ({' x '.join(shape)}); the limit is "
                f"{MOST_VARIANTS:,}.",
                hint="Give fewer values, or draw samples instead of a grid: --random "
                "'NAME=uniform(a, b)' --samples N.",
            )
        self._samples = None
        if design.distributions:
            # A grid needs no NumPy.
            from wsgen.sweeping.samples import Samples  # noqa: PLC0415

            self._samples = Samples(design)

    @property
    def hint(self) -> str | None:
        """What the user should know about the samples."""
        samples = self.samples
        if self.design.sampler != "sobol" or samples & (samples - 1) == 0:
            return None
        low = 1 << (samples.bit_length() - 1)
        return (
            f"Sobol' samples fill their space evenly if their number is a power of two; {samples} "
            f"is not a power of two. Give --samples {low} or {2 * low}."
        )

    def variant(self, number: int) -> Variant:
        """The variant of a number from 0.

        Raises:
            IndexError: The design has no such variant.
        """
        if not 0 <= number < self.count:
            raise IndexError(number)
        point, sample = divmod(number, self.samples)
        places = []
        for axis in reversed(self.design.axes):
            point, place = divmod(point, len(axis.values))
            places.append(place)
        values = {
            axis.name: axis.values[place]
            for axis, place in zip(self.design.axes, reversed(places), strict=True)
        }
        if self._samples is not None:
            values |= self._samples.values(sample)
        return Variant(number=number, values=values)

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[Variant]:
        return map(self.variant, range(self.count))

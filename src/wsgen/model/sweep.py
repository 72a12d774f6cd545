"""What a sweep varies, and what it measured: values without I/O. SI units."""

from __future__ import annotations

from collections.abc import Collection, Mapping  # noqa: TC003  type hints of answers are read
from dataclasses import field

from wsgen.text.values import dataclass

Value = str | int | float | bool  # of a parameter
Figure = float | int | bool | str | None  # of a row; None where it was not measured

SAMPLERS = ("random", "lhs", "sobol")
MOST_VARIANTS = 10_000_000  # a year on a core, of runs of 3 s
LEAST_INTEGER, MOST_INTEGER = -(2**63), 2**63 - 1  # of what a column of integers has
MOST_SEED = MOST_INTEGER
SHORTEST_RUN, LONGEST_RUN = 0.1, 600.0  # s, simulated


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A parameter with the values that it takes, in their order: one axis of the grid."""

    name: str
    values: tuple[Value, ...]


@dataclass(frozen=True, kw_only=True)
class Distribution:
    """A parameter whose values are drawn."""

    name: str
    kind: str  # "uniform", "normal", "loguniform" or "choice"
    numbers: tuple[float, ...] = ()  # low and high; of "normal" the mean and the deviation
    choices: tuple[Value, ...] = ()  # of "choice"


@dataclass(frozen=True, kw_only=True)
class Design:
    """All variants of a sweep: each point of the grid with each sample."""

    axes: tuple[Axis, ...] = ()
    distributions: tuple[Distribution, ...] = ()
    samples: int = 1  # of the distributions; 1 without any
    sampler: str = "random"  # one of SAMPLERS
    seed: int = 0

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in the order of the table's columns."""
        axes = (axis.name for axis in self.axes)
        return (*axes, *(distribution.name for distribution in self.distributions))


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One run of a sweep."""

    number: int  # from 0, in the order of the table's rows
    values: Mapping[str, Value]  # by parameter


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of the table."""

    name: str
    kind: str  # "number", "integer", "boolean" or "text"
    meaning: str = ""  # with its unit
    is_parameter: bool = False


@dataclass(frozen=True, kw_only=True)
class Row:
    """What is known of one variant.

    Nothing in it depends on the machine, on the number of jobs or on chance: the same sweep gives
    the same rows.
    """

    number: int  # of the variant
    passed: bool
    codes: tuple[str, ...] = ()  # of the errors and warnings that are reported, sorted
    diagnostic: str | None = None  # the first error, with its code
    figures: Mapping[str, Figure] = field(default_factory=dict)  # by column; others are None


def free_name(name: str, taken: Collection[str], prefix: str, before: str = "") -> str:
    """The name after `before`, with as many prefixes as it needs not to be taken."""
    while f"{before}{name}" in taken:
        name = f"{prefix}{name}"
    return f"{before}{name}"

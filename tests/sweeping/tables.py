"""Tables in memory, of which the answer is known."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wsgen.model.sweep import Column
from wsgen.sweeping.table import Series, TableData

SLOPE = Column(name="world.slope", kind="number", meaning="rad, of the ground", is_parameter=True)
MASS = Column(name="arm_mass", kind="number", meaning="kg", is_parameter=True)
FRICTION = Column(name="world.friction", kind="number", meaning="of the ground", is_parameter=True)
WHEELS = Column(name="wheels", kind="integer", is_parameter=True)
SURFACE = Column(name="surface", kind="text", is_parameter=True)
SEALED = Column(name="sealed", kind="boolean", is_parameter=True)
TILT = Column(name="tilt", kind="number", meaning="rad, at the end")
DRIFT = Column(name="drift", kind="number", meaning="m, horizontally")

# Rules: SPN059 tips-over, SPN056 falls-without-end and SPN085 position-not-reached are errors,
# SPN062 joint-beyond-limit is a warning.
CODES = ((), ("SPN059", "SPN062"), ("SPN056",), ("SPN059", "SPN085"))
DIAGNOSTICS = ("", "SPN059: the robot `rover` tips over", "SPN056: it falls", "SPN085: too far")


def make_series(column: Column, values: Sequence[Any]) -> Series:
    texts: tuple[str, ...] = ()
    if column.kind == "text":
        texts = tuple(dict.fromkeys(values))
        values = [texts.index(value) for value in values]
    return Series(column=column, numbers=np.array(values, dtype=np.float64), texts=texts)


def make_table(
    values: Mapping[Column, Any],
    passed: Any,
    *,
    runs: int | None = None,
    code_set: Any = None,
    code_sets: tuple[tuple[str, ...], ...] = CODES,
) -> TableData:
    """A table; what fails has one of `code_sets` after the other where it is not said."""
    passed = np.asarray(passed, dtype=np.bool_)
    count = len(passed)
    if code_set is None:
        code_set = np.where(passed, 0, 1 + np.arange(count) % (len(code_sets) - 1))
    series = [make_series(column, one) for column, one in values.items()]
    return TableData(
        runs=count if runs is None else runs,
        numbers=np.arange(count),
        passed=passed,
        parameters=tuple(one for one in series if one.column.is_parameter),
        figures=tuple(one for one in series if not one.column.is_parameter),
        code_sets=code_sets,
        code_set=np.asarray(code_set, dtype=np.int64),
        diagnostics=(*DIAGNOSTICS, *[""] * len(code_sets))[: len(code_sets)],
    )

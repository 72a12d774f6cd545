"""The columns of a table as arrays, for its summary and its plots.

The table is read once, from its beginning to its end; of each number 8 bytes are in memory, of each
text 4. The diagnostics are not: of each set of codes only the first one is.
"""

from __future__ import annotations

import csv
import json
from array import array
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.errors import NotReadableError
from wsgen.sweeping.journal import read_known
from wsgen.sweeping.table import (
    CODES,
    DIAGNOSTIC,
    PASSED,
    RUN,
    full_columns,
    headings,
    read_parquet,
)
from wsgen.text.files import refuse_irregular
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.model.sweep import Column

MISSING = float("nan")


@dataclass(frozen=True, kw_only=True)
class Series:
    """A column of the table."""

    column: Column
    numbers: NDArray[np.float64]  # NaN: not measured; false and true: 0 and 1; of a text its index
    texts: tuple[str, ...] = ()  # of a column of texts: those that it has, in order of appearance


@dataclass(frozen=True, kw_only=True)
class TableData:
    """A table; all arrays are in the order of the run numbers."""

    runs: int  # of the whole sweep; more than there are rows where it was interrupted
    numbers: NDArray[np.int64]  # of the runs
    passed: NDArray[np.bool_]
    parameters: tuple[Series, ...]
    figures: tuple[Series, ...]
    code_sets: tuple[tuple[str, ...], ...]  # those that occur, in order of appearance
    code_set: NDArray[np.int64]  # of each run, its index
    diagnostics: tuple[str, ...]  # the first one of each set of codes; "": none

    @property
    def count(self) -> int:
        """How many rows the table has."""
        return len(self.numbers)


def read_table(file: Path) -> TableData:
    """Read a table that `open_table` wrote.

    Raises:
        NotReadableError: The file or its journal is missing or broken.
        NotFoundError: It needs pyarrow, which is not installed.
    """
    try:
        known = read_known(file)
        if known is None:
            raise NotReadableError(
                f"Cannot read {file}: it is not a table of wsgen sweep, or the file "
                f"{file.name}.sweep beside it is missing.",
                hint="Run the sweep again with another file for --out.",
            )
        return _collect(file, known.columns, known.header.runs)
    except OSError as error:
        raise NotReadableError(
            f"Cannot read {file}: {(error.strerror or str(error)).lower()}.",
            hint="Run the sweep again.",
        ) from error
    except (ValueError, KeyError, csv.Error) as error:
        raise NotReadableError(
            f"Cannot read {file}: its content is not what wsgen sweep wrote ({error}).",
            hint=f"Remove {file.name}, and run the sweep again.",
        ) from error


class _Texts:
    """Texts of a column, each kept once."""

    def __init__(self) -> None:
        self.known: dict[str, int] = {}

    def number(self, text: str) -> int:
        return self.known.setdefault(text, len(self.known))


def _collect(file: Path, given: Sequence[Column], runs: int) -> TableData:
    columns = full_columns(given)
    names = headings(columns)
    series = [(name, one) for name, one in zip(names, columns, strict=True) if one in given]
    numbers = {name: array("d") for name, _ in series}
    texts = {name: _Texts() for name, one in series if one.kind == "text"}
    run, passed, code_set = array("q"), array("b"), array("q")
    code_sets = _Texts()
    diagnostics: list[str] = []
    kinds = {name: one.kind for name, one in zip(names, columns, strict=True)}
    for part in _PARTS[file.suffix.lower()](file, kinds):
        run.extend(part[RUN.name])
        passed.extend(part[PASSED.name])
        for codes, diagnostic in zip(part[CODES.name], part[DIAGNOSTIC.name], strict=True):
            index = code_sets.number(codes)
            code_set.append(index)
            if index == len(diagnostics):
                diagnostics.append(diagnostic)
        for name, _ in series:
            values = part[name]
            if name in texts:
                numbers[name].extend(map(texts[name].number, values))
            else:
                numbers[name].extend(MISSING if value is None else value for value in values)
    made = [
        Series(
            column=one,
            numbers=np.array(numbers[name], dtype=np.float64),
            texts=(*texts[name].known,) if name in texts else (),
        )
        for name, one in series
    ]
    return TableData(
        runs=runs,
        numbers=np.array(run, dtype=np.int64),
        passed=np.array(passed, dtype=np.bool_),
        parameters=tuple(one for one in made if one.column.is_parameter),
        figures=tuple(one for one in made if not one.column.is_parameter),
        code_sets=tuple(tuple(codes.split()) for codes in code_sets.known),
        code_set=np.array(code_set, dtype=np.int64),
        diagnostics=tuple(diagnostics),
    )


def _parquet(file: Path, kinds: Mapping[str, str]) -> Iterator[Mapping[str, Sequence[Any]]]:
    return read_parquet(file, [*kinds])


def _jsonl(file: Path, kinds: Mapping[str, str]) -> Iterator[Mapping[str, Sequence[Any]]]:
    refuse_irregular(file)
    with file.open("rb") as stream:
        for line in stream:
            row = json.loads(line)
            yield {name: (row[name],) for name in kinds}


_READ: Mapping[str, Callable[[str], Any]] = {
    "number": float,
    "integer": int,
    "boolean": {"true": True, "false": False}.__getitem__,
}


def _csv(file: Path, kinds: Mapping[str, str]) -> Iterator[Mapping[str, Sequence[Any]]]:
    refuse_irregular(file)
    with file.open(encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            yield {name: (_read_field(row[name], kind),) for name, kind in kinds.items()}


def _read_field(text: str, kind: str) -> Any:
    if kind == "text":
        return text
    return _READ[kind](text) if text else None


_PARTS = {".parquet": _parquet, ".csv": _csv, ".jsonl": _jsonl}

"""The table of a sweep: one row a run, as CSV, lines of JSON or Parquet.

Rows come in any order, and the process may be killed at any moment: what is done is in the journal
beside the table (`sweeping/journal.py`), from which the table is written at the end, and at an
interruption, in the order of the run numbers. So the same sweep gives the same bytes, however often
it was interrupted.

A number that was not measured is missing (an empty field, `null`), and so is one that is infinite
or not a number. A text is never missing but empty: a column of texts has one type in every reader.
What is written as Parquet depends on the rows and on the version of pyarrow, and on nothing else:
it has no times, and row groups of one size.

For its summary and its plots, a table is read once, from its beginning to its end; of each number
8 bytes are in memory, of each text 4.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
from array import array
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.model.sweep import LEAST_INTEGER, MOST_INTEGER, Column, free_name
from wsgen.sweeping.journal import Header, Journal, Known, read_known
from wsgen.text.files import explain_write_error, irregular_kind, refuse_irregular, replace_file
from wsgen.text.printable import clean
from wsgen.text.suggestions import nearest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from numpy.typing import NDArray

    from wsgen.model.sweep import Row, Variant


__all__ = ["FORMATS", "Header", "TableWriter", "full_columns", "headings", "open_table"]

RUN = Column(name="run", kind="integer", meaning="number of the run, from 0")
PASSED = Column(name="passed", kind="boolean", meaning="the run reported no error")
CODES = Column(name="codes", kind="text", meaning="codes of errors and warnings")
DIAGNOSTIC = Column(name="diagnostic", kind="text", meaning="the first error")
PARAMETER_PREFIX = "parameter."  # of a parameter that has the name of another column
_to_json = json.JSONEncoder(ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode
# What no reader of tables takes: a null byte, and what UTF-8 cannot have.
_UNWRITABLE = {0: "\u2400", **dict.fromkeys(range(0xD800, 0xE000), "\ufffd")}


def full_columns(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Return the columns of the table: the number, the parameters, the result and the figures."""
    parameters = [one for one in columns if one.is_parameter]
    figures = [one for one in columns if not one.is_parameter]
    return (RUN, *parameters, PASSED, CODES, *figures, DIAGNOSTIC)


def headings(columns: Sequence[Column]) -> tuple[str, ...]:
    """Return the headings of the columns of a table, which differ.

    A parameter of a user may have the name of another column: it gets a prefix, and one more where
    another parameter has that name.
    """
    others = {one.name for one in columns if not one.is_parameter}
    taken = {one.name for one in columns}
    found = []
    for one in columns:
        heading = one.name
        if one.is_parameter and heading in others:
            heading = free_name(heading, taken, PARAMETER_PREFIX)
            taken.add(heading)
        found.append(heading)
    return tuple(found)


def open_table(file: Path, columns: Sequence[Column], header: Header) -> TableWriter:
    """Open the table of a sweep, new or where it stopped.

    Args:
        file: Its suffix is one of `FORMATS`.
        columns: The parameters and the figures; the other columns are added (`full_columns`).
        header: What the results depend on.

    Raises:
        RequestError: The suffix is unknown, or another process writes this table.
        WouldOverwriteError: The file is not ours, was changed, or belongs to other inputs.
        NotFoundError: The format needs pyarrow, which is not installed.
        NotReadableError: It cannot be written.
    """
    check_format(file)
    kind = irregular_kind(file)
    if kind is not None:
        raise RequestError(
            f"Cannot write the table to {file}: it is {kind}.",
            hint="Choose the name of a file with --out.",
        )
    return TableWriter(file, Known(header=header, columns=tuple(columns)))


def check_format(file: Path) -> None:
    """Check that a table with this suffix can be written.

    Raises:
        RequestError: It is unknown.
        NotFoundError: It needs pyarrow, which is not installed.
    """
    suffix = file.suffix.lower()
    if suffix not in FORMATS:
        meant = nearest(suffix, FORMATS) if suffix else None
        known = "Parquet (.parquet), CSV (.csv) or lines of JSON (.jsonl)"
        raise RequestError(
            f"Cannot write a table as {file.name}: "
            + (f"the format {suffix} is unknown." if suffix else "its name has no suffix."),
            hint=f"Use {file.stem}{meant}: wsgen writes {known}."
            if meant
            else f"Choose a name with the suffix of a format: {known}.",
        )
    if suffix == ".parquet":
        require_pyarrow()


class TableWriter:
    """The table while runs end; a context manager, which writes it in any case."""

    def __init__(self, file: Path, known: Known) -> None:
        self.file = file
        self.known = known
        self._columns = full_columns(known.columns)
        self._headings = headings(self._columns)
        self._parameters = [one for one in self._columns if one.is_parameter]
        self._measured = [one for one in known.columns if not one.is_parameter]
        self._figures = frozenset(one.name for one in self._measured)
        self._write_table = FORMATS[file.suffix.lower()]
        self._journal = Journal(file, known)
        self.was_complete = self._journal.is_complete  # before this command

    @property
    def count(self) -> int:
        """How many runs are done, in this command and before."""
        return self.runs if self._journal.is_complete else self._journal.count

    @property
    def runs(self) -> int:
        """How many runs the whole sweep has."""
        return self.known.header.runs

    @property
    def is_complete(self) -> bool:
        """Whether every run is done."""
        return self.count == self.runs

    def __contains__(self, number: int) -> bool:
        """Whether the run with this number is done."""
        return number in self._journal

    def write(self, variant: Variant, row: Row) -> None:
        """Add a row; one that is there already is left out.

        Raises:
            NotReadableError: It cannot be written; the rows before it are kept.
        """
        if row.number in self._journal:
            return
        unknown = row.figures.keys() - self._figures
        if unknown:
            raise ValueError(f"a row has figures without a column: {', '.join(sorted(unknown))}")
        values = [
            row.number,
            *(_stored(one, variant.values[one.name]) for one in self._parameters),
            row.passed,
            " ".join(row.codes),
            *(_stored(one, row.figures.get(one.name)) for one in self._measured),
            clean(row.diagnostic or ""),
        ]
        line = _to_json(dict(zip(self._headings, values, strict=True)))
        self._journal.append(row.number, line.encode() + b"\n")

    def close(self) -> None:
        """Write the table with all rows that are done, and the journal as it then is.

        Raises:
            NotReadableError: It cannot be written; the journal has the rows.
        """
        try:
            if self._journal.is_complete:
                return
            if not self._journal.count and not self._journal.tables:
                self._journal.remove()  # nothing to go on with
                return
            digest = self._replace_table()
            if self.is_complete:
                self._journal.finish(digest)
        finally:
            self._journal.close()

    def _replace_table(self) -> str:
        """Write the table; gives its hash, which the journal has before the table is there."""
        try:
            with replace_file(self.file.resolve()) as stream:
                hashed = _Hashed(stream)
                self._write_table(hashed, self._columns, self._headings, self._journal.rows())  # type: ignore[arg-type]
                digest = hashed.digest.hexdigest()
                self._journal.add_table(digest)
        except OSError as error:
            raise explain_write_error(error, self.file) from error
        return digest

    def __enter__(self) -> TableWriter:  # noqa: PYI034  Python 3.10 has no Self
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        try:
            self.close()
        except Exception:
            if error is None:  # else what ended the sweep is what the user reads
                raise


class _Hashed:
    """A file that is written, with the hash of what was written."""

    closed = False

    def __init__(self, stream: BinaryIO) -> None:
        self.digest = hashlib.sha256()
        self._stream = stream

    def write(self, data: bytes) -> int:
        self.digest.update(data)
        return self._stream.write(data)

    def writelines(self, lines: Iterable[bytes]) -> None:
        for line in lines:
            self.write(line)

    def tell(self) -> int:
        return self._stream.tell()

    def flush(self) -> None:
        self._stream.flush()

    def writable(self) -> bool:
        return True

    def readable(self) -> bool:
        return False

    def seekable(self) -> bool:
        return False


def _stored(column: Column, value: Any) -> Any:
    """Return a value as every format has it."""
    if column.kind == "text":
        return "" if value is None else _text(value)
    if value is None:
        return None
    if column.kind == "number":
        number = float(value)
        return number if math.isfinite(number) else None
    if column.kind == "boolean":
        return bool(value)
    integer = int(value)
    if not LEAST_INTEGER <= integer <= MOST_INTEGER:
        raise RequestError(
            f"`{column.name}` is {value}, which does not fit the 64 bits of a column of integers.",
            hint="Write it as a number with a point.",
        )
    return integer


def _text(value: Any) -> str:
    text = ("true" if value else "false") if isinstance(value, bool) else str(value)
    return text.translate(_UNWRITABLE)


def _write_jsonl(
    stream: BinaryIO, _columns: Sequence[Column], _headings: Sequence[str], lines: Iterable[bytes]
) -> None:
    stream.writelines(lines)


def _write_csv(
    stream: BinaryIO, _columns: Sequence[Column], headings: Sequence[str], lines: Iterable[bytes]
) -> None:
    stream.write((",".join(_field(heading) for heading in headings) + "\n").encode())
    stream.writelines(
        (",".join(map(_field, json.loads(line).values())) + "\n").encode() for line in lines
    )


def _field(value: Any) -> str:
    """A field of RFC 4180; `true` and `false` are what both pandas and polars read as booleans."""
    if value is None:
        return ""
    if isinstance(value, str):
        is_plain = value and value.strip() == value and not any(sign in value for sign in ',"\r\n')
        return value if is_plain else '"' + value.replace('"', '""') + '"'
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value)


def _write_parquet(
    stream: BinaryIO, columns: Sequence[Column], headings: Sequence[str], lines: Iterable[bytes]
) -> None:
    write_parquet(
        stream,
        {heading: one.kind for heading, one in zip(headings, columns, strict=True)},
        {heading: one.meaning for heading, one in zip(headings, columns, strict=True)},
        ([*json.loads(line).values()] for line in lines),
    )


FORMATS: Mapping[
    str, Callable[[BinaryIO, Sequence[Column], Sequence[str], Iterable[bytes]], None]
] = {".parquet": _write_parquet, ".csv": _write_csv, ".jsonl": _write_jsonl}


ROW_GROUP = 10_000  # rows
TYPES = {"number": "float64", "integer": "int64", "boolean": "bool_", "text": "string"}


def require_pyarrow() -> None:
    """Check that it is installed.

    Raises:
        NotFoundError: It is not; the hint says how to install it.
    """
    _library()


def _library() -> Any:
    try:
        import pyarrow  # noqa: ICN001, PLC0415  an extra, and 60 ms
        import pyarrow.parquet  # noqa: PLC0415
    except ImportError:
        raise NotFoundError(
            "pyarrow, which writes Parquet files, is not installed.",
            hint="Install it: pip install 'wsgen[sweep]', or choose a table in .csv or .jsonl.",
        ) from None
    return pyarrow


def write_parquet(
    stream: BinaryIO,
    kinds: Mapping[str, str],
    meanings: Mapping[str, str],
    rows: Iterator[Sequence[Any]],
) -> None:
    """Write rows as they come, `ROW_GROUP` of them in memory.

    Args:
        stream: Where to.
        kinds: "number", "integer", "boolean" or "text", by the heading of the column.
        meanings: With units, by heading; readers show them as the metadata of a field.
        rows: Of each the values in the order of the columns; None where there is none.
    """
    library = _library()
    schema = library.schema(
        [
            library.field(
                heading,
                getattr(library, TYPES[kind])(),
                metadata={"meaning": meanings[heading]} if meanings.get(heading) else None,
            )
            for heading, kind in kinds.items()
        ]
    )
    with library.parquet.ParquetWriter(stream, schema, version="2.6", compression="zstd") as file:
        columns: list[list[Any]] = [[] for _ in kinds]

        def write_group() -> None:
            arrays = [
                library.array(values, type=field.type)
                for values, field in zip(columns, schema, strict=True)
            ]
            file.write_table(library.Table.from_arrays(arrays, schema=schema), ROW_GROUP)
            for values in columns:
                values.clear()

        for row in rows:
            for values, value in zip(columns, row, strict=True):
                values.append(value)
            if len(columns[0]) == ROW_GROUP:
                write_group()
        if columns[0]:
            write_group()


def read_parquet(file: Path, headings: Sequence[str]) -> Iterator[Mapping[str, list[Any]]]:
    """Yield the columns of some thousand rows after the other.

    Raises:
        NotReadableError: it is no Parquet file, or lacks a column.
    """
    library = _library()
    try:
        with library.parquet.ParquetFile(file) as table:
            for batch in table.iter_batches(ROW_GROUP, columns=[*headings]):
                yield {name: batch.column(name).to_pylist() for name in headings}
    except (library.ArrowException, KeyError) as error:
        raise NotReadableError(
            f"Cannot read {file}: {error}.", hint="Remove it, and run the sweep again."
        ) from error


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

"""Parquet files: the one place that imports pyarrow.

What is written depends on the rows and on the version of pyarrow, and on nothing else: it has no
times, and row groups of one size.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO

from wsgen.errors import NotFoundError, NotReadableError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path


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

"""The journal of a sweep: each row as it ends, so that a killed sweep goes on where it stopped.

It stands beside the table (`results.csv.sweep`) and is text: the first line says what is swept, any
other line is a row as JSON, in the order in which the runs end (`tail -f` shows them). A line is
appended by one call of the system; whatever kills the process, at most the last line is cut, and a
cut line is dropped. Once the table is complete, only the first line and a last one are left.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
from array import array
from typing import TYPE_CHECKING, BinaryIO

from wsgen.errors import RequestError, WouldOverwriteError
from wsgen.model.sweep import Column
from wsgen.text.files import explain_write_error, refuse_irregular, replace_file
from wsgen.text.values import dataclass

try:
    import fcntl
except ImportError:  # Windows; there two processes are not kept apart
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path


SUFFIX = ".sweep"
FORMAT = 1  # of the journal
MAGIC = b'{"wsgen sweep":'
ROW = b'{"run":'  # what a row begins with
FLUSH_EVERY = 5.0  # s, wall-clock, after which rows are on the disk even if the power is cut
PATIENCE = 2.0  # s, wall-clock, to wait for workers of a killed process to end
LONGEST_SHOWN = 60  # characters of what differs


@dataclass(frozen=True, kw_only=True)
class Header:
    """What a table is about: two sweeps with equal headers have equal tables."""

    runs: int  # of the whole sweep
    # What the results depend on, by the words for it in a message ("robot", "seconds"): a value
    # that a person can compare, or a hash.
    inputs: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class Known:
    """The first line of a journal."""

    header: Header
    columns: tuple[Column, ...]  # parameters and figures


def journal_of(table: Path) -> Path:
    """Return the journal of a table; of a link, that of the file which it leads to."""
    return table.resolve().with_name(f"{table.resolve().name}{SUFFIX}")


def write_line(known: Known) -> bytes:
    """Write the first line of a journal."""
    value = {
        "wsgen sweep": FORMAT,
        "runs": known.header.runs,
        "inputs": dict(known.header.inputs),
        "columns": [[one.name, one.kind, one.meaning, one.is_parameter] for one in known.columns],
    }
    return (json.dumps(value, separators=(",", ":")) + "\n").encode()


def read_line(line: bytes) -> Known | None:
    """Read the first line of a journal; None where it is not one that this version can read."""
    try:
        value = json.loads(line)
        if value["wsgen sweep"] != FORMAT:
            return None
        columns = tuple(
            Column(name=name, kind=kind, meaning=meaning, is_parameter=is_parameter)
            for name, kind, meaning, is_parameter in value["columns"]
        )
        inputs = {str(name): str(text) for name, text in value["inputs"].items()}
        return Known(header=Header(runs=int(value["runs"]), inputs=inputs), columns=columns)
    except (ValueError, TypeError, KeyError, AttributeError):
        return None


def read_known(table: Path) -> Known | None:
    """Read what a table is about from its journal; None where it has none.

    Raises:
        OSError: it cannot be read.
    """
    try:
        refuse_irregular(journal_of(table))
        with journal_of(table).open("rb") as stream:
            return read_line(stream.readline())
    except FileNotFoundError:
        return None


class Journal:
    """An open journal, which no other process has open.

    Of each row only the place in the file is in memory: 8 bytes a run.
    """

    def __init__(self, table: Path, known: Known) -> None:
        self.table = table
        self.file = journal_of(table)
        self.known = known
        self.count = 0  # rows
        self.is_complete = False  # and has no rows any more: they are in the table
        self.tables: set[str] = set()  # hashes of tables that were written
        self._places = array("q", [-1]) * known.header.runs  # bytes; -1: not done
        self._end = 0  # bytes; behind the last whole line
        self._flushed_at = time.monotonic()
        self._descriptor = self._open()
        try:
            self._read()
        except BaseException:
            self.close()
            raise

    def __contains__(self, number: int) -> bool:
        return self.is_complete or self._places[number] >= 0

    def append(self, number: int, line: bytes) -> None:
        """Add the row of a run; `line` begins with `ROW` and ends with a line feed.

        Raises:
            NotReadableError: it cannot be written; the journal is as it was.
        """
        self._places[number] = self._write(line)
        self.count += 1

    def rows(self) -> Iterator[bytes]:
        """Yield the lines of all rows that are done, in the order of their numbers.

        Raises:
            OSError: the journal cannot be read.
        """
        with self.file.open("rb") as stream:
            for place in self._places:
                if place >= 0:
                    stream.seek(place)
                    yield stream.readline()

    def add_table(self, digest: str) -> None:
        """Say that a table with this hash is about to be written."""
        if digest not in self.tables:
            self._write(json.dumps({"table": digest}).encode() + b"\n")
            self.tables.add(digest)

    def finish(self, digest: str) -> None:
        """Drop the rows, which the table with this hash has."""
        last = json.dumps({"table": digest, "complete": True}).encode() + b"\n"
        try:
            with replace_file(self.file) as stream:
                stream.write(write_line(self.known) + last)
                if fcntl is None:
                    self.close()  # Windows replaces no open file
        except OSError as error:
            raise explain_write_error(error, self.file) from error
        self.is_complete = True

    def remove(self) -> None:
        """Remove a journal without rows."""
        with contextlib.suppress(OSError):
            self.file.unlink()
        self.close()

    def close(self) -> None:
        """Let other processes have it."""
        descriptor, self._descriptor = self._descriptor, -1
        if descriptor >= 0:
            os.close(descriptor)

    def _open(self) -> int:
        """Open and lock the file; it is made if it does not exist."""
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
        while True:
            try:
                refuse_irregular(self.file)
                descriptor = os.open(self.file, flags, 0o666)
            except OSError as error:
                raise explain_write_error(error, self.file) from error
            try:
                self._lock(descriptor)
                here = os.fstat(descriptor)
                with contextlib.suppress(FileNotFoundError):
                    # Another process may have replaced it since it was opened.
                    if os.path.samestat(here, self.file.stat()):
                        return descriptor
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)

    def _lock(self, descriptor: int) -> None:
        if fcntl is None:
            return
        until = time.monotonic() + PATIENCE
        while True:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:  # noqa: PERF203
                if time.monotonic() > until:
                    raise RequestError(
                        f"Another wsgen process is writing {self.table}.",
                        hint="Wait until it ends, or choose another file with --out.",
                    ) from None
                time.sleep(0.05)
            except OSError:
                return  # the file system has no locks
            else:
                return

    def _read(self) -> None:
        """Find out what is done, or begin a new journal."""
        with self.file.open("rb") as stream:
            first = stream.readline()
            table_exists = os.path.lexists(self.table)
            if not first.endswith(b"\n") and (first[: len(MAGIC)] == MAGIC[: len(first)]):
                # It is new, or the process was killed while it wrote the first line.
                if table_exists:
                    if not first:
                        self.file.unlink()
                    self._refuse_foreign()
                self._begin()
                return
            there = read_line(first)
            if there is None:
                raise WouldOverwriteError(
                    f"{self.file} exists and is not a journal of this version of wsgen sweep.",
                    hint=f"Choose another file with --out, or remove {self.table.name} and "
                    f"{self.file.name}.",
                )
            self._end = len(first)
            has_rows = self._index(stream)
        if not table_exists and not has_rows:
            self._begin()  # the user removed the table, or no run ended
            return
        self._compare(there)
        if table_exists and hash_file(self.table) not in self.tables:
            raise WouldOverwriteError(
                f"{self.table} is not the table that this sweep wrote: it was changed or replaced.",
                hint="Choose another file with --out, or move the file away to have it written "
                "again.",
            )

    def _index(self, stream: BinaryIO) -> bool:
        """Find the rows; says whether the file has any, those of another sweep included."""
        has_rows = False
        for line in stream:
            place, self._end = self._end, self._end + len(line)
            if not line.endswith(b"\n"):
                self._end = place  # it is cut, and written over
                break
            try:
                value = json.loads(line)
                if line.startswith(ROW):
                    has_rows = True
                    number = value["run"]
                    if self._places[number] < 0:
                        self._places[number] = place
                        self.count += 1
                else:
                    self.tables.add(value["table"])
                    self.is_complete = value.get("complete", False)
            except (ValueError, TypeError, KeyError, IndexError):
                continue  # a disk may lose what was not flushed; that run is done again
        return has_rows

    def _begin(self) -> None:
        os.ftruncate(self._descriptor, 0)
        self._end = self.count = 0
        self.is_complete = False
        self.tables.clear()
        self._places = array("q", [-1]) * self.known.header.runs
        self._write(write_line(self.known))

    def _refuse_foreign(self) -> None:
        raise WouldOverwriteError(
            f"{self.table} exists, and wsgen sweep did not write it: it has no {self.file.name} "
            "beside it.",
            hint="Choose another file with --out, or move that file away.",
        )

    def _compare(self, there: Known) -> None:
        different = [*_differences(there, self.known)]
        if different:
            raise WouldOverwriteError(
                f"{self.table} belongs to a sweep with other inputs: {'; '.join(different)}.",
                hint=f"Choose another file with --out, or remove {self.table.name} and "
                f"{self.file.name} to start again.",
            )

    def _write(self, line: bytes) -> int:
        """Append a line; gives where it begins."""
        place = self._end
        try:
            if os.lseek(self._descriptor, 0, os.SEEK_END) != place:
                os.ftruncate(self._descriptor, place)  # what an interruption left
            left = line
            while left:
                left = left[os.write(self._descriptor, left) :]
            if time.monotonic() - self._flushed_at > FLUSH_EVERY:
                os.fsync(self._descriptor)
                self._flushed_at = time.monotonic()
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._descriptor, place)
            raise explain_write_error(error, self.file) from error
        self._end = place + len(line)
        return place


def hash_file(file: Path) -> str:
    """Hash the content of a file, which is read in parts."""
    digest = hashlib.sha256()
    try:
        with file.open("rb") as stream:
            while part := stream.read(1 << 20):
                digest.update(part)
    except OSError as error:
        raise WouldOverwriteError(
            f"{file} exists and cannot be read: {error.strerror}.",
            hint="Choose another file with --out.",
        ) from error
    return digest.hexdigest()


def _differences(there: Known, here: Known) -> Iterator[str]:
    """Say what differs, with both values where a person can compare them."""
    old, new = there.header.inputs, here.header.inputs
    for name in dict.fromkeys((*old, *new)):
        before, now = old.get(name), new.get(name)
        if before != now:
            yield name + _shown(before, now)
    if there.header.runs != here.header.runs:
        yield f"the number of runs ({there.header.runs} there, {here.header.runs} here)"
    elif _without_meaning(there.columns) != _without_meaning(here.columns):
        yield "the columns"


def _shown(before: str | None, now: str | None) -> str:
    texts = [text for text in (before, now) if text is not None]
    if any(len(text) > LONGEST_SHOWN for text in texts):
        return ""
    return f" ({before or 'none'} there, {now or 'none'} here)"


def _without_meaning(columns: tuple[Column, ...]) -> list[tuple[str, str, bool]]:
    return [(one.name, one.kind, one.is_parameter) for one in columns]

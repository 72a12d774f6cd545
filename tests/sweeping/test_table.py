"""The table of a sweep: its formats, and what interruptions leave of it."""

import builtins
import errno
import json
import math
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from sweeping.row_writer import COLUMNS, SURFACES, header, open_sweep, row, variant
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WouldOverwriteError
from wsgen.model.sweep import Column, Row, Variant
from wsgen.sweeping import journal, table
from wsgen.sweeping.table import FORMATS, full_columns, headings, open_table, read_table

SUFFIXES = [*FORMATS]
RUNS = 24
NAMES = [one.name for one in COLUMNS]


def write_interrupted(file: Path, numbers: Iterable[int]) -> None:
    with open_sweep(file, RUNS) as table:
        for number in numbers:
            table.write(variant(number), row(number))
        raise KeyboardInterrupt


def write(file: Path, numbers: Any = range(RUNS), runs: int = RUNS, **inputs: str) -> Path:
    with open_sweep(file, runs, **inputs) as table:
        for number in numbers:
            table.write(variant(number), row(number))
    return file


def journal_lines(file: Path) -> list[dict[str, Any]]:
    lines = file.with_name(f"{file.name}.sweep").read_text().splitlines()
    return [json.loads(line) for line in lines]


@pytest.fixture(params=SUFFIXES)
def file(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return tmp_path / f"results{request.param}"


# ---- What it has.


def test_csv(tmp_path: Path) -> None:
    file = write(tmp_path / "results.csv", [1, 0], runs=2)
    assert file.read_text(encoding="utf-8").splitlines() == [
        ",".join(("run", *NAMES[:4], "passed", "codes", *NAMES[4:], "diagnostic")),
        '0,0.0,0,ice,true,false,ROB203 SPN001,,0,false,,,,"","SPN001 `robot`: it ""tips"",',
        'over"',
        '1,0.14285714285714285,1000000000000,"a, b",false,true,"",0.7513148009015775,1,,,,,"",""',
    ]


def test_lines_of_json(tmp_path: Path) -> None:
    file = write(tmp_path / "results.jsonl", [1, 0], runs=2)
    first, second = (json.loads(line) for line in file.read_text(encoding="utf-8").splitlines())
    assert first["passed"] is False
    assert first["tilt"] is None
    assert second == {
        "run": 1,
        "mass": 1 / 7,
        "steps": 10**12,
        "surface": "a, b",
        "sealed": False,
        "passed": True,
        "codes": "",
        "tilt": 1.1**-3,
        "contacts": 1,
        "settled": None,
        "never": None,
        "never_integer": None,
        "never_boolean": None,
        "never_text": "",
        "diagnostic": "",
    }


@pytest.mark.slow
def test_pandas_and_polars_read_it_as_it_is(file: Path) -> None:
    import pandas as pd  # noqa: PLC0415  a second to import
    import polars as pl  # noqa: PLC0415

    write(file)
    kind = file.suffix[1:]
    read_pandas: dict[str, Any] = {
        "csv": pd.read_csv,
        "jsonl": lambda file: pd.read_json(file, lines=True),
        "parquet": pd.read_parquet,
    }
    read_polars: dict[str, Any] = {
        "csv": pl.read_csv,
        "jsonl": pl.read_ndjson,
        "parquet": pl.read_parquet,
    }
    frames = [read_pandas[kind](file), read_polars[kind](file)]
    given = [variant(number).values for number in range(RUNS)]  # noqa: PD011
    measured = [row(number).figures["tilt"] for number in range(RUNS)]
    expected = [math.nan if one is None else one for one in measured]
    for frame in frames:
        assert [*frame.columns] == ["run", *NAMES[:4], "passed", "codes", *NAMES[4:], "diagnostic"]
        assert [*frame["run"]] == [*range(RUNS)]
        # The last digits are not those of the file in pandas.read_json without `precise_float`.
        assert [*frame["mass"]] == pytest.approx([one["mass"] for one in given], rel=1e-13)
        assert [*frame["steps"]] == [one["steps"] for one in given]
        assert [*frame["sealed"]] == [one["sealed"] for one in given]
        texts = [one if isinstance(one, str) else "" for one in frame["surface"]]  # NaN: empty
        assert texts == [SURFACES[number % len(SURFACES)] for number in range(RUNS)]
        assert str(frame["passed"].dtype).lower().startswith("bool")
        assert str(frame["contacts"].dtype).lower() == "int64"
        assert str(frame["tilt"].dtype).lower() == "float64"
        tilts = [math.nan if one is None else one for one in frame["tilt"]]
        assert tilts == pytest.approx(expected, rel=1e-13, nan_ok=True)
        assert int(frame["passed"].sum()) == sum(row(number).passed for number in range(RUNS))
        assert frame["diagnostic"][0] == row(0).diagnostic
    if kind == "parquet":
        types = {name: str(dtype) for name, dtype in frames[1].schema.items()}
        assert types["never"] == "Float64"
        assert types["never_integer"] == "Int64"
        assert types["never_boolean"] == "Boolean"
        assert types["never_text"] == "String"
        assert frames[1]["never"].null_count() == RUNS


@pytest.mark.slow
def test_polars_knows_the_types_where_the_first_rows_have_no_diagnostic(file: Path) -> None:
    import polars as pl  # noqa: PLC0415

    column = Column(name="x", kind="number", is_parameter=True)
    with open_table(file, [column], header(300)) as table:
        for number in range(300):
            fails = number > 200
            one = Row(
                number=number,
                passed=not fails,
                codes=("SPN001",) * fails,
                diagnostic="SPN001 falls" if fails else None,
            )
            table.write(Variant(number=number, values={"x": float(number)}), one)
    read: dict[str, Any] = {
        ".csv": pl.read_csv,
        ".jsonl": pl.read_ndjson,
        ".parquet": pl.read_parquet,
    }
    frame = read[file.suffix](file)
    assert [str(one) for one in frame.dtypes] == [
        "Int64",
        "Float64",
        "Boolean",
        "String",
        "String",
    ]
    assert frame["diagnostic"].to_list() == [""] * 201 + ["SPN001 falls"] * 99


@pytest.mark.slow
def test_arrays_have_what_was_written(file: Path) -> None:
    data = read_table(write(file))
    assert data.runs == data.count == RUNS
    assert data.numbers.tolist() == [*range(RUNS)]
    assert data.passed.tolist() == [row(number).passed for number in range(RUNS)]
    by_name = {one.column.name: one for one in (*data.parameters, *data.figures)}
    assert [by_name[one.name].column for one in COLUMNS] == [*COLUMNS]
    assert by_name["mass"].numbers.tolist() == [number / 7 for number in range(RUNS)]
    surfaces = by_name["surface"]
    assert [surfaces.texts[int(index)] for index in surfaces.numbers] == [
        SURFACES[number % len(SURFACES)] for number in range(RUNS)
    ]
    settled = by_name["settled"].numbers.tolist()
    assert settled[0] == 0.0
    assert settled[2] == 1.0
    assert math.isnan(settled[1])
    assert all(math.isnan(number) for number in by_name["never"].numbers)
    assert data.code_sets == (("ROB203", "SPN001"), ())
    assert data.diagnostics == (row(0).diagnostic, "")
    assert data.code_set.tolist() == [int(row(number).passed) for number in range(RUNS)]


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_missing(file: Path, number: float) -> None:
    with open_table(file, [Column(name="x", kind="number")], header(1)) as table:
        table.write(
            Variant(number=0, values={}), Row(number=0, passed=False, figures={"x": number})
        )
    assert math.isnan(read_table(file).figures[0].numbers[0])


def test_texts_that_no_file_can_have(file: Path) -> None:
    column = Column(name="x", kind="text", is_parameter=True)
    with open_table(file, [column], header(1)) as table:
        table.write(Variant(number=0, values={"x": "a\0b\udc80c"}), Row(number=0, passed=True))
    assert read_table(file).parameters[0].texts == ("a␀b�c",)


def test_numbers_and_booleans_of_a_text_column_are_texts(file: Path) -> None:
    column = Column(name="x", kind="text", is_parameter=True)
    with open_table(file, [column], header(3)) as table:
        given: tuple[Any, ...] = (True, 2.5, "none")
        for number, value in enumerate(given):
            table.write(
                Variant(number=number, values={"x": value}), Row(number=number, passed=True)
            )
    assert read_table(file).parameters[0].texts == ("true", "2.5", "none")


def test_a_parameter_with_the_name_of_another_column(file: Path) -> None:
    columns = [
        Column(name="passed", kind="number", is_parameter=True),
        Column(name="tilt", kind="number", is_parameter=True),
        Column(name="tilt", kind="number"),
    ]
    with open_table(file, columns, header(1)) as table:
        table.write(
            Variant(number=0, values={"passed": 1.5, "tilt": 2.5}),
            Row(number=0, passed=True, figures={"tilt": 3.5}),
        )
    data = read_table(file)
    assert [one.numbers.tolist() for one in data.parameters] == [[1.5], [2.5]]
    assert data.figures[0].numbers.tolist() == [3.5]
    if file.suffix == ".csv":
        assert file.read_text().startswith("run,parameter.passed,parameter.tilt,passed,codes,tilt,")


def test_parameters_with_the_names_of_headings(file: Path) -> None:
    names = ["run", "tilt", "parameter.run", "parameter.parameter.tilt", "parameter.tilt"]
    columns = [
        *(Column(name=name, kind="number", is_parameter=True) for name in names),
        Column(name="tilt", kind="number"),
    ]
    values = {name: float(place) for place, name in enumerate(names)}
    for number in range(2):  # the second time it is resumed
        with open_table(file, columns, header(2)) as table:
            table.write(
                Variant(number=number, values=values),
                Row(number=number, passed=True, figures={"tilt": 9.0}),
            )
    assert headings(full_columns(columns)) == (
        "run",
        "parameter.parameter.run",
        "parameter.parameter.parameter.tilt",
        *names[2:],
        "passed",
        "codes",
        "tilt",
        "diagnostic",
    )
    data = read_table(file)
    assert [one.numbers.tolist() for one in data.parameters] == [[one] * 2 for one in range(5)]
    assert data.figures[0].numbers.tolist() == [9.0, 9.0]


def test_an_integer_that_does_not_fit(tmp_path: Path) -> None:
    column = Column(name="x", kind="integer", is_parameter=True)
    with (
        pytest.raises(RequestError, match="does not fit the 64 bits"),
        open_table(tmp_path / "results.csv", [column], header(1)) as table,
    ):
        table.write(Variant(number=0, values={"x": 2**63}), Row(number=0, passed=True))
    assert [*tmp_path.iterdir()] == []


# ---- The same bytes.


def test_the_order_of_the_rows_does_not_matter(file: Path, tmp_path: Path) -> None:
    numbers = [*range(RUNS)]
    expected = write(file).read_bytes()
    for seed in range(3):
        random.Random(seed).shuffle(numbers)  # noqa: S311
        other = write(tmp_path / f"other-{seed}{file.suffix}", numbers)
        assert other.read_bytes() == expected


def test_interruptions_do_not_matter(file: Path, tmp_path: Path) -> None:
    expected = write(tmp_path / f"expected{file.suffix}").read_bytes()
    for done in (3, 4, 17):
        with pytest.raises(KeyboardInterrupt):
            write_interrupted(file, reversed(range(RUNS - done, RUNS)))
        data = read_table(file)  # rows that are done, in their order
        assert data.numbers.tolist() == [*range(RUNS - done, RUNS)]
        assert data.runs == RUNS
    with open_sweep(file, RUNS) as table:
        assert table.count == 17
        assert [number in table for number in range(RUNS)] == [False] * 7 + [True] * 17
    write(file)
    assert file.read_bytes() == expected


def test_row_groups_of_parquet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table, "ROW_GROUP", 7)
    first = write(tmp_path / "first.parquet")
    second = write(tmp_path / "second.parquet", range(12))
    write(second)
    assert first.read_bytes() == second.read_bytes()
    assert read_table(first).numbers.tolist() == [*range(RUNS)]


def test_a_row_that_comes_twice_counts_once(file: Path) -> None:
    with open_sweep(file, RUNS) as table:
        for _ in range(2):
            table.write(variant(3), row(3))
        assert table.count == 1
    assert read_table(file).count == 1


# ---- Going on.


def test_the_journal_of_a_complete_table_has_no_rows(file: Path) -> None:
    write(file)
    first, last = journal_lines(file)
    assert first["runs"] == RUNS
    assert last["complete"] is True
    before = file.read_bytes(), file.stat().st_mtime_ns
    with open_sweep(file, RUNS) as table:
        assert table.was_complete
        assert table.is_complete
        assert table.count == RUNS
        assert all(number in table for number in range(RUNS))
    assert (file.read_bytes(), file.stat().st_mtime_ns) == before


def test_rows_are_in_the_journal_as_they_end(tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    with open_sweep(file, RUNS) as table:
        for number in (5, 2):
            table.write(variant(number), row(number))
            assert journal_lines(file)[-1]["run"] == number
        assert not file.exists()


def test_other_inputs_are_refused(file: Path) -> None:
    write(file, range(5))
    before = file.read_bytes()
    wanted = (
        r"other inputs: the robot; the duration \(3\.0 s there, 5\.0 s here\); "
        r"the engine \(none there, dart here\)\."
    )
    for _ in range(2):
        with pytest.raises(WouldOverwriteError, match=wanted) as raised:
            open_table(
                file,
                COLUMNS,
                journal.Header(
                    runs=RUNS,
                    inputs={"the robot": "b" * 64, "the duration": "5.0 s", "the engine": "dart"},
                ),
            )
        assert f"remove {file.name} and {file.name}.sweep" in raised.value.hint
        assert file.read_bytes() == before
        write(file)  # complete
        before = file.read_bytes()


def test_another_number_of_runs_and_other_columns_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    write(file, [20])
    with pytest.raises(WouldOverwriteError, match=r"number of runs \(24 there, 10 here\)"):
        open_sweep(file, 10)
    with pytest.raises(WouldOverwriteError, match="inputs: the columns"):
        open_table(file, COLUMNS[:-1], header(RUNS))
    file.unlink()  # killed before it was written
    with pytest.raises(WouldOverwriteError, match="number of runs"):
        open_sweep(file, 10)
    assert len(journal_lines(file)) == 3


def test_a_removed_table_is_made_again(file: Path) -> None:
    expected = write(file).read_bytes()
    file.unlink()
    with open_sweep(file, RUNS, other="x") as table:  # nothing is left to be mixed with
        assert table.count == 0
    assert [*file.parent.iterdir()] == []
    assert write(file).read_bytes() == expected


def test_a_changed_table_is_not_overwritten(file: Path) -> None:
    for numbers in (range(5), range(RUNS)):
        write(file, numbers)
        content = file.read_bytes()
        file.write_bytes(content + b"\n")
        with pytest.raises(WouldOverwriteError, match="it was changed or replaced"):
            open_sweep(file, RUNS)
        assert file.read_bytes() == content + b"\n"
        file.write_bytes(content)


@pytest.mark.parametrize("content", [b"", b"run,mass\n", b"\0\xff"])
def test_a_foreign_file_is_not_overwritten(file: Path, content: bytes) -> None:
    file.write_bytes(content)
    with pytest.raises(WouldOverwriteError, match="wsgen sweep did not write it"):
        open_sweep(file, RUNS)
    assert file.read_bytes() == content
    assert [*file.parent.iterdir()] == [file]


@pytest.mark.parametrize("content", [b"hello\n", b"hello", b'{"wsgen sweep":2}\n', b"\0\xff\n"])
def test_a_foreign_journal_is_not_overwritten(tmp_path: Path, content: bytes) -> None:
    other = tmp_path / "results.csv.sweep"
    other.write_bytes(content)
    with pytest.raises(WouldOverwriteError, match=r"results\.csv\.sweep exists and is not"):
        open_sweep(tmp_path / "results.csv", RUNS)
    assert other.read_bytes() == content


@pytest.mark.parametrize("part", [0, 1, 10, 40])
def test_a_first_line_that_is_cut_is_written_again(tmp_path: Path, part: int) -> None:
    file = tmp_path / "results.csv"
    other = tmp_path / "results.csv.sweep"
    open_sweep(file, RUNS).close()
    known = journal.Known(header=header(RUNS), columns=COLUMNS)
    other.write_bytes(journal.write_line(known)[:part])
    write(file)
    assert read_table(file).count == RUNS


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_any_cut_of_the_journal(tmp_path: Path, suffix: str) -> None:
    expected = write(tmp_path / f"expected{suffix}", range(4), runs=4).read_bytes()
    file = tmp_path / f"results{suffix}"
    table = open_sweep(file, 4)
    for number in range(3):
        table.write(variant(number), row(number))
    table._journal.close()  # as if killed: no table is written
    other = tmp_path / f"{file.name}.sweep"
    whole = other.read_bytes()
    for cut in range(len(whole.splitlines()[0]) + 1, len(whole), 17):
        other.write_bytes(whole[:cut])
        with open_sweep(file, 4) as table:
            assert table.count == whole[:cut].count(b"\n") - 1
            for number in range(4):
                table.write(variant(number), row(number))
        assert file.read_bytes() == expected
        file.unlink()


def test_what_a_disk_lost_in_the_middle_is_done_again(tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    expected = write(tmp_path / "expected.csv").read_bytes()
    write(file, range(10))
    other = tmp_path / "results.csv.sweep"
    lines = other.read_bytes().splitlines(keepends=True)
    lines[3] = b"\0" * 40 + b"\n"
    lines[5] = lines[5][:-10] + b"\n"
    lines[7] = b'{"run":"x"}\n'
    other.write_bytes(b"".join(lines))
    with open_sweep(file, RUNS) as table:
        assert [number for number in range(10) if number not in table] == [2, 4, 6]
    assert write(file).read_bytes() == expected


def test_killed_between_the_table_and_its_journal(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def die(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(journal.Journal, "finish", die)
        with pytest.raises(KeyboardInterrupt):
            write(file)
    expected = file.read_bytes()
    with open_sweep(file, RUNS) as table:
        assert table.is_complete
        assert not table.was_complete
    assert file.read_bytes() == expected
    assert len(journal_lines(file)) == 2


def test_a_second_process_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "PATIENCE", 0.1)
    file = tmp_path / "results.csv"
    with open_sweep(file, RUNS) as table:
        table.write(variant(0), row(0))
        with pytest.raises(RequestError, match="Another wsgen process is writing"):
            open_sweep(file, RUNS)
        table.write(variant(1), row(1))
    with open_sweep(file, RUNS) as table:
        assert table.count == 2


def test_a_link_leads_to_the_table(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    link = tmp_path / "results.csv"
    real = write(tmp_path / "real" / "results.csv")
    link.symlink_to(real)
    with open_sweep(link, RUNS) as table:
        assert table.was_complete
    assert read_table(link).count == RUNS


# ---- What cannot be.


@pytest.mark.parametrize(
    ("name", "message", "hint"),
    [
        ("results.xlsx", r"the format \.xlsx is unknown", r"\.parquet.*\.csv.*\.jsonl"),
        ("results.json", r"\.json is unknown", r"Use results\.jsonl"),
        ("results", "its name has no suffix", r"\.parquet"),
        ("results.csv.gz", r"\.gz is unknown", r"\.parquet"),
    ],
)
def test_unknown_formats(tmp_path: Path, name: str, message: str, hint: str) -> None:
    with pytest.raises(RequestError, match=message) as raised:
        open_sweep(tmp_path / name, RUNS)
    assert re.search(hint, raised.value.hint)
    assert [*tmp_path.iterdir()] == []


def test_suffixes_in_capitals(tmp_path: Path) -> None:
    assert read_table(write(tmp_path / "RESULTS.CSV")).count == RUNS


def test_a_folder_a_missing_folder_and_a_pipe(tmp_path: Path) -> None:
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(RequestError, match="it is a folder"):
        open_sweep(tmp_path / "folder.csv", RUNS)
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(RequestError, match="it is a named pipe"):
        open_sweep(tmp_path / "pipe.csv", RUNS)
    with pytest.raises(NotReadableError, match="the folder does not exist"):
        open_sweep(tmp_path / "missing" / "results.csv", RUNS)


def test_without_pyarrow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def refuse(name: str, *arguments: Any, **keywords: Any) -> Any:
        if name.partition(".")[0] in {"pyarrow", "scipy"}:
            raise ImportError(name)
        return real(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", refuse)
    for suffix in (".csv", ".jsonl"):
        assert read_table(write(tmp_path / f"results{suffix}")).count == RUNS
    with pytest.raises(NotFoundError) as raised:
        open_sweep(tmp_path / "results.parquet", RUNS)
    assert "pip install 'wsgen[sweep]'" in raised.value.hint


def test_reading_what_is_no_table(tmp_path: Path) -> None:
    with pytest.raises(NotReadableError, match=r"results\.csv\.sweep beside it is missing"):
        read_table(tmp_path / "results.csv")
    for suffix in SUFFIXES:
        file = write(tmp_path / f"results{suffix}")
        file.write_bytes(b"hello\nworld\n")
        with pytest.raises(NotReadableError, match="Cannot read"):
            read_table(file)
        file.unlink()
        with pytest.raises(NotReadableError, match="no such file"):
            read_table(file)


# ---- Full disks and kills.


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let the system refuse larger files, as a full disk would."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_disk_keeps_what_was_written(file: Path, tmp_path: Path) -> None:
    expected = write(tmp_path / f"expected{file.suffix}").read_bytes()
    with (
        files_of_at_most(4000),
        pytest.raises(NotReadableError, match=r"results.*: the file is larger than the limit"),
    ):
        write(file)
    with open_sweep(file, RUNS) as table:
        assert 3 < table.count < RUNS
    assert write(file).read_bytes() == expected
    assert not [*tmp_path.glob(".wsgen-file-*")]


def test_a_write_that_fails_half_way(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = os.write
    table = open_sweep(file, RUNS)
    table.write(variant(0), row(0))

    def write_half(descriptor: int, data: bytes) -> int:
        if len(data) < 100:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(descriptor, data[: len(data) // 2])

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", write_half)
        with pytest.raises(NotReadableError, match="the disk is full"):
            table.write(variant(1), row(1))
    assert 1 not in table
    table.write(variant(2), row(2))
    table.close()
    assert read_table(file).numbers.tolist() == [0, 2]


def test_a_table_that_cannot_be_written_does_not_hide_why_the_sweep_ended(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(KeyboardInterrupt):
        write_interrupted(file, [0])
    assert not file.exists()
    with pytest.raises(NotReadableError, match="the disk is full"), open_sweep(file, RUNS):
        pass
    monkeypatch.undo()
    with open_sweep(file, RUNS) as table:
        assert table.count == 1


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_kill_9_at_any_moment(tmp_path: Path, suffix: str) -> None:
    runs = 800
    expected = write(tmp_path / f"expected{suffix}", range(runs), runs=runs).read_bytes()
    file = tmp_path / f"results{suffix}"
    chance = random.Random(17)  # noqa: S311
    before, kills = 0, 0
    for seed in range(60):
        command = [sys.executable, "-m", "sweeping.row_writer", str(file), str(runs), str(seed)]
        process = subprocess.Popen(
            command, cwd=Path(__file__).parents[1], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        count = process.stdout.readline()
        time.sleep(chance.uniform(0.0, 0.01 * seed**2))  # so that it ends once
        process.send_signal(signal.SIGKILL)
        process.stdout.close()
        if process.wait() == 0:
            break
        kills += 1
        assert int(count) >= before  # nothing that was written is lost
        before = int(count)
    else:
        pytest.fail("it does not come to its end")
    assert kills > 0
    assert file.read_bytes() == expected
    assert len(journal_lines(file)) == 2

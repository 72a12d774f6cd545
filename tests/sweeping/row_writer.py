"""A process that writes rows of a made-up sweep, to be killed: FILE RUNS SEED."""

import random
import sys
from pathlib import Path

from wsgen.model.sweep import Column, Row, Variant
from wsgen.sweeping.journal import Header
from wsgen.sweeping.table import TableWriter, open_table

COLUMNS = (
    Column(name="mass", kind="number", meaning="mass of the arm, kg", is_parameter=True),
    Column(name="steps", kind="integer", is_parameter=True),
    Column(name="surface", kind="text", is_parameter=True),
    Column(name="sealed", kind="boolean", is_parameter=True),
    Column(name="tilt", kind="number", meaning="tilt at the end, rad"),
    Column(name="contacts", kind="integer"),
    Column(name="settled", kind="boolean"),
    Column(name="never", kind="number"),
    Column(name="never_integer", kind="integer"),
    Column(name="never_boolean", kind="boolean"),
    Column(name="never_text", kind="text"),
)
SURFACES = (
    "ice",
    "a, b",
    'say "so"',
    "two\nlines",
    "Grüße 漢字 🤖",
    " blank ",
    "carriage\rreturn",
    "",
)


def header(runs: int, **inputs: str) -> Header:
    return Header(runs=runs, inputs={"the robot": "a" * 64, "the duration": "3.0 s", **inputs})


def open_sweep(file: Path, runs: int, **inputs: str) -> TableWriter:
    return open_table(file, COLUMNS, header(runs, **inputs))


def variant(number: int) -> Variant:
    return Variant(
        number=number,
        values={
            "mass": number / 7,
            "steps": number * 10**12,
            "surface": SURFACES[number % len(SURFACES)],
            "sealed": number % 3 == 0,
        },
    )


def row(number: int) -> Row:
    passed = number % 5 > 0
    return Row(
        number=number,
        passed=passed,
        codes=() if passed else ("ROB203", "SPN001"),
        diagnostic=None if passed else 'SPN001 `robot`: it "tips",\nover',
        figures={
            "tilt": (0.1 + number) ** -3 if passed else None,
            "contacts": number % 4,
            "settled": None if number % 2 else passed,
        },
    )


def main() -> None:
    file, runs, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    numbers = [*range(runs)]
    random.Random(seed).shuffle(numbers)  # noqa: S311
    with open_sweep(file, runs) as table:
        print(table.count, flush=True)  # noqa: T201
        for number in numbers:
            if number not in table:
                table.write(variant(number), row(number))


if __name__ == "__main__":
    main()

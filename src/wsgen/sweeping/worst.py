"""The worst variants of a sweep as files that one can look at."""

from __future__ import annotations

import json
import os
import re
import time
from typing import TYPE_CHECKING

import numpy as np

from wsgen.diagnostics import Severity
from wsgen.errors import RequestError, WouldOverwriteError
from wsgen.events import StepEnded, StepStarted, post
from wsgen.files import write_file
from wsgen.isolation import parent
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.pipeline.selection import ValidateRequest
from wsgen.rules.catalogue import without_allowed
from wsgen.suggestions import ask_for_nearest
from wsgen.sweeping.apply import apply
from wsgen.sweeping.parameters import (
    FRICTION,
    FRICTION_SCALE,
    INERTIA_SCALE,
    MASS_SCALE,
    OWN,
    own_values,
    write_value,
)
from wsgen.sweeping.run_variant import can_run, pushes_of
from wsgen.sweeping.scaled import scale_text
from wsgen.templating.write import explain_failure, make_parents, unfinished_folder, write_files
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.sweep import Value, Variant
    from wsgen.sweeping.design import Variants
    from wsgen.sweeping.subject import Subject
    from wsgen.sweeping.sweep import SweepRequest
    from wsgen.sweeping.table_data import Series, TableData


RECORD = "variant.json"  # in each folder: which run of which sweep it is
PICTURE = "robot.png"
VIDEO = "robot.gif"
NOT_IN_THE_ROBOT = frozenset(one.name for one in OWN) - {
    FRICTION,
    FRICTION_SCALE,
    INERTIA_SCALE,
    MASS_SCALE,
}


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Which variants are written."""

    count: int
    column: str | None = None  # whose largest values they have; None: those that fail and tilt most


@dataclass(frozen=True, kw_only=True)
class WorstVariant:
    """A variant that was written."""

    number: int
    values: Mapping[str, Value]
    passed: bool
    folder: Path
    picture: Path | None
    video: Path | None
    was_there: bool  # from an earlier command


def read_choice(word: str) -> Choice:
    """Read `K` or `K:COLUMN`.

    Raises:
        RequestError: It is something else.
    """
    count, _, column = word.partition(":")
    if not (count.isascii() and count.isdigit() and int(count)) or (":" in word and not column):
        raise RequestError(
            f"--worst {word} does not say how many variants.",
            hint="Write for example --worst 3, or --worst 3:drift for the largest values of a "
            "column.",
        )
    return Choice(count=int(count), column=column or None)


def choose(data: TableData, choice: Choice) -> list[int]:
    """The rows of the worst variants, the worst first; those without a robot come last.

    Raises:
        RequestError: The table has no such column of numbers.
    """
    figures = [one for one in data.figures if one.column.kind in {"number", "integer"}]
    if choice.column is not None:
        keys = [-np.abs(_named(figures, choice.column).numbers)]
    else:
        keys = [data.passed, -_largest(data, figures, "tilt"), -_largest(data, figures, "drift")]
    has_robot = ~np.isnan(_largest(data, figures, "tilt"))
    # Of equal variants the first run; NaN comes last.
    order = np.lexsort((data.numbers, *reversed(keys), ~has_robot))
    return [int(row) for row in order[: choice.count]]


def _named(figures: list[Series], column: str) -> Series:
    for one in figures:
        if one.column.name == column:
            return one
    names = [one.column.name for one in figures]
    raise RequestError(
        f"The table has no column `{column}` of numbers.",
        hint=f"{ask_for_nearest(column, names)}Columns: {', '.join(names)}.",
    )


def _largest(data: TableData, figures: list[Series], name: str) -> NDArray[np.float64]:
    """That figure of the robot for which it is largest; NaN where none has it."""
    found = [one.numbers for one in figures if one.column.name.rpartition(".")[2] == name] or [
        np.full(data.count, np.nan)
    ]
    largest: NDArray[np.float64] = np.fmax.reduce(found)
    return largest


def write_worst(  # noqa: PLR0913  of what, which, and where
    request: SweepRequest,
    rows: Sequence[int],
    subject: Subject,
    variants: Variants,
    data: TableData,
    *,
    out: Path,
    inputs: Mapping[str, str],
    listener: Listener | None,
) -> Iterator[WorstVariant]:
    """Write the variants of some rows into a folder each, beside the table.

    `inputs` are those of the table's header; the subject is one that is drawn.

    Raises:
        WouldOverwriteError: A folder of this name has something else.
        NotReadableError: It cannot be written.
    """
    parent_folder = out.with_name(f"{out.stem}-worst")
    for row in rows:
        variant = variants.variant(int(data.numbers[row]))
        folder = parent_folder / f"run-{variant.number}"
        record = _record(variant, inputs)
        was_there = os.path.lexists(folder)
        if was_there:
            _refuse_other(folder, record)
        else:
            step = ("worst", f"run {variant.number}")
            post(listener, StepStarted(step=step))
            started = time.monotonic()
            _write(request, subject, variant, folder, record)
            seconds = time.monotonic() - started
            post(listener, StepEnded(step=step, succeeded=True, seconds=seconds))
        yield WorstVariant(
            number=variant.number,
            values=variant.values,
            passed=bool(data.passed[row]),
            folder=folder,
            picture=_if_there(folder / PICTURE),
            video=_if_there(folder / VIDEO),
            was_there=was_there,
        )


def _if_there(file: Path) -> Path | None:
    return file if file.is_file() else None


def _record(variant: Variant, inputs: Mapping[str, str]) -> str:
    document = {
        "run": variant.number,
        "parameters": dict(variant.values),
        "inputs": dict(inputs),
    }
    return json.dumps(document, indent=2) + "\n"


def _refuse_other(folder: Path, record: str) -> None:
    try:
        is_same = (folder / RECORD).read_text(encoding="utf-8") == record
    except (OSError, ValueError):
        is_same = False
    if not is_same:
        raise WouldOverwriteError(
            f"{folder} exists, with something else than this variant.",
            hint="Remove it, or move it away.",
        )


def _write(
    request: SweepRequest, subject: Subject, variant: Variant, folder: Path, record: str
) -> None:
    try:
        make_parents(folder.parent, [])
        # The packages of variants have one name; each folder is a workspace of its own.
        (folder.parent / "COLCON_IGNORE").touch()
        with unfinished_folder(folder.parent) as unfinished:
            filled = unfinished / folder.name
            filled.mkdir()
            _fill(request, subject, variant, filled)
            write_file(filled / RECORD, record)
            filled.rename(folder)
    except OSError as error:
        raise explain_failure(error, folder) from error


def _fill(request: SweepRequest, subject: Subject, variant: Variant, folder: Path) -> None:
    """Put the robots, the package of a template, a picture, a video and a text into a folder."""
    own = own_values(variant.values)
    robots = []
    for entity, text, file in subject.texts(variant.values):
        is_sdf = "<sdf" in text
        name = f"{_file_name(entity)}.{'sdf' if is_sdf else 'urdf'}"
        write_file(folder / name, _varied(text, own))
        robots.append((name, file))
    package = subject.package(variant.values)
    if package is not None:
        name, tree = package
        (folder / "src").mkdir()
        write_files(tree, folder / "src" / name)
    varied = apply(subject.prepare(variant.values), variant.values)
    found: Sequence[Diagnostic] = varied.diagnostics
    if varied.world is not None and can_run(varied):
        simulated = simulate_robots(
            varied.world,
            varied.prepared,
            ValidateRequest(
                seconds=request.seconds,
                engines=(request.engine,),
                picture_folder=folder,
                video=folder / VIDEO,
            ),
            PICTURE.removesuffix(".png"),
            run=parent.run,
            behavior_plan=varied.behavior_plan,
            pushes=pushes_of(varied, request.seconds),
        )
        found = simulated.diagnostics_after(varied.diagnostics)
    reported = without_allowed(found, varied.allow)
    text = _read_me(subject, variant, robots, package and package[0], reported)
    write_file(folder / "README.md", text)


def _file_name(entity: str) -> str:
    """The name of an entity, as far as it can be that of a file."""
    return re.sub(r"[^\w.-]", "_", entity).lstrip(".") or "robot"


def _varied(text: str, own: Mapping[str, float]) -> str:
    """The text of a robot with the numbers that wsgen's own parameters change in it."""
    return scale_text(
        text,
        mass=own.get(MASS_SCALE, 1.0),
        inertia=own.get(INERTIA_SCALE, 1.0),
        friction=own.get(FRICTION_SCALE, 1.0),
        ground=own.get(FRICTION),
    )


def _read_me(
    subject: Subject,
    variant: Variant,
    robots: Sequence[tuple[str, Path | None]],
    package: str | None,
    reported: Sequence[Diagnostic],
) -> str:
    errors = [one for one in reported if one.severity is Severity.ERROR]
    lines = [
        f"# Run {variant.number} of a sweep of {subject.name}",
        "",
        "| parameter | value |",
        "|---|---|",
        *(f"| {name} | {write_value(value)} |" for name, value in variant.values.items()),
        "",
        *(f"- {one.code} {one.name}: {one.message}" for one in errors),
        *(["- The variant passes."] if not errors else []),
        "",
        f"![The robot at the end of the simulation]({PICTURE})",
        "",
        f"![The simulation]({VIDEO})",
        "",
    ]
    for name, file in robots:
        origin = f", from {file.name}" if file is not None else ""
        lines += [f"`{name}` is the robot of this variant{origin}: `wsgen view {name}`", ""]
    if package is not None:
        lines += [f"`src/{package}` is its package: `wsgen build && wsgen validate`", ""]
    if any(name in NOT_IN_THE_ROBOT for name in own_values(variant.values)):
        lines += [
            "World, spawn pose and push are in the picture and the video alone.",
            "",
        ]
    return "\n".join(lines)

"""A sweep: its variants, the runs that are still to do, their table and its summary."""

from __future__ import annotations

import math
import time
from contextlib import ExitStack, closing
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.catalogue import without_allowed
from wsgen.errors import NotFoundError, RequestError
from wsgen.model.sweep import Column
from wsgen.pipeline.load_scene import BrokenSceneError
from wsgen.simulation.run import check_engines
from wsgen.sweeping.design import Variants
from wsgen.sweeping.journal import Header
from wsgen.sweeping.parameters import OWN, PUSH_FORCE, PUSH_SECONDS, subject_values
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.run_variant import PUSHED_AFTER, can_be_pushed, can_run, columns
from wsgen.sweeping.runner import WORTH, Order, limits_of, run_all, run_apart
from wsgen.sweeping.summary import summarize
from wsgen.sweeping.table import check_format, open_table, read_table
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Mapping

    from wsgen.events import Listener
    from wsgen.model.sweep import Design, Row, Value, Variant
    from wsgen.sweeping.children import LocalExecutor
    from wsgen.sweeping.dask_cluster import DaskExecutor
    from wsgen.sweeping.run_variant import Blueprint
    from wsgen.sweeping.runner import RunExecutor
    from wsgen.sweeping.subject import Subject, SubjectRequest
    from wsgen.sweeping.summary import Summary
    from wsgen.sweeping.table import TableData, TableWriter
    from wsgen.sweeping.worst import Choice, WorstVariant


DEFAULT_SECONDS = 3.0  # simulated
TRIED = 8  # variants, spread over the sweep, whose figures are the columns
PUSH_LASTS = next(float(one.default or 0.0) for one in OWN if one.name == PUSH_SECONDS)
PREPARING_SECONDS = 120.0  # CPU time that opening a subject and preparing a variant may take
FEW_TEXTS = 20  # of a parameter, whose files are looked at before the first run
NAMED = 3  # parameters in the name of the table


@dataclass(frozen=True, kw_only=True)
class SweepRequest:
    """What varies, of what, and how it is simulated."""

    subject: SubjectRequest
    design: Design
    out: Path | None = None  # the table; None: in the current folder, named after the subject
    seconds: float = DEFAULT_SECONDS  # of simulated time, of each run
    engine: str = "bullet"
    jobs: int = 1
    scheduler: str | None = None  # the address of Dask's, or "local"
    worst: Choice | None = None  # which variants to write


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a sweep is."""

    done: int  # runs, before this command and in it
    runs: int  # of the whole sweep
    failed: int  # in this command
    seconds_left: float | None  # wall-clock, by the runs of this command


@dataclass(frozen=True, kw_only=True)
class SweepOutcome:
    """What a sweep that is complete gives."""

    name: str  # of the package, file or template
    out: Path
    was_complete: bool  # before this command
    data: TableData
    summary: Summary
    hints: tuple[str, ...] = ()  # about the samples, and what varies
    worst: tuple[WorstVariant, ...] = ()


def sweep(
    request: SweepRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
    on_progress: Callable[[Progress], None] = lambda _: None,
    on_table: Callable[[SweepOutcome], None] = lambda _: None,
) -> SweepOutcome:
    """Run all variants that the table does not have yet, and sum the table up.

    `on_table` gets the outcome before the worst variants are written.

    Rows are in the table or its journal as they end: interrupted, by whatever, the sweep goes on
    with the same request.

    Raises:
        RequestError: A name or value does not fit what is swept, or another process writes the
            table.
        WouldOverwriteError: The table belongs to another sweep.
        NotFoundError: What is swept, an engine or a library is missing.
        NotReadableError: A file cannot be read or written.
        BrokenSceneError: Nothing could be simulated, whatever the variant.
    """
    check_engines((request.engine,))
    if request.out is not None:
        check_format(request.out)
    with ExitStack() as stack:
        subject = stack.enter_context(
            open_subject(request.subject, environment=environment, listener=listener)
        )
        design = subject.check(request.design)
        variants = Variants(design)
        varied = "-".join(design.names[:NAMED])
        out = request.out or Path(f"{subject.name}-sweep-{varied}.csv")
        header = Header(runs=len(variants), inputs=_inputs(request, design, subject, environment))
        made = _columns(design, subject, variants)
        if request.worst is not None:
            from wsgen.sweeping.worst import check_choice  # noqa: PLC0415  it draws

            check_choice(request.worst, made, out)
        with open_table(out, made, header) as table:
            if not table.is_complete:
                executor = _executor(request)
                stack.enter_context(executor)
                _run(
                    request,
                    subject,
                    variants,
                    table,
                    environment,
                    executor=executor,
                    on_progress=on_progress,
                )
            was_complete = table.was_complete
        data = read_table(out)
        outcome = SweepOutcome(
            name=subject.name,
            out=out,
            was_complete=was_complete,
            data=data,
            summary=summarize(data),
            hints=tuple(
                filter(
                    None,
                    (variants.hint, _late_push(design, request.seconds), _left_out(subject)),
                )
            ),
        )
        on_table(outcome)
        if request.worst is None:
            return outcome
        from wsgen.sweeping.worst import choose, write_worst  # noqa: PLC0415  as above

        rows = choose(data, request.worst)
        drawn = replace(request.subject, is_drawn=True, kept=1)
        subject = stack.enter_context(open_subject(drawn, environment=environment))
        worst = write_worst(
            request,
            rows,
            subject,
            variants,
            data,
            out=out,
            inputs=header.inputs,
            listener=listener,
        )
        return replace(outcome, worst=tuple(worst))


def _left_out(subject: Subject) -> str | None:
    """What a sweep does not do, in words."""
    if not subject.left_out:
        return None
    names = ", ".join(f"`{name}`" for name in subject.left_out)
    return f"A sweep runs no nodes and leaves out {names}; `wsgen validate` runs them."


def _inputs(
    request: SweepRequest, design: Design, subject: Subject, environment: Mapping[str, str]
) -> dict[str, str]:
    """What the results depend on, in words for a person."""
    varied = {
        **{axis.name: f"{len(axis.values)} values: {axis.values}" for axis in design.axes},
        **{
            one.name: f"{one.kind}{one.choices or one.numbers}, {design.samples} samples, "
            f"{design.sampler}, seed {design.seed}"
            for one in design.distributions
        },
    }
    return {
        "the files of the robot and its world": subject.digest(
            request.engine, _texts(design), environment
        ),
        "the simulated seconds": repr(request.seconds),
        "the engine": request.engine,
        "the behaviors": "simulated" if request.subject.has_behaviors else "left out",
        **{f"the parameter {name}": text for name, text in varied.items()},
    }


def _texts(design: Design) -> Iterator[Mapping[str, Value]]:
    """The texts that parameters have, as far as they are few: they may choose among files."""
    values = [(axis.name, axis.values) for axis in design.axes]
    values += [(one.name, one.choices) for one in design.distributions]
    for name, some in values:
        yield from ({name: value} for value in some[:FEW_TEXTS] if isinstance(value, str))


def _columns(design: Design, subject: Subject, variants: Variants) -> tuple[Column, ...]:
    """The parameters, and the figures that the first variant with a robot has."""
    parameters = {one.name: one for one in (*subject.parameters, *OWN)}
    given = tuple(
        Column(
            name=name,
            kind=_kind(design, name),
            meaning=", ".join(filter(None, (parameters[name].unit, parameters[name].meaning))),
            is_parameter=True,
        )
        for name in design.names
    )
    return (*given, *_figures(subject, variants))


def _kind(design: Design, name: str) -> str:
    """The kind of column that has all values of a parameter."""
    values: set[type] = set()
    for axis in design.axes:
        if axis.name == name:
            values = {type(value) for value in axis.values}
    for one in design.distributions:
        if one.name == name:
            values = {type(value) for value in one.choices} or {float}
    if values == {bool}:
        return "boolean"
    if values == {int}:
        return "integer"
    return "number" if values <= {int, float} else "text"


def _figures(subject: Subject, variants: Variants) -> tuple[Column, ...]:
    """The figures of some variants from all over the sweep.

    Raises:
        BrokenSceneError: None of them has a robot.
    """
    tried: dict[tuple[tuple[str, Value], ...], Blueprint] = {}
    for variant in _spread(variants):
        values = subject_values(variant.values)
        key = tuple(values.items())
        if key not in tried:
            tried[key] = subject.prepare(values)
    usable = [one for one in tried.values() if can_run(one)]
    if not usable:
        first = next(iter(tried.values()))
        raise BrokenSceneError(subject.name, without_allowed(first.diagnostics, first.allow))
    if PUSH_FORCE in variants.variant(0).values and not any(map(can_be_pushed, usable)):
        raise RequestError(
            f"{PUSH_FORCE} has no effect: {subject.name} is fixed to the world.",
            hint=f"Leave {PUSH_FORCE} out, or have the robot stand free: remove its fixed joint to "
            "`world`.",
        )
    return tuple(dict.fromkeys(one for blueprint in usable for one in columns(blueprint)))


def _late_push(design: Design, seconds: float) -> str | None:
    """Say that a push still acts at the end of a run, and is part of what is measured there."""
    if PUSH_FORCE not in design.names:
        return None
    longest = max(
        [
            *(
                float(value)
                for axis in design.axes
                if axis.name == PUSH_SECONDS
                for value in axis.values
            ),
            *(
                max(map(float, one.choices or one.numbers))
                for one in design.distributions
                if one.name == PUSH_SECONDS
            ),
        ],
        default=PUSH_LASTS,
    )
    enough = longest / (1 - PUSHED_AFTER)
    if seconds >= enough:
        return None
    return (
        f"A push of {longest:g} s, from a third of the run on, still acts at the end of runs of "
        f"{seconds:g} s. Give --seconds {math.ceil(2 * enough):g} for the robot to come to rest."
    )


def _spread(variants: Variants) -> Iterator[Variant]:
    """Some variants from all over a sweep."""
    count = min(len(variants), TRIED)
    for place in range(count):
        yield variants.variant(place * (len(variants) - 1) // max(1, count - 1))


def _rows(  # noqa: PLR0913, PLR0917  what is run, and where
    request: SweepRequest,
    subject: Subject,
    variants: Variants,
    todo: Iterator[Variant],
    count: int,
    environment: Mapping[str, str],
    executor: RunExecutor,
) -> Generator[Row, None, None]:
    """Run variants; where robots differ, they are prepared by as many processes as run them."""

    def blueprint_of(variant: Variant) -> Blueprint:
        return subject.prepare(variant.values)

    seconds, engine = request.seconds, request.engine
    varies = bool(subject_values(variants.variant(0).values))
    if varies and request.scheduler is None and 1 < request.jobs <= count // WORTH:
        limits = limits_of(blueprint_of(variants.variant(0)), seconds)
        return run_apart(
            executor,
            Order(subject=request.subject, environment=dict(environment)),
            blueprint_of,
            todo,
            seconds=seconds,
            engine=engine,
            limits=replace(limits, seconds=limits.seconds + PREPARING_SECONDS),
            count=count,
        )
    return run_all(executor, blueprint_of, todo, seconds=seconds, engine=engine, count=count)


def _run(  # noqa: PLR0913  what is run, where, and who hears of it
    request: SweepRequest,
    subject: Subject,
    variants: Variants,
    table: TableWriter,
    environment: Mapping[str, str],
    *,
    executor: RunExecutor,
    on_progress: Callable[[Progress], None],
) -> None:
    before, failed = table.count, 0
    started = time.monotonic()

    def notify() -> None:
        done = table.count - before
        each = (time.monotonic() - started) / done if done else None
        on_progress(
            Progress(
                done=table.count,
                runs=len(variants),
                failed=failed,
                seconds_left=None if each is None else each * (len(variants) - table.count),
            )
        )

    notify()
    todo = (variant for variant in variants if variant.number not in table)
    count = variants.count - before
    rows = _rows(request, subject, variants, todo, count, environment, executor)
    known = {one.name for one in table.known.columns}
    with closing(rows):
        for row in rows:
            # Of other robots than those that the columns are about nothing is said.
            figures = {name: figure for name, figure in row.figures.items() if name in known}
            table.write(variants.variant(row.number), replace(row, figures=figures))
            failed += not row.passed
            notify()


def _executor(request: SweepRequest) -> LocalExecutor | DaskExecutor:
    """Where the runs are computed."""
    if request.scheduler is None:
        from wsgen.sweeping.children import LocalExecutor  # noqa: PLC0415  as below

        return LocalExecutor(request.jobs)
    if find_spec("distributed") is None:
        raise NotFoundError(
            "Dask's `distributed`, which --scheduler needs, is not installed.",
            hint="Install it: pip install 'wsgen[sweep]'; or leave out --scheduler.",
        )
    from wsgen.sweeping import dask_cluster  # noqa: PLC0415  an extra that takes a second

    return dask_cluster.connect(request.scheduler, jobs=request.jobs)

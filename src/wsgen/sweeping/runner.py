"""Run the variants of a sweep on an executor, and give their rows as they end.

Where the robot itself varies, they are prepared where they are run: expanding a robot takes up to
a third of the time of its run, and one process that prepares all variants keeps few others busy.
"""

from __future__ import annotations

import queue
import tempfile
from collections import OrderedDict
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from wsgen.isolation.child import scratch_folder
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Limits
from wsgen.model.robot import Mesh
from wsgen.model.sweep import Row
from wsgen.sweeping.children import ChildDiedError, Shared, share
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.run_variant import (
    can_run,
    row_of_death,
    row_without_run,
    rows_until,
    run_variant,
    run_variants,
)
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
    from concurrent.futures import Future

    from wsgen.isolation.result import Died
    from wsgen.model.sweep import Variant
    from wsgen.sweeping.run_variant import Blueprint
    from wsgen.sweeping.subject import Subject, SubjectRequest


Subjected = TypeVar("Subjected")

WAKE_EVERY = 0.2  # s; a signal that another thread receives is handled when this one wakes
MOST_IN_A_CALL = 100  # variants
# s, wall-clock, after which a call begins no further variant. To submit one and to take its rows
# costs Dask 6 ms: the more calls are under way, the longer they have to be.
LONGEST_CALL = 0.5
LONGEST_CALL_A_CALL = 0.004  # for each that is submitted at a time
MOST_SHARED = 8  # blueprints that are kept pickled, the last that were used

# CPU time that a run may take. Large robots are slower than real time; the limit is for an engine
# that hangs.
RUN_SECONDS = 60.0
SECONDS_A_SECOND = 20.0  # more for each that is simulated


class RunExecutor(Protocol):
    """What `run_all` needs of an executor; see `children` and `dask_cluster`."""

    @property
    def window(self) -> int:
        """How many runs should be submitted at a time."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a function called, within the `limits` that are given by keyword."""


def run_all(  # noqa: PLR0913  what is run, where and how
    executor: RunExecutor,
    blueprint_of: Callable[[Variant], Blueprint],
    variants: Iterable[Variant],
    *,
    seconds: float,
    engine: str,
    count: int = 0,
) -> Generator[Row, None, None]:
    """Run variants for so many simulated seconds in an engine; give a row each as it ends.

    No more blueprints are asked for than are about to run; one that has no robot to simulate
    becomes a row at once. A variant that ends each process that computes it is a row that says so.

    Args:
        executor: What computes them.
        blueprint_of: What a variant is made of, without wsgen's own parameters.
        variants: In the order in which they are begun.
        seconds: Simulated time of each.
        engine: A key of `ENGINES`.
        count: How many variants these are, at least: of many, some go into one call.
    """
    shared = _Shared()

    def submit(blueprint: Blueprint, variants: Sequence[Variant]) -> Future[Any]:
        return executor.submit(
            run_variants,
            shared.of(blueprint),
            variants,
            seconds,
            engine,
            _longest_call(executor),
            limits=limits_of(blueprint, seconds),
        )

    def doom(blueprint: Blueprint, variant: Variant, death: Died) -> Iterator[Row]:
        yield row_of_death(blueprint, variant, seconds, engine, death)

    calls = _Calls(executor, submit, doom)
    batch: list[Variant] = []
    made: Blueprint | None = None
    try:
        for number, variant in enumerate(variants):
            blueprint = blueprint_of(variant)
            if not can_run(blueprint):
                yield row_without_run(blueprint, variant)
                continue
            if made is not None and batch and blueprint is not made:
                yield from calls.begin(made, batch)
                batch = []
            made = blueprint
            batch.append(variant)
            if len(batch) >= _batch_size(executor, count - number):
                yield from calls.begin(made, batch)
                batch = []
        if made is not None and batch:
            yield from calls.begin(made, batch)
        yield from calls.rest()
    finally:
        calls.cancel()


def _longest_call(executor: RunExecutor) -> float:
    return max(LONGEST_CALL, LONGEST_CALL_A_CALL * executor.window)


def _batch_size(executor: RunExecutor, left: int) -> int:
    """The last calls are short ones, so that all processes end at about the same time."""
    return min(MOST_IN_A_CALL, left // (2 * executor.window))


class _Calls(Generic[Subjected]):
    """The calls that are under way, each of some variants of one thing.

    `submit` makes a call; `doom` gives the rows of a variant that ended its process.
    """

    def __init__(
        self,
        executor: RunExecutor,
        submit: Callable[[Subjected, Sequence[Variant]], Future[Any]],
        doom: Callable[[Subjected, Variant, Died], Iterable[Row]],
    ) -> None:
        self._running: dict[Future[Any], tuple[Subjected, Sequence[Variant]]] = {}
        self._executor = executor
        self._call = submit
        self._doom = doom
        self._ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()

    def begin(self, subject: Subjected, variants: Sequence[Variant]) -> Iterator[Row]:
        """Submit variants when there is room; give the rows that end until then."""
        while len(self._running) >= self._executor.window:
            yield from self._next_rows()
        self._submit(subject, variants)

    def rest(self) -> Iterator[Row]:
        """Give the rows of all calls that are under way."""
        while self._running:
            yield from self._next_rows()

    def _submit(self, subject: Subjected, variants: Sequence[Variant]) -> None:
        future = self._call(subject, variants)
        self._running[future] = subject, variants
        future.add_done_callback(self._ended.put)

    def _next_rows(self) -> Iterator[Row]:
        """Give the rows of the next call that ends; what it has left goes into another one."""
        future: Future[Any] | None = None
        while future is None:
            with suppress(queue.Empty):
                future = self._ended.get(timeout=WAKE_EVERY)
        subject, variants = self._running.pop(future)
        try:
            rows = decode(future.result(), tuple[Row, ...])
        except ChildDiedError as error:
            if len(variants) == 1:
                yield from self._doom(subject, variants[0], error.death)
                return
            for variant in variants:  # to find out which one it is
                self._submit(subject, [variant])
            return
        if len(rows) < len(variants):
            self._submit(subject, variants[len(rows) :])
        yield from rows

    def cancel(self) -> None:
        """Begin nothing that has not begun."""
        for future in self._running:
            future.cancel()


class _Shared:
    """Blueprints as arguments; that of many variants is pickled once."""

    def __init__(self) -> None:
        self._kept: OrderedDict[int, tuple[Blueprint, Shared]] = OrderedDict()  # by identity

    def of(self, blueprint: Blueprint) -> Shared:
        key = id(blueprint)
        if key not in self._kept:
            self._kept[key] = blueprint, share(blueprint, _files(blueprint))
            if len(self._kept) > MOST_SHARED:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key][1]


def _files(blueprint: Blueprint) -> Iterator[str]:
    """The files that engines read: the meshes of collisions."""
    for robot in blueprint.prepared:
        for link in robot.lumped.links:
            for shape in link.collisions:
                if isinstance(shape.geometry, Mesh) and shape.geometry.path is not None:
                    yield shape.geometry.path


def limits_of(blueprint: Blueprint, seconds: float) -> Limits:
    """As `wsgen validate` has them: before each behavior the robots stand again."""
    simulated = seconds
    plan = blueprint.behavior_plan
    if plan is not None:
        simulated += plan.seconds + seconds * len(plan.behavior_runs)
    return Limits(seconds=RUN_SECONDS + SECONDS_A_SECOND * simulated)


WORTH = 20  # variants for each process, from which on opening the subject again pays


@dataclass(frozen=True, kw_only=True)
class Order:
    """What a process opens."""

    subject: SubjectRequest
    environment: Mapping[str, str]


def run_apart(  # noqa: PLR0913  what is run, where and how
    executor: RunExecutor,
    order: Order,
    blueprint_of: Callable[[Variant], Blueprint],
    variants: Iterable[Variant],
    *,
    seconds: float,
    engine: str,
    limits: Limits,
    count: int,
) -> Generator[Row, None, None]:
    """Prepare and run variants in the processes of an executor; give a row each as it ends.

    The rows are those of `run_all`, which runs what ends its process.

    Args:
        executor: Its processes see the files of this machine.
        order: What is swept.
        blueprint_of: As for `run_all`.
        variants: In the order in which they are begun.
        seconds: Simulated time of each.
        engine: A key of `ENGINES`.
        limits: Of a run and its preparation.
        count: How many variants these are, at least.
    """
    shared: Any = share(order)  # a function that is called gets the value
    doomed: list[Variant] = []

    def submit(order: Any, variants: Sequence[Variant]) -> Future[Any]:
        return executor.submit(
            prepare_and_run,
            order,
            variants,
            seconds,
            engine,
            _longest_call(executor),
            limits=limits,
            attempts=1,
        )

    def doom(_: object, variant: Variant, __: Died) -> Iterable[Row]:
        doomed.append(variant)
        return ()

    calls = _Calls(executor, submit, doom)
    batch: list[Variant] = []
    try:
        for number, variant in enumerate(variants):
            batch.append(variant)
            if len(batch) >= _batch_size(executor, count - number):
                yield from calls.begin(shared, batch)
                batch = []
        if batch:
            yield from calls.begin(shared, batch)
        yield from calls.rest()
    finally:
        calls.cancel()
    yield from run_all(executor, blueprint_of, doomed, seconds=seconds, engine=engine)


_opened: list[tuple[Order, Subject, ExitStack]] = []  # at most one


def _open(order: Order) -> Subject:
    if not _opened or _opened[0][0] is not order:
        while _opened:
            _opened.pop()[2].close()
        folder = scratch_folder()
        if folder is not None:  # it is removed with all in it, however this process ends
            tempfile.tempdir = str(folder)
        stack = ExitStack()
        subject = stack.enter_context(open_subject(order.subject, environment=order.environment))
        _opened.append((order, subject, stack))
    return _opened[0][1]


def prepare_and_run(
    order: Order, variants: Sequence[Variant], seconds: float, engine: str, longest: float
) -> list[Row]:
    """In a child: prepare and simulate variants one after the other.

    None is begun after `longest` seconds of wall-clock time. Gives the rows of those that were
    simulated: at least of the first one.
    """
    subject = _open(order)

    def run(variant: Variant) -> Row:
        blueprint = subject.prepare(variant.values)
        if can_run(blueprint):
            return run_variant(blueprint, variant, seconds, engine)
        return row_without_run(blueprint, variant)

    return rows_until(longest, variants, run)

"""Run the variants of a sweep on an executor, and give their rows as they end."""

from __future__ import annotations

import queue
from collections import OrderedDict
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.isolation.codec import decode
from wsgen.isolation.result import Limits
from wsgen.model.robot import Mesh
from wsgen.model.sweep import Row
from wsgen.sweeping.executors.child import ChildDiedError
from wsgen.sweeping.executors.shared import Shared, share
from wsgen.sweeping.run_variant import can_run, row_of_death, row_without_run, run_variants

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
    from concurrent.futures import Future

    from wsgen.model.sweep import Variant
    from wsgen.sweeping.blueprint import Blueprint


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
    """What `run_all` needs of an executor; see `wsgen.sweeping.executors`."""

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
        engine: A key of `ENGINE_NAMES`.
        count: How many variants these are, at least: of many, some go into one call.
    """
    runs = _Runs(executor, seconds, engine)
    batch: list[Variant] = []
    made: Blueprint | None = None
    try:
        for number, variant in enumerate(variants):
            blueprint = blueprint_of(variant)
            if not can_run(blueprint):
                yield row_without_run(blueprint, variant)
                continue
            if made is not None and batch and blueprint is not made:
                yield from runs.begin(made, batch)
                batch = []
            made = blueprint
            batch.append(variant)
            # The last calls are short ones, so that all processes end at about the same time.
            if len(batch) >= min(MOST_IN_A_CALL, (count - number) // (2 * executor.window)):
                yield from runs.begin(made, batch)
                batch = []
        if made is not None and batch:
            yield from runs.begin(made, batch)
        while runs.running:
            yield from runs.next_rows()
    finally:
        runs.cancel()


class _Runs:
    """The calls that are under way."""

    def __init__(self, executor: RunExecutor, seconds: float, engine: str) -> None:
        self.running: dict[Future[Any], tuple[Sequence[Variant], Blueprint]] = {}
        self._executor = executor
        self._seconds = seconds
        self._engine = engine
        self._ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self._shared = _Shared()

    def begin(self, blueprint: Blueprint, variants: Sequence[Variant]) -> Iterator[Row]:
        """Submit variants when there is room; give the rows that end until then."""
        while len(self.running) >= self._executor.window:
            yield from self.next_rows()
        self._submit(blueprint, variants)

    def _submit(self, blueprint: Blueprint, variants: Sequence[Variant]) -> None:
        future = self._executor.submit(
            run_variants,
            self._shared.of(blueprint),
            variants,
            self._seconds,
            self._engine,
            max(LONGEST_CALL, LONGEST_CALL_A_CALL * self._executor.window),
            limits=limits_of(blueprint, self._seconds),
        )
        self.running[future] = variants, blueprint
        future.add_done_callback(self._ended.put)

    def next_rows(self) -> Iterator[Row]:
        """Give the rows of the next call that ends; what it has left goes into another one."""
        future: Future[Any] | None = None
        while future is None:
            with suppress(queue.Empty):
                future = self._ended.get(timeout=WAKE_EVERY)
        variants, blueprint = self.running.pop(future)
        try:
            rows = decode(future.result(), tuple[Row, ...])
        except ChildDiedError as error:
            if len(variants) == 1:
                death = error.death
                yield row_of_death(blueprint, variants[0], self._seconds, self._engine, death)
                return
            for variant in variants:  # to find out which one it is
                self._submit(blueprint, [variant])
            return
        if len(rows) < len(variants):
            self._submit(blueprint, variants[len(rows) :])
        yield from rows

    def cancel(self) -> None:
        """Begin nothing that has not begun."""
        for future in self.running:
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

"""Run the variants of a sweep on an executor, and give their rows as they end."""

from __future__ import annotations

import queue
from collections import OrderedDict
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.executors.child import ChildDiedError
from wsgen.executors.shared import Shared, share
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Limits
from wsgen.model.robot import Mesh
from wsgen.model.sweep import Row
from wsgen.sweeping.run_variant import can_run, row_of_death, row_without_run, run_variant

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator
    from concurrent.futures import Future

    from wsgen.model.sweep import Variant
    from wsgen.sweeping.blueprint import Blueprint


WAKE_EVERY = 0.2  # s; a signal that another thread receives is handled when this one wakes
MOST_SHARED = 8  # blueprints that are kept pickled, the last that were used

# CPU time that a run may take. Large robots are slower than real time; the limit is for an engine
# that hangs.
RUN_SECONDS = 60.0
SECONDS_A_SECOND = 20.0  # more for each that is simulated


class RunExecutor(Protocol):
    """What `run_all` needs of an executor; see `wsgen.executors`."""

    @property
    def window(self) -> int:
        """How many runs should be submitted at a time."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a function called, within the `limits` that are given by keyword."""


def run_all(
    executor: RunExecutor,
    blueprint_of: Callable[[Variant], Blueprint],
    variants: Iterable[Variant],
    *,
    seconds: float,
    engine: str,
) -> Generator[Row, None, None]:
    """Run variants for so many simulated seconds in an engine; give a row each as it ends.

    No more blueprints are asked for than are about to run; one that has no robot to simulate
    becomes a row at once. A variant that ends each process that computes it is a row that says so.
    """
    ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
    running: dict[Future[Any], tuple[Variant, Blueprint]] = {}
    shared = _Shared()
    try:
        for variant in variants:
            blueprint = blueprint_of(variant)
            if not can_run(blueprint):
                yield row_without_run(blueprint, variant)
                continue
            while len(running) >= executor.window:
                yield _next_row(ended, running, seconds, engine)
            future = executor.submit(
                run_variant,
                shared.of(blueprint),
                variant,
                seconds,
                engine,
                limits=_limits(blueprint, seconds),
            )
            running[future] = variant, blueprint
            future.add_done_callback(ended.put)
        while running:
            yield _next_row(ended, running, seconds, engine)
    finally:
        for future in running:
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


def _next_row(
    ended: queue.SimpleQueue[Future[Any]],
    running: dict[Future[Any], tuple[Variant, Blueprint]],
    seconds: float,
    engine: str,
) -> Row:
    """The row of the next run that ends."""
    future: Future[Any] | None = None
    while future is None:
        with suppress(queue.Empty):
            future = ended.get(timeout=WAKE_EVERY)
    variant, blueprint = running.pop(future)
    try:
        return decode(future.result(), Row)
    except ChildDiedError as error:
        return row_of_death(blueprint, variant, seconds, engine, error.death)


def _limits(blueprint: Blueprint, seconds: float) -> Limits:
    """As `wsgen validate` has them: before each behavior the robots stand again."""
    simulated = seconds
    plan = blueprint.behavior_plan
    if plan is not None:
        simulated += plan.seconds + seconds * len(plan.behavior_runs)
    return Limits(seconds=RUN_SECONDS + SECONDS_A_SECOND * simulated)

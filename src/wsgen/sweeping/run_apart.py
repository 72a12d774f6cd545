"""Variants of the robot itself, prepared where they are run: each process opens the subject.

Expanding a robot takes up to a third of the time of its run. One process that prepares all variants
keeps few others busy.
"""

from __future__ import annotations

import queue
import tempfile
import time
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import scratch_folder
from wsgen.isolation.codec import decode
from wsgen.model.sweep import Row
from wsgen.sweeping.executors.child import ChildDiedError
from wsgen.sweeping.executors.shared import share
from wsgen.sweeping.run_variant import can_run, row_without_run, run_variant
from wsgen.sweeping.runner import (
    LONGEST_CALL,
    LONGEST_CALL_A_CALL,
    MOST_IN_A_CALL,
    WAKE_EVERY,
    run_all,
)
from wsgen.sweeping.subjects import open_subject
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
    from concurrent.futures import Future

    from wsgen.isolation.result import Limits
    from wsgen.model.sweep import Variant
    from wsgen.sweeping.blueprint import Blueprint
    from wsgen.sweeping.executors.shared import Shared
    from wsgen.sweeping.runner import RunExecutor
    from wsgen.sweeping.subject import Subject, SubjectRequest


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
        engine: A key of `ENGINE_NAMES`.
        limits: Of a run and its preparation.
        count: How many variants these are, at least.
    """
    runs = _Runs(executor, share(order), seconds, engine, limits)
    doomed: list[Variant] = []
    batch: list[Variant] = []
    try:
        for number, variant in enumerate(variants):
            batch.append(variant)
            if len(batch) >= min(MOST_IN_A_CALL, (count - number) // (2 * executor.window)):
                while len(runs.running) >= executor.window:
                    yield from runs.next_rows(doomed)
                runs.submit(batch)
                batch = []
        if batch:
            runs.submit(batch)
        while runs.running:
            yield from runs.next_rows(doomed)
    finally:
        runs.cancel()
    yield from run_all(executor, blueprint_of, doomed, seconds=seconds, engine=engine)


class _Runs:
    """The calls that are under way."""

    def __init__(
        self,
        executor: RunExecutor,
        order: Shared,
        seconds: float,
        engine: str,
        limits: Limits,
    ) -> None:
        self.running: dict[Future[Any], Sequence[Variant]] = {}
        self._executor = executor
        self._order: Any = order  # a function that is called gets the value
        self._seconds = seconds
        self._engine = engine
        self._limits = limits
        self._ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()

    def submit(self, variants: Sequence[Variant]) -> None:
        """Have variants prepared and run."""
        future = self._executor.submit(
            prepare_and_run,
            self._order,
            variants,
            self._seconds,
            self._engine,
            max(LONGEST_CALL, LONGEST_CALL_A_CALL * self._executor.window),
            limits=self._limits,
            attempts=1,
        )
        self.running[future] = variants
        future.add_done_callback(self._ended.put)

    def next_rows(self, doomed: list[Variant]) -> Sequence[Row]:
        """Give the rows of the next call that ends; a variant that ended its process is doomed."""
        future: Future[Any] | None = None
        while future is None:
            with suppress(queue.Empty):
                future = self._ended.get(timeout=WAKE_EVERY)
        variants = self.running.pop(future)
        try:
            rows = decode(future.result(), tuple[Row, ...])
        except ChildDiedError:
            if len(variants) == 1:
                doomed += variants
            else:
                for variant in variants:
                    self.submit([variant])
            return ()
        if len(rows) < len(variants):
            self.submit(variants[len(rows) :])
        return rows

    def cancel(self) -> None:
        """Begin nothing that has not begun."""
        for future in self.running:
            future.cancel()


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
    until = time.monotonic() + longest
    rows: list[Row] = []
    for variant in variants:
        if rows and time.monotonic() > until:
            break
        blueprint = subject.prepare(variant.values)
        if can_run(blueprint):
            rows.append(run_variant(blueprint, variant, seconds, engine))
        else:
            rows.append(row_without_run(blueprint, variant))
    return rows

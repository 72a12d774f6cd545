"""Run calls that wait for child processes, several at a time."""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Executor

    from wsgen.events import OneAtATime
    from wsgen.isolation.parent import Run

    Result = TypeVar("Result")


# s; a signal that another thread receives is handled when this one wakes.
WAKE_EVERY = 0.2


def run_parallel(
    calls: Callable[[Run], Sequence[Callable[[], Result]]],
    jobs: int,
    serial: OneAtATime,
    ended: list[Result],
    *,
    in_workers: bool = False,
) -> None:
    """Run calls, `jobs` at a time, with child processes that share their start.

    `calls` makes them, with what runs their child processes. Their results are added to `ended` in
    this order, also when the calls are interrupted. `serial` receives no event afterwards.

    With `in_workers`, several jobs are processes where the system has them (Linux), and children of
    launch files are forked from this one: for calls that do most of their work themselves, change
    nothing that others see, and return what can be pickled. Then `calls` is called in each of them.
    """
    if in_workers and jobs > 1:
        from wsgen.isolation import system  # noqa: PLC0415  for several jobs
        from wsgen.pipeline.workers import run_in_workers  # noqa: PLC0415  same

        if system.can_fork():
            results: dict[int, Result] = {}
            try:
                count = run_in_workers(calls, jobs, serial, start_children, results)
                if len(results) < count:
                    with start_children() as run:
                        for index, call in enumerate(calls(run)):
                            if index not in results:  # it raises again what it has raised
                                results[index] = call()
            finally:
                serial.close()
                ended += [results[index] for index in sorted(results)]
            return
    _run_in_threads(calls, jobs, serial, ended, is_forked=in_workers)


@contextmanager
def start_children() -> Iterator[Run]:
    """What runs child processes that share their start, for calls one after the other."""
    from wsgen.isolation.fork_server import ForkServer  # noqa: PLC0415  of no use for one
    from wsgen.launching.evaluate import PlainLaunches  # noqa: PLC0415  same

    with ForkServer() as fork_server, PlainLaunches(fork_server.run, is_forked=True) as launches:
        yield launches.run


def _run_in_threads(
    calls: Callable[[Run], Sequence[Callable[[], Result]]],
    jobs: int,
    serial: OneAtATime,
    ended: list[Result],
    *,
    is_forked: bool,
) -> None:
    from wsgen.isolation.fork_server import ForkServer  # noqa: PLC0415  of no use for one
    from wsgen.launching.evaluate import PlainLaunches  # noqa: PLC0415  same

    # Leaving these ends the children for which the threads wait.
    fork_server = ForkServer()
    with ExitStack() as stack:
        launches = stack.enter_context(PlainLaunches(fork_server.run, is_forked=is_forked))
        pool = _thread_pool(stack, jobs)
        stack.enter_context(fork_server)
        stack.callback(launches.end)
        todo = calls(launches.run)
        stack.callback(serial.close)  # what loses its child then has not failed
        if pool is None:
            for call in todo:
                ended.append(call())  # noqa: PERF401  they are there when one is interrupted
            return
        from concurrent.futures import FIRST_EXCEPTION, wait  # noqa: PLC0415  see `_thread_pool`

        running = [pool.submit(call) for call in todo]
        try:
            waiting = True
            while waiting:
                some = wait(running, timeout=WAKE_EVERY, return_when=FIRST_EXCEPTION)
                for future in some.done:
                    future.result()
                waiting = bool(some.not_done)
        finally:
            ended += [
                future.result()
                for future in running
                if future.done() and not future.cancelled() and future.exception() is None
            ]


def _thread_pool(stack: ExitStack, jobs: int) -> Executor | None:
    """Threads that wait for child processes; None for one job.

    When the stack is left early, no further job is started.
    """
    if jobs == 1:
        return None
    # Loaded only where it is used: it brings `logging`.
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415

    pool = ThreadPoolExecutor(max_workers=jobs)
    stack.callback(pool.shutdown, cancel_futures=True)
    return pool

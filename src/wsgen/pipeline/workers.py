"""Worker processes: forks of this process that run calls, and send back what these return.

Threads would take turns: most of a call is Python code of wsgen itself. Foreign code does not run
in a worker, but in the child processes that it starts, as elsewhere; so workers pickle what they
send.
"""

from __future__ import annotations

import gc
import os
import signal
import time
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing.connection import Connection, Pipe, wait
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TypeVar

from wsgen.events import post
from wsgen.isolation.system import end_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from contextlib import AbstractContextManager

    from wsgen.events import Event, OneAtATime
    from wsgen.isolation.parent import Run

    Result = TypeVar("Result")


SECONDS_TO_END = 10.0  # wall-clock, for a worker after SIGTERM
EVENT, RESULT, FAILURE = "event", "result", "failure"  # what a worker sends


def run_in_workers(
    calls: Callable[[Run], Sequence[Callable[[], Result]]],
    workers: int,
    serial: OneAtATime,
    start_runner: Callable[[], AbstractContextManager[Run]],
    results: dict[int, Result],
) -> int:
    """Run calls in so many worker processes; `results` gets what they return, by their index.

    The number of the calls comes back.

    What a call raises is not sent: a call without a result is to be run again by who wants to know.

    Args:
        calls: makes the calls, in each worker, with what runs their child processes.
        workers: at least 1.
        serial: receives the events of all workers. No event comes after the calls.
        start_runner: makes what runs child processes, in each worker.
        results: may already have some; these calls are not run.
    """
    count = len(calls(_run_nothing))
    todo = iter([index for index in range(count) if index not in results])
    with _fork_workers(workers, calls, serial, start_runner) as connections:
        waiting = {one for one in connections if _give(one, next(todo, None))}
        while waiting:
            for one in wait(waiting):
                assert isinstance(one, Connection)  # noqa: S101  for type checkers
                try:
                    what, *values = one.recv()
                except (EOFError, OSError):  # it was killed
                    waiting.discard(one)
                    continue
                if what == EVENT:
                    post(serial, values[0])
                    continue
                if what == RESULT:
                    results[values[0]] = values[1]
                if not _give(one, next(todo, None)):
                    waiting.discard(one)
    return count


def _run_nothing(*_arguments: object, **_keywords: object) -> NoReturn:
    raise RuntimeError("Only a worker process runs the calls.")


def _give(worker: Connection, index: int | None) -> bool:
    """Give a worker the next call, or let it end; whether it has one."""
    with suppress(OSError):  # it was killed
        worker.send(index)
        return index is not None
    return False


class _Worker(NamedTuple):
    pid: int
    connection: Connection


@contextmanager
def _fork_workers(
    count: int,
    calls: Callable[[Run], Sequence[Callable[[], Result]]],
    serial: OneAtATime,
    start_runner: Callable[[], AbstractContextManager[Run]],
) -> Iterator[list[Connection]]:
    """Fork workers; leaving the context ends those that have not ended."""
    ended = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    with ExitStack() as stack:
        pairs = [Pipe() for _ in range(count)]
        pipes = [os.pipe() for _ in range(count)]
        ours = [stack.enter_context(one) for one, _ in pairs]
        for _, end in pipes:
            stack.callback(os.close, end)
        workers: list[_Worker] = []
        # Those that are given an end of their pipe see it close: the last one's first.
        stack.callback(_end, workers)
        gc.freeze()  # otherwise a worker's collector writes to every object, which copies its page
        before: set[int] = signal.pthread_sigmask(signal.SIG_BLOCK, ended)
        try:
            for (_, theirs), (parent_death_pipe, _) in zip(pairs, pipes, strict=True):
                pid = os.fork()
                if pid == 0:
                    kept = (theirs.fileno(), parent_death_pipe)
                    _close_others(kept, pairs, pipes)
                    _work(theirs, parent_death_pipe, before, calls, serial, start_runner)
                workers.append(_Worker(pid, pairs[len(workers)][0]))
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            gc.unfreeze()
            for (_, theirs), (parent_death_pipe, _) in zip(pairs, pipes, strict=True):
                theirs.close()
                os.close(parent_death_pipe)
        yield ours
        for worker in workers:
            os.waitpid(worker.pid, 0)
        workers.clear()


def _close_others(
    kept: Sequence[int],
    pairs: Sequence[tuple[Connection, Connection]],
    pipes: Sequence[tuple[int, int]],
) -> None:
    """In a worker: close what belongs to the others, who could not see each other end."""
    for descriptor in (
        *(one.fileno() for pair in pairs for one in pair),
        *(one for pipe in pipes for one in pipe),
    ):
        if descriptor not in kept:
            os.close(descriptor)


def _work(  # noqa: PLR0913, PLR0917  all that a worker has
    connection: Connection,
    parent_death_pipe: int,
    signals: set[int],
    calls: Callable[[Run], Sequence[Callable[[], Result]]],
    serial: OneAtATime,
    start_runner: Callable[[], AbstractContextManager[Run]],
) -> NoReturn:
    """Be a worker: run the calls that are given, then end."""
    try:
        os.setpgid(0, 0)  # Ctrl-C interrupts the parent alone, which then ends its workers
        end_with_parent(parent_death_pipe, signal.SIGTERM)
        signal.pthread_sigmask(signal.SIG_SETMASK, signals)

        def send_event(event: Event) -> None:
            connection.send((EVENT, event))

        serial.listen(send_event)
        with start_runner() as run:
            todo = calls(run)
            while (index := connection.recv()) is not None:
                connection.send(_call(todo[index], index))
    except BaseException:  # noqa: BLE001, S110  a signal, or the parent has ended
        pass
    finally:
        os._exit(0)


def _call(call: Callable[[], Result], index: int) -> tuple[object, ...]:
    """What a worker sends of a call."""
    try:
        return RESULT, index, call()
    except Exception:  # noqa: BLE001  the parent runs it again
        return FAILURE, index


def _end(workers: Sequence[_Worker]) -> None:
    """End the workers, which end their children and remove their folders."""
    for worker in workers:
        with suppress(ProcessLookupError):
            os.kill(worker.pid, signal.SIGTERM)
    until = time.monotonic() + SECONDS_TO_END
    for worker in workers:
        while os.waitpid(worker.pid, os.WNOHANG)[0] == 0:
            if time.monotonic() > until:
                with suppress(ProcessLookupError):
                    os.kill(worker.pid, signal.SIGKILL)
                os.waitpid(worker.pid, 0)
                break
            time.sleep(0.01)

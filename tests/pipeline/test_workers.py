"""Calls in worker processes: their results, their events, and every way in which workers end."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import pytest

from wsgen.events import Event, OneAtATime, StepProgressed, post
from wsgen.isolation.parent import Run
from wsgen.pipeline.parallel import run_parallel

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux forks")

COUNT = 7


@pytest.fixture(autouse=True)
def _as_with_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads of the test runner do not matter: workers use nothing of them."""
    monkeypatch.setattr("wsgen.isolation.system.can_fork", lambda: True)


def run(
    call: Callable[[int], object], ended: list[object], heard: list[Event] | None = None
) -> OneAtATime:
    """Run a call for each of some numbers, in two workers."""
    serial = OneAtATime(None if heard is None else heard.append)

    def calls(_run: Run) -> Sequence[Callable[[], object]]:
        def one(number: int) -> object:
            post(serial, StepProgressed(step=("test",), detail=str(number)))
            return call(number)

        return [partial(one, number) for number in range(COUNT)]

    run_parallel(calls, 2, serial, ended, in_workers=True)
    return serial


def test_results_are_in_order_and_events_arrive() -> None:
    ended: list[object] = []
    heard: list[Event] = []
    run(lambda number: (number, os.getpid()), ended, heard)
    numbers, processes = zip(*ended, strict=True)
    assert numbers == tuple(range(COUNT))
    assert os.getpid() not in processes
    details = [one.detail for one in heard if isinstance(one, StepProgressed)]
    assert sorted(details) == [str(number) for number in range(COUNT)]


def test_nobody_listens() -> None:
    ended: list[object] = []
    run(str, ended)
    assert ended == [str(number) for number in range(COUNT)]


def test_what_a_call_raises_is_raised() -> None:
    ended: list[object] = []

    def fail(number: int) -> int:
        if number == 2:
            raise KeyError(number)
        return number

    with pytest.raises(KeyError, match="2"):
        run(fail, ended)
    assert set(ended) <= set(range(COUNT)) - {2}
    assert {0, 1} <= set(ended)


def test_a_call_whose_worker_is_killed_is_run_again() -> None:
    ended: list[object] = []
    here = os.getpid()

    def die(number: int) -> int:
        if number == 3 and os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    run(die, ended)
    assert ended == list(range(COUNT))


def test_all_workers_are_killed() -> None:
    ended: list[object] = []
    here = os.getpid()

    def die(number: int) -> int:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    run(die, ended)
    assert ended == list(range(COUNT))


def test_an_interruption_ends_the_workers(tmp_path: Path) -> None:
    ended: list[object] = []
    folder = str(tmp_path)

    def wait(number: int) -> int:
        if number < 2:
            return number
        Path(folder, str(os.getpid())).touch()
        signal.pause()
        return number

    def interrupt(event: Event) -> None:
        if isinstance(event, StepProgressed) and event.detail == "3":
            raise KeyboardInterrupt

    serial = OneAtATime(interrupt)
    calls = [partial(wait, number) for number in range(COUNT)]

    def make(_run: Run) -> Sequence[Callable[[], int]]:
        def one(call: Callable[[], int], number: int) -> int:
            post(serial, StepProgressed(step=("test",), detail=str(number)))
            return call()

        return [partial(one, call, number) for number, call in enumerate(calls)]

    with pytest.raises(KeyboardInterrupt):
        run_parallel(make, 2, serial, ended, in_workers=True)
    assert ended == [0, 1]
    for file in tmp_path.iterdir():
        assert not Path("/proc", file.name).exists()


def test_a_process_with_threads_is_not_forked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    event = threading.Event()
    thread = threading.Thread(target=event.wait)
    thread.start()
    try:
        ended: list[object] = []
        run(lambda _number: os.getpid(), ended)
        assert set(ended) == {os.getpid()}
    finally:
        event.set()
        thread.join()

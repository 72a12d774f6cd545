"""Calls in isolated children of this machine."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from concurrent.futures import CancelledError, as_completed
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from sweeping import calls
from sweeping.processes import have_ended, wait_for
from wsgen.isolation.result import Limits
from wsgen.sweeping.children import MOST_KEPT, ChildDiedError, LocalExecutor, share

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


@pytest.fixture(scope="module")
def executor() -> Iterator[LocalExecutor]:
    with LocalExecutor(1) as made:
        yield made


def test_calls_are_computed_by_one_child_that_stays(executor: LocalExecutor) -> None:
    futures = [executor.submit(calls.double, number) for number in range(5)]
    assert sorted(future.result() for future in as_completed(futures)) == [0, 2, 4, 6, 8]
    first, second = (executor.submit(calls.own_id).result() for _ in range(2))
    assert first == second != os.getpid()


@pytest.mark.slow
def test_shared_arguments_are_sent_once_to_each_child(executor: LocalExecutor) -> None:
    shared = share({"text": "x" * 1000})
    assert executor.submit(calls.length, shared).result() == 1000
    first = executor.submit(calls.identity_of, shared).result()
    assert executor.submit(calls.identity_of, share({"text": "x" * 1000})).result() == first


@pytest.mark.slow
def test_few_shared_arguments_are_kept(executor: LocalExecutor) -> None:
    values = [share({"text": "x" * number}) for number in range(2 * MOST_KEPT)]
    for _ in range(2):
        lengths = [executor.submit(calls.length, one).result() for one in values]
        assert lengths == list(range(2 * MOST_KEPT))


@pytest.mark.slow
def test_a_call_is_made_again_where_its_child_dies(executor: LocalExecutor, tmp_path: Path) -> None:
    before = executor.submit(calls.own_id).result()
    after = executor.submit(calls.crash_first, str(tmp_path / "crashed")).result()
    assert after != before


@pytest.mark.slow
def test_a_call_that_ends_three_children_is_given_up(
    executor: LocalExecutor, tmp_path: Path
) -> None:
    marker = tmp_path / "crashes"
    with pytest.raises(ChildDiedError) as caught:
        executor.submit(calls.crash_and_count, str(marker)).result()
    assert caught.value.death.reason == "crashed (SIGSEGV)"
    assert marker.read_text() == "xxx"
    assert executor.submit(calls.double, 4).result() == 8


@pytest.mark.slow
def test_what_a_call_raises_is_reported(executor: LocalExecutor) -> None:
    with pytest.raises(ChildDiedError, match="ValueError: It is wrong"):
        executor.submit(calls.wrong).result()


@pytest.mark.slow
def test_a_call_has_its_limits(executor: LocalExecutor) -> None:
    limits = Limits(seconds=1.0, wall_clock=600.0)  # on a busy machine
    with pytest.raises(ChildDiedError) as caught:
        executor.submit(calls.work_without_end, limits=limits).result()
    assert caught.value.death.cause == "cpu time"
    with pytest.raises(ChildDiedError) as caught:
        executor.submit(calls.grow).result()
    assert caught.value.death.cause == "memory"
    assert executor.submit(calls.double, 1).result() == 2


@pytest.mark.slow
def test_two_jobs_have_two_children(tmp_path: Path) -> None:
    with LocalExecutor(2) as executor:
        marker = tmp_path / "numbers"
        waiting = executor.submit(calls.start_and_wait, str(marker))
        other = executor.submit(calls.own_id).result()
        numbers = wait_for(marker)
        assert other not in numbers
        executor.shutdown(wait=False)
        with pytest.raises(CancelledError):
            waiting.result()
    assert have_ended([*numbers, other])


@pytest.mark.slow
def test_an_exception_ends_what_runs(tmp_path: Path) -> None:
    marker = tmp_path / "numbers"

    def fail() -> None:
        with LocalExecutor(1) as executor:
            executor.submit(calls.start_and_wait, str(marker))
            executor.submit(calls.double, 1)
            numbers.extend(wait_for(marker))
            raise KeyboardInterrupt

    numbers: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        fail()
    assert have_ended(numbers)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_no_child_outlives_its_parent(number: int, tmp_path: Path) -> None:
    marker = tmp_path / "numbers"
    script = (
        "from sweeping import calls\n"
        "from wsgen.sweeping.children import LocalExecutor\n"
        "with LocalExecutor(1) as executor:\n"
        f"    executor.submit(calls.start_and_wait, {str(marker)!r}).result()\n"
    )
    tests = Path(__file__).parents[1]
    parent = subprocess.Popen(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(tests)},
        stderr=subprocess.DEVNULL,
    )
    try:
        numbers = wait_for(marker)
        parent.send_signal(number)
        parent.wait(300)
        assert have_ended(numbers)
    finally:
        parent.kill()
        parent.wait()

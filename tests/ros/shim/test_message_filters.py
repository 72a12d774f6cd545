"""Messages that belong together."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from message_filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, TimeSynchronizer


def message(seconds: float, name: str = "") -> Any:
    whole, rest = divmod(round(seconds * 10**9), 10**9)
    stamp = SimpleNamespace(sec=whole, nanosec=rest)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), at=seconds, name=name)


def collect(synchronizer: SimpleFilter) -> list[tuple[float, ...]]:
    found: list[tuple[float, ...]] = []
    synchronizer.registerCallback(lambda *messages: found.append(tuple(m.at for m in messages)))
    return found


def test_equal_times_belong_together() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    found = collect(TimeSynchronizer([left, right], 10))
    for seconds in (1.0, 2.0, 3.0):
        left.signalMessage(message(seconds))
    for seconds in (1.5, 2.0, 3.0):
        right.signalMessage(message(seconds))
    assert found == [(2.0, 2.0), (3.0, 3.0)]


def test_a_queue_forgets_the_oldest() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    found = collect(TimeSynchronizer([left, right], 2))
    for seconds in (1.0, 2.0, 3.0):
        left.signalMessage(message(seconds))
    right.signalMessage(message(1.0))
    right.signalMessage(message(2.0))
    assert found == [(2.0, 2.0)]


def test_times_may_differ_by_the_slop() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    found = collect(ApproximateTimeSynchronizer([left, right], 10, 0.1))
    left.signalMessage(message(1.0))
    right.signalMessage(message(1.2))
    left.signalMessage(message(1.25))
    right.signalMessage(message(1.03))
    assert found == [(1.25, 1.2), (1.0, 1.03)]


@pytest.mark.slow
@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 50)), max_size=40))
def test_what_is_passed_on_is_within_the_slop_and_used_once(order: list[tuple[int, int]]) -> None:
    filters = [SimpleFilter() for _ in range(3)]
    found = collect(ApproximateTimeSynchronizer(filters, 5, 0.5))
    for index, tenth in order:
        filters[index].signalMessage(message(tenth / 10))
    for times in found:
        assert max(times) - min(times) <= 0.5 + 1e-9


def test_a_message_that_is_older_than_a_full_queue_is_forgotten() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    found = collect(ApproximateTimeSynchronizer([left, right], 2, 1.0))
    right.signalMessage(message(0.5))
    for seconds in (5.0, 6.0, 0.4):
        left.signalMessage(message(seconds))
    assert found == []


def test_a_callback_gets_its_own_arguments() -> None:
    one, found = SimpleFilter(), []
    one.registerCallback(lambda *everything: found.append(everything), "more", 3)
    one.signalMessage("message")
    assert found == [("message", "more", 3)]


@pytest.mark.parametrize(("at", "before", "after"), [(0.5, None, 1), (2, 2, 2), (2.5, 2, 3)])
def test_a_cache_finds_neighbors(at: float, before: float | None, after: float) -> None:
    source = SimpleFilter()
    cache = Cache(source, 3)
    for seconds in (0, 3, 1, 2):  # the first one is forgotten
        source.signalMessage(message(seconds))
    stamp = SimpleNamespace(nanoseconds=round(at * 10**9))
    found = cache.getElemBeforeTime(stamp)
    assert (found and found.at) == before
    assert cache.getElemAfterTime(stamp).at == after
    assert cache.getLast().at == 3

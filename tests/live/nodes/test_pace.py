"""How simulated time goes with that of the clock on the wall."""

from __future__ import annotations

import pytest

from wsgen.live.nodes.simulator.timing import Pace, Timer, until_next


class Clock:
    """A clock that is set."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_simulated_time_waits_for_the_clock() -> None:
    clock = Clock()
    pace = Pace(0.5, clock)
    clock.now += 1.0
    assert pace.early(1.0) == pytest.approx(1.0)
    clock.now += 1.2
    assert pace.early(1.0) == 0.0
    # What is late is made up for: the rate holds over a minute.
    assert pace.early(1.5) == pytest.approx(0.8)
    assert pace.lost == 0.0


def test_what_is_too_late_is_given_up() -> None:
    clock = Clock()
    pace = Pace(1.0, clock)
    clock.now += 10.0
    assert pace.early(1.0) == 0.0
    assert pace.lost == pytest.approx(9.0)
    assert pace.early(1.5) == pytest.approx(0.5)


def test_time_begins_again_after_a_pause() -> None:
    clock = Clock()
    pace = Pace(1.0, clock)
    clock.now += 10.0
    pace.begin(3.0)
    assert pace.early(3.5) == pytest.approx(0.5)
    assert pace.lost == 0.0


def test_without_a_rate_nothing_waits() -> None:
    assert Pace(None, Clock()).early(1000.0) == 0.0


def test_a_machine_that_is_too_slow_is_named() -> None:
    clock = Clock()
    pace = Pace(1.0, clock)
    clock.now += 4.0
    assert pace.rate_reached(1.0) is None  # too early to say
    clock.now += 1.0
    assert pace.rate_reached(2.0) == pytest.approx(0.4)
    clock.now += 5.0
    assert pace.rate_reached(6.9) is None  # 0.98 since then
    assert Pace(None, clock).rate_reached(0.0) is None


def test_timers() -> None:
    timer, every = Timer(0.03, now=1.0), Timer(0.0, now=1.0)
    due = [now for now in (1.0, 1.01, 1.02, 1.03, 1.05, 1.06) if timer.is_due(now)]
    assert due == [1.0, 1.03, 1.06]
    assert until_next(1.06, timer) == pytest.approx(0.03)
    assert until_next(1.06, timer, every) == 0.0
    timer.is_due(5.0)  # what was missed is not made up for
    assert not timer.is_due(5.02)
    timer.reset(0.0)
    assert timer.is_due(0.0)

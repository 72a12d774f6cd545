"""How wheels turn, and where a robot is by them."""

from __future__ import annotations

import math

import pytest

from wsgen.live.nodes.simulator.plugins.wheels import WheelOdometry


def driven(left: float, right: float, seconds: float, step: float = 0.02) -> WheelOdometry:
    """An odometry whose wheels (radius 0.1 m, 0.4 m apart) turn at these speeds, rad/s."""
    odometry = WheelOdometry(0.4, 0.1, 0.1)
    for count in range(round(seconds / step) + 1):
        odometry.update(left * count * step, right * count * step, count * step)
    return odometry


def test_straight_ahead() -> None:
    odometry = driven(5.0, 5.0, 4.0)
    assert (odometry.x, odometry.y, odometry.heading) == pytest.approx((2.0, 0.0, 0.0), abs=1e-9)
    assert (odometry.linear, odometry.angular) == pytest.approx((0.5, 0.0), abs=1e-9)


def test_a_quarter_of_a_circle() -> None:
    # 0.5 m/s and 0.25 rad/s: a circle of 2 m.
    odometry = driven(4.5, 5.5, 2 * math.pi, step=2 * math.pi / 100)
    assert odometry.heading == pytest.approx(math.pi / 2)
    assert (odometry.x, odometry.y) == pytest.approx((2.0, 2.0))


def test_the_first_positions_are_where_it_begins() -> None:
    odometry = WheelOdometry(0.4, 0.1, 0.1)
    odometry.update(7.0, 9.0, 1.0)
    odometry.update(7.0, 9.0, 1.0)  # the time stands still
    assert (odometry.x, odometry.heading) == (0.0, 0.0)
    odometry.update(8.0, 10.0, 2.0)
    assert odometry.x == pytest.approx(0.1)
    odometry.reset()
    odometry.update(20.0, 20.0, 0.0)
    assert odometry.x == 0.0

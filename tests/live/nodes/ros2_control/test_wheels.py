"""Limits of speeds and odometry of diff_drive_controller."""

from __future__ import annotations

import math
from typing import Any

import pytest

from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters
from wsgen.live.nodes.simulator.ros2_control.wheels import Limits, WheelOdometry


def limits(*, is_former: bool = False, **values: Any) -> Limits:
    return Limits.read(
        Parameters({f"linear.x.{key}": value for key, value in values.items()}),
        "linear.x",
        is_former=is_former,
    )


def test_without_limits_every_speed_is_reached_at_once() -> None:
    assert limits().next(5.0, 0.0, 0.0, 0.01) == 5.0


def test_speed_and_acceleration_are_limited() -> None:
    some = limits(max_velocity=1.0, max_acceleration=2.0)
    assert some.next(5.0, 0.0, 0.0, 0.1) == pytest.approx(0.2)
    assert some.next(5.0, 0.95, 0.9, 0.1) == 1.0
    assert some.next(-5.0, 0.0, 0.0, 0.1) == pytest.approx(-0.2)
    assert some.next(0.0, 1.0, 1.0, 0.1) == pytest.approx(0.8)


def test_slowing_down_and_going_back_have_limits_of_their_own() -> None:
    some = limits(
        max_acceleration=1.0,
        max_deceleration=-4.0,
        max_acceleration_reverse=-2.0,
        max_deceleration_reverse=8.0,
    )
    assert some.next(0.0, 1.0, 1.0, 0.1) == pytest.approx(0.6)
    assert some.next(-1.0, -0.1, -0.1, 0.1) == pytest.approx(-0.3)
    assert some.next(0.0, -1.0, -1.0, 0.1) == pytest.approx(-0.2)


def test_those_of_humble_are_switched_on() -> None:
    values = {"max_velocity": 1.0, "max_acceleration": 2.0}
    assert limits(is_former=True, **values).next(5.0, 0.0, 0.0, 0.1) == 5.0
    on = limits(is_former=True, has_velocity_limits=True, has_acceleration_limits=True, **values)
    assert on.next(5.0, 0.0, 0.0, 0.1) == pytest.approx(0.2)


def test_jerk_is_limited() -> None:
    some = limits(max_jerk=1.0)
    assert some.next(5.0, 0.0, 0.0, 0.1) == pytest.approx(2 * 0.1 * 0.1)


def test_a_quarter_turn_by_positions() -> None:
    odometry = WheelOdometry(0.5, 0.1, 0.1, window=5)
    radius, turn = 1.0, math.pi / 2
    steps = 100
    for step in range(1, steps + 1):
        angle = turn * step / steps
        odometry.by_positions((radius - 0.25) * angle / 0.1, (radius + 0.25) * angle / 0.1, 0.01)
    assert (odometry.x, odometry.y) == pytest.approx((1.0, 1.0))
    assert odometry.heading == pytest.approx(turn)
    assert odometry.linear == pytest.approx(turn)
    assert odometry.angular == pytest.approx(turn)


def test_straight_by_velocities_and_by_commands() -> None:
    by_wheels, by_commands = (WheelOdometry(0.5, 0.1, 0.2, window=1) for _ in range(2))
    for _ in range(10):
        by_wheels.by_velocities(2.0, 1.0, 0.1)
        by_commands.by_commands(0.2, 0.0, 0.1)
    assert by_wheels.x == pytest.approx(0.2)
    assert by_wheels.y == 0.0
    assert by_commands.x == pytest.approx(0.2)

"""Trajectories: splines, which ones are taken, tolerances."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from wsgen.live.nodes.simulator.ros2_control.trajectory import (
    Accepted,
    Follower,
    Message,
    Outcome,
    Point,
    Tolerance,
    Tolerances,
    Trajectory,
    effective,
    nearest_turn,
)

STEP = 0.01  # s


def slope(trajectory: Trajectory, time: float, kind: str) -> float:
    """How fast a value of the first joint changes at a time."""
    small = 1e-6
    before, after = (
        getattr(trajectory.sample(time + side * small).point, kind)[0] for side in (-1, 1)
    )
    return float((after - before) / (2 * small))


def begun(points: list[Point], first: Point, **options: object) -> Trajectory:
    trajectory = Trajectory(points, **options)  # type: ignore[arg-type]
    trajectory.begin(10.0, first)
    return trajectory


def test_positions_alone_are_joined_by_lines() -> None:
    trajectory = begun([Point([1.0], seconds=1.0), Point([0.0], seconds=3.0)], Point([0.0]))
    assert trajectory.sample(10.25).point.positions == [0.25]
    assert trajectory.sample(12.0).point.positions == [0.5]
    assert trajectory.sample(12.0).point.velocities == [-0.5]
    assert [trajectory.sample(time).next for time in (10.5, 11.5, 13.0)] == [0, 1, 2]
    assert trajectory.sample(20.0).point.positions == [0.0]


@pytest.mark.parametrize("has_acceleration", [False, True])
def test_splines_have_the_derivatives_that_the_points_say(has_acceleration: bool) -> None:
    def point(position: float, speed: float, rate: float, seconds: float = 0.0) -> Point:
        return Point([position], [speed], [rate] if has_acceleration else [], seconds=seconds)

    trajectory = begun(
        [point(1.0, 0.3, -0.2, 1.0), point(-0.5, 0.0, 0.1, 2.5)], point(0.2, 0.1, 0.4)
    )
    for time, wanted in ((10.0, 0.1), (11.0, 0.3)):
        found = trajectory.sample(time).point
        assert found.velocities[0] == pytest.approx(wanted)
        if has_acceleration:
            assert found.accelerations[0] == pytest.approx({10.0: 0.4, 11.0: -0.2}[time])
    assert trajectory.sample(11.0).point.positions[0] == pytest.approx(1.0)
    assert trajectory.sample(12.5 - 1e-9).point.positions[0] == pytest.approx(-0.5)
    assert trajectory.sample(12.5 - 1e-9).point.velocities[0] == pytest.approx(0.0, abs=1e-7)
    for time in (10.3, 11.7):
        found = trajectory.sample(time).point
        assert slope(trajectory, time, "positions") == pytest.approx(found.velocities[0])
        assert slope(trajectory, time, "velocities") == pytest.approx(
            found.accelerations[0], rel=1e-4
        )


def test_cubic_spline_has_the_known_middle() -> None:
    trajectory = begun([Point([1.0], [0.0], seconds=2.0)], Point([0.0], [0.0]))
    assert trajectory.sample(11.0).point.positions[0] == pytest.approx(0.5)
    assert trajectory.sample(11.0).point.velocities[0] == pytest.approx(0.75)


def test_a_start_in_the_header_is_kept() -> None:
    trajectory = begun([Point([1.0], seconds=1.0)], Point([0.0]), start=12.0)
    assert trajectory.sample(11.5).point.positions == [0.5]
    assert trajectory.end == 13.0


def test_positions_are_deduced_from_velocities() -> None:
    trajectory = begun([Point([], [1.0], seconds=1.0), Point([], [1.0], seconds=2.0)], Point([0.0]))
    assert trajectory.sample(13.0).point.positions == [1.5]


def test_without_interpolation_each_point_is_a_step() -> None:
    points = [Point([1.0], seconds=1.0), Point([2.0], seconds=2.0)]
    trajectory = begun(points, Point([0.0]), interpolates=False)
    assert [trajectory.sample(time).point.positions[0] for time in (10.5, 11.5)] == [0.0, 2.0]


def test_wheels_and_turrets_go_the_short_way() -> None:
    trajectory = begun([Point([3.0], seconds=1.0)], Point([-3.0]), wraps=[True])
    assert trajectory.sample(10.0).point.positions[0] == pytest.approx(math.tau - 3.0)
    assert nearest_turn(0.0, math.pi) == pytest.approx(0.0)


ACCEPTED = Accepted(joints=("a", "b"))


def message(
    *points: Point, joints: tuple[str, ...] = ("b", "a"), start: float | None = None
) -> Message:
    return Message(joints, points, start)


@pytest.mark.parametrize(
    ("accepted", "sent", "reason"),
    [
        (ACCEPTED, message(Point([1, 2], seconds=1)), None),
        (ACCEPTED, message(Point([1], seconds=1), joints=("a",)), "don't match"),
        (
            replace(ACCEPTED, allows_partial=True),
            message(Point([1], seconds=1), joints=("a",)),
            None,
        ),
        (ACCEPTED, message(), "Empty trajectory"),
        (ACCEPTED, message(Point([1, 2]), joints=("a", "c")), "joint c doesn't match"),
        (ACCEPTED, message(Point([1, 2]), start=5.0), "ends in the past"),
        (ACCEPTED, message(Point([1, 2], seconds=9.0), start=5.0), None),
        (
            ACCEPTED,
            message(Point([1, 2], seconds=1), Point([1, 2], seconds=1)),
            "not strictly increasing",
        ),
        (ACCEPTED, message(Point([1])), "Mismatch between joint_names size (2) and positions (1)"),
        (ACCEPTED, message(Point([1, 2], [1])), "velocities (1) at point #0"),
        (ACCEPTED, message(Point([], [1, 2])), "positions (0)"),
        (replace(ACCEPTED, allows_integration=True), message(Point([], [1, 2])), None),
        (ACCEPTED, message(Point([1, math.nan])), "not a finite number"),
        (replace(ACCEPTED, allows_moving_end=False), message(Point([1, 2], [0, 1])), "is not zero"),
        (ACCEPTED, message(Point([1, 2], effort=[1, 2])), "effort fields"),
    ],
)
def test_trajectories_are_refused_as_the_real_controller_refuses_them(
    accepted: Accepted, sent: Message, reason: str | None
) -> None:
    refusal = accepted.refusal(sent, now=10.0)
    if reason is None:
        assert refusal is None
    else:
        assert reason in (refusal or "")


def test_joints_are_sorted_and_missing_ones_stay() -> None:
    (point,) = ACCEPTED.in_order(message(Point([1, 2], [3, 4])), {"a": 0.0, "b": 0.0})
    assert (point.positions, point.velocities) == ([2, 1], [4, 3])
    (point,) = ACCEPTED.in_order(message(Point([1], [3]), joints=("b",)), {"a": 0.7, "b": 0.0})
    assert (point.positions, point.velocities) == ([0.7, 1], [0.0, 3])


def follower(path: float = 0.0, goal: float = 0.0, goal_seconds: float = 0.0) -> Follower:
    tolerances = Tolerances([Tolerance(path)], [Tolerance(goal)], goal_seconds)
    made = Follower([False], STEP, tolerances)
    made.hold([0.0])
    return made


def run(
    made: Follower, lag: float, seconds: float = 3.0, share: float = 1.0
) -> tuple[float, Outcome | None]:
    """Follow with joints that stay behind; when it ends, and how."""
    now, position = 0.0, 0.0
    while now < seconds:
        step = made.update(now, STEP, Point([position]))
        if step.outcome is not None:
            return now, step.outcome
        position = share * (step.command.positions[0] - lag)
        now = round(now + STEP, 9)
    return now, None


def test_a_goal_is_reached_at_its_end() -> None:
    made = follower(path=0.1, goal=0.01)
    made.follow(Trajectory([Point([1.0], seconds=1.0)]))
    made.has_goal = True
    time, outcome = run(made, lag=0.0)
    assert outcome is Outcome.REACHED
    assert time == pytest.approx(1.0, abs=2 * STEP)


def test_a_joint_that_does_not_follow_violates_the_path() -> None:
    made = follower(path=0.1)
    made.follow(Trajectory([Point([1.0], seconds=1.0)]))
    time, outcome = run(made, lag=0.0, share=0.5)
    assert outcome is Outcome.OFF_PATH
    assert 0.15 < time < 0.3


def test_a_joint_that_stays_behind_misses_the_goal_after_its_time() -> None:
    made = follower(goal=0.01, goal_seconds=0.5)
    made.follow(Trajectory([Point([1.0], seconds=1.0)]))
    made.has_goal = True
    time, outcome = run(made, lag=0.05)
    assert outcome is Outcome.OFF_GOAL
    assert time == pytest.approx(1.5, abs=3 * STEP)


def test_without_a_time_the_goal_is_waited_for() -> None:
    made = follower(goal=0.01)
    made.follow(Trajectory([Point([1.0], seconds=1.0)]))
    made.has_goal = True
    assert run(made, lag=0.05) == (3.0, None)


def test_holding_asks_for_nothing_and_says_what_is_off() -> None:
    made = follower(path=0.001, goal=0.001)
    for now in range(5):
        step = made.update(now * STEP, STEP, Point([0.5]))
        assert step.outcome is None
        assert step.command.positions == [0.0]
        assert step.errors.positions == [-0.5]


def test_speeds_count_where_they_are_controlled() -> None:
    tolerances = Tolerances([Tolerance()], [Tolerance(0.1, 0.01)])
    for compares, wanted in ((False, Outcome.REACHED), (True, None)):
        made = Follower([False], STEP, tolerances, compares_velocities=compares)
        made.follow(Trajectory([Point([0.0], [0.0], seconds=STEP)]))
        made.has_goal = True
        found = [made.update(n * STEP, STEP, Point([0.0], [0.5])).outcome for n in range(5)]
        assert (wanted in found) is True
        if wanted is None:
            assert set(found) == {None}


def test_a_command_times_out() -> None:
    made = Follower([False], STEP, Tolerances([Tolerance()], [Tolerance()]), timeout=0.5)
    made.follow(Trajectory([Point([1.0], seconds=1.0)]))
    time, outcome = run(made, lag=0.0)
    assert outcome is Outcome.TIMED_OUT
    assert time == pytest.approx(1.5, abs=3 * STEP)


def test_tolerances_of_a_goal() -> None:
    assert effective(0.1, 0.0) == 0.1
    assert effective(0.1, 0.5) == 0.5
    assert effective(0.1, -1.0) == 0.0
    with pytest.raises(ValueError, match=r"-0\.5"):
        effective(0.1, -0.5)

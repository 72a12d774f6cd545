"""`wsgen topic hz` computes and prints as `ros2 topic hz`."""

from __future__ import annotations

from wsgen.live.nodes.messages import Rates, one_topic, table


def test_a_steady_rate() -> None:
    rates = Rates()
    assert rates.row() is None
    for step in range(11):
        assert rates.take(5.0 + step * 0.125)
    row = rates.row()
    assert row == ("8.000", "0.125", "0.125", "0.00000", "10")
    assert rates.row() is None  # nothing came since
    assert one_topic(row) == (
        "average rate: 8.000\n\tmin: 0.125s max: 0.125s std dev: 0.00000s window: 10"
    )


def test_the_window_forgets_and_time_may_go_back() -> None:
    rates = Rates(window=2)
    for now in (0.0, 5.0, 6.0, 7.0):
        rates.take(now)
    assert rates.row() == ("1.000", "1.000", "1.000", "0.00000", "2")
    assert not rates.take(1.0)
    rates.take(1.5)
    assert rates.row() == ("2.000", "0.500", "0.500", "0.00000", "1")


def test_messages_at_one_time_have_no_rate() -> None:
    rates = Rates()
    rates.take(1.0)
    rates.take(1.0)
    assert rates.row() == ("0.000", "0.000", "0.000", "0.00000", "1")


def test_a_table_of_topics() -> None:
    row = ("8.000", "0.125", "0.125", "0.00000", "10")
    lines = table([("/scan", *row), ("/odometry", *row)]).splitlines()
    assert lines[0].split() == ["topic", "rate", "min_delta", "max_delta", "std_dev", "window"]
    assert set(lines[1]) == {"="}
    assert lines[3] == "/odometry   8.000   0.125       0.125       0.00000   10    "

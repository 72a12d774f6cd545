"""Rules over what a robot does while its launch file runs, with facts alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from wsgen.checks.rules.behaviors import check_live, launch_not_run
from wsgen.diagnostics import Severity
from wsgen.model.behavior import Behavior, LaunchTask, LiveMeasurement

FILE = Path("wsgen.toml")


def measured(**values: Any) -> LiveMeasurement:
    return LiveMeasurement(
        **{
            "name": "wanders",
            "launched": "roamer drive.launch.py x:=1",
            "seconds": 4.0,
            "is_there": True,
            "moved": (1.0, 0.0, 0.0),
            "traveled": 1.2,
            "positions": {"lift": 0.5},
            **values,
        }
    )


@pytest.mark.parametrize(
    ("task", "values", "codes"),
    [
        (LaunchTask(), {}, []),
        (LaunchTask(x=1.0, travels=1.0, positions={"lift": 0.5}), {}, []),
        (LaunchTask(x=2.0), {}, ["SPN085"]),
        (LaunchTask(yaw=1.0), {}, ["SPN086"]),
        (LaunchTask(travels=2.0), {}, ["SPN101"]),
        (LaunchTask(positions={"lift": 1.0}), {}, ["SPN087"]),
        (LaunchTask(positions={"arm": 1.0}), {"entity": "truck"}, ["SPN099"]),
        (LaunchTask(), {"tilt": 1.5}, ["SPN100"]),
        (LaunchTask(), {"tilt": 0.4}, []),  # it stands on a ramp
        (LaunchTask(x=2.0), {"is_there": False}, ["SPN099"]),
        (LaunchTask(x=2.0), {"is_there": False, "is_finite": False}, ["SPN088"]),
        (LaunchTask(x=2.0), {"is_finite": False}, ["SPN088"]),
        (
            LaunchTask(x=2.0),
            {"problem": "The process a-1 has failed: E: no."},
            ["SPN099"],
        ),
    ],
)
def test_what_is_reported(task: LaunchTask, values: dict[str, Any], codes: list[str]) -> None:
    behavior = Behavior(name="wanders", task=task, seconds=4.0, line=7)
    found = check_live(behavior, task, measured(**values), FILE)
    assert [one.code for one in found] == codes
    for one in found:
        assert (one.file, one.line, one.element) == (FILE, 7, "behavior `wanders`")
        assert one.message.startswith("`wanders`: ")
        assert one.hint
        is_command = "wsgen launch roamer drive.launch.py x:=1 --run" in one.hint
        assert is_command == (one.code not in {"SPN088", "SPN100"})


def test_a_failure_is_named_with_its_time() -> None:
    behavior = Behavior(name="wanders", task=LaunchTask(), seconds=4.0)
    problem = "The process a-1 has failed (exit code 1): ValueError: no, in /a.py:3"
    (found,) = check_live(behavior, LaunchTask(), measured(problem=problem, seconds=1.25), FILE)
    assert found.message == (
        "`wanders`: after 1.25 simulated s: the process a-1 has failed (exit code 1): ValueError: "
        "no, in /a.py:3."
    )


def test_a_robot_that_was_deleted_has_not_exploded_for_sure() -> None:
    behavior = Behavior(name="wanders", task=LaunchTask(), seconds=4.0)
    (found,) = check_live(behavior, LaunchTask(), measured(is_there=False), FILE)
    assert found.message == (
        "`wanders`: after 4.00 simulated s: the robot is no longer in the world: a node deleted "
        "it, or the simulation exploded."
    )


def test_what_did_not_run_is_named() -> None:
    behavior = Behavior(name="wanders", task=LaunchTask(travels=2.0), seconds=4.0)
    left_out = {"amcl of nav2_amcl": "it is not compiled"}
    (found,) = check_live(behavior, LaunchTask(travels=2.0), measured(left_out=left_out), FILE)
    assert found.hint is not None
    assert found.hint.endswith(" Skipped in the run: amcl of nav2_amcl (it is not compiled).")
    assert not check_live(behavior, LaunchTask(), measured(left_out=left_out), FILE)
    many = {f"n{number}": "why" for number in range(7)}
    (found,) = check_live(behavior, LaunchTask(travels=2.0), measured(left_out=many), FILE)
    assert str(found.hint).endswith("n4 (why) and 2 more.")


def test_one_that_is_left_out_is_no_error() -> None:
    behavior = Behavior(name="wanders", task=LaunchTask(), seconds=4.0, line=3)
    (found,) = launch_not_run(behavior, "No ROS is there.", "Install it.", FILE, Severity.WARNING)
    assert (found.code, found.severity) == ("SPN102", Severity.WARNING)
    assert found.message == "`wanders` is skipped: no ROS is there."

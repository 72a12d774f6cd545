"""Rules over what a robot must do, with facts alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.behaviors import (
    check_behavior,
    command_beyond_limit,
    no_diff_drive,
    unclear_behavior_robot,
    unknown_behavior_joint,
)
from wsgen.diagnostics import Severity
from wsgen.model.behavior import (
    Behavior,
    BehaviorRun,
    Bounds,
    DiffDrive,
    Drive,
    LaunchTask,
    Reach,
    WheelPair,
)
from wsgen.model.robot import Joint, JointLimit, JointType, Link, Mimic, Robot
from wsgen.simulation.scene import BehaviorMeasurement

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic


FILE = Path("wsgen.toml")
STRAIGHT = Drive(linear=0.5, x=1.0, y=0.0, yaw=0.0)
TURN = Drive(angular=1.0, x=0.0, y=0.0, yaw=2.0)
PAIR = WheelPair(left="l", right="r", separation=0.4, radius=0.1)
DRIVE = DiffDrive(simulator="gz", pairs=(PAIR,))
SLIDING = replace(DRIVE, grip=0.05)
POSITIONS = {"a": 0.5, "b": -0.5}


def behavior(task: Drive | Reach | LaunchTask = STRAIGHT, robot: str | None = None) -> Behavior:
    return Behavior(name="does it", task=task, seconds=2.0, robot=robot, line=7)


def checked(
    task: Drive | Reach,
    moved: tuple[float, float, float] = (0.0, 0.0, 0.0),
    *,
    drive: DiffDrive | None = DRIVE,
    positions: dict[str, float] | None = None,
    is_finite: bool = True,
) -> tuple[Diagnostic, ...]:
    behavior_run = BehaviorRun(entity="e", behavior=behavior(task), drive=drive)
    return check_behavior(
        behavior_run, BehaviorMeasurement("does it", moved, positions or {}, is_finite), FILE
    )


def codes(task: Drive, *moved: float) -> list[str]:
    x, y, yaw = moved
    return [found.code for found in checked(task, (x, y, yaw))]


@pytest.mark.parametrize(
    ("moved", "expected"),
    [
        ((1.0, 0.0, 0.0), []),
        ((0.91, 0.09, 0.019), []),
        ((1.09, -0.09, -0.019), []),
        ((0.89, 0.0, 0.0), ["SPN085"]),
        ((1.11, 0.0, 0.0), ["SPN085"]),
        ((1.0, 0.11, 0.0), ["SPN085"]),
        ((1.0, 0.0, 0.021), ["SPN086"]),
        ((0.0, 0.0, 1.0), ["SPN085", "SPN086"]),
    ],
)
def test_a_way_may_be_missed_by_a_share_of_it(
    moved: tuple[float, ...], expected: list[str]
) -> None:
    assert codes(STRAIGHT, *moved) == expected


@pytest.mark.parametrize(
    ("moved", "expected"),
    [
        ((0.019, -0.019, 1.81), []),
        ((0.021, 0.0, 2.0), ["SPN085"]),
        ((0.0, 0.0, 1.79), ["SPN086"]),
        ((0.0, 0.0, -2.0), ["SPN086"]),
    ],
)
def test_turning_in_place(moved: tuple[float, ...], expected: list[str]) -> None:
    assert codes(TURN, *moved) == expected


def test_what_is_not_named_is_not_judged() -> None:
    assert codes(Drive(linear=0.5), 9.0, 9.0, 9.0) == []
    assert codes(Drive(linear=0.5, x=1.0), 1.0, 9.0, 9.0) == []
    assert codes(Drive(linear=0.5, y=0.0), 9.0, 0.0, 9.0) == []
    assert codes(replace(STRAIGHT, tolerance=0.5), 0.6, 0.4, 0.0) == []


def test_a_diagnostic_names_what_was_wanted_and_where_that_is_written() -> None:
    (found,) = checked(STRAIGHT, (0.5, 0.0, -1e-9))
    assert found.message == (
        "`does it`: after 2 s the robot is at x = 0.5 m, y = 0 m from its start; expected: x = 1 "
        "m, y = 0 m, within 0.1 m."
    )
    assert (found.file, found.line, found.severity) == (FILE, 7, Severity.ERROR)
    assert found.element == "behavior `does it`"


@pytest.mark.parametrize(
    ("task", "moved", "drive", "hint"),
    [
        (STRAIGHT, (0.5, 0.0, 0.0), DRIVE, "wheel_radius = 0.1 m: wheel_radius = 0.05 m would"),
        (
            STRAIGHT,
            (2.0, 0.0, 0.0),
            replace(DRIVE, simulator="classic"),
            "wheel_diameter = 0.2 m: wheel_diameter = 0.4 m would",
        ),
        (STRAIGHT, (0.0, 0.0, 0.0), DRIVE, "Check whether the wheels reach the ground"),
        (STRAIGHT, (-1.0, 0.0, 0.0), DRIVE, "the other way"),
        (STRAIGHT, (1.0, 0.5, 0.0), DRIVE, "sizes in the plugin"),
        (replace(STRAIGHT, angular=0.1), (0.5, 0.0, 0.0), DRIVE, "sizes in the plugin"),
        (
            STRAIGHT,
            (0.4, 0.0, 0.0),
            replace(DRIVE, linear=Bounds(fastest=0.2)),
            "The plugin limits 0.5 m/s",
        ),
        (TURN, (0.0, 0.0, 4.0), DRIVE, "wheel_separation = 0.4 m: 0.2 m would fit"),
        (STRAIGHT, (0.41, 0.0, 0.0), DRIVE, "wheel_radius = 0.041 m would"),
        (STRAIGHT, (2.49, 0.0, 0.0), DRIVE, "wheel_radius = 0.249 m would"),
        (STRAIGHT, (0.39, 0.0, 0.0), DRIVE, "The wheels slip, or are too weak: check"),
        (STRAIGHT, (2.6, 0.0, 0.0), DRIVE, "sizes in the plugin"),
        (STRAIGHT, (0.1, 0.0, 0.0), SLIDING, "The wheels slip: their friction is 0.05. Give whe"),
        (STRAIGHT, (-0.002, 0.0, 0.0), SLIDING, "The wheels slip: their friction is 0.05."),
        (STRAIGHT, (-1.0, 0.0, 0.0), SLIDING, "the other way"),
        (
            STRAIGHT,
            (0.5, 0.0, 0.0),
            SLIDING,
            "0.05 m would explain this, if the wheels do not slip",
        ),
        (TURN, (0.0, 0.0, 1.0), SLIDING, "0.8 m would fit, if the wheels do not slip: their fr"),
        (TURN, (0.0, 0.0, 0.9), DRIVE, "0.889 m would fit"),
        (TURN, (0.0, 0.0, 0.06), DRIVE, "The wheels slip, or are too weak: check"),
        (TURN, (0.0, 0.0, 0.06), SLIDING, "The wheels slip: their friction is 0.05."),
        (TURN, (0.0, 0.0, 0.0), SLIDING, "The wheels slip: their friction is 0.05."),
        (TURN, (0.0, 0.0, 6.0), DRIVE, "Check the sizes in the plugin"),
        (TURN, (0.0, 0.0, -2.0), DRIVE, "swap <left_joint> and <right_joint>"),
        (TURN, (0.0, 0.0, 0.0), DRIVE, "One side is braked"),
    ],
)
def test_what_would_explain_it(
    task: Drive, moved: tuple[float, float, float], drive: DiffDrive, hint: str
) -> None:
    (found,) = checked(task, moved, drive=drive)
    assert found.hint is not None
    assert hint in found.hint
    assert ("would" in found.hint) == ("would" in hint)  # no size that nobody could have meant


def test_joints() -> None:
    task = Reach(positions=POSITIONS)
    assert checked(task, positions={"a": 0.54, "b": -0.54, "c": 9.0}) == ()
    (found,) = checked(task, positions={"a": 0.4, "b": -0.5})
    assert found.code == "SPN087"
    assert found.message == "`does it`: after 2 s a is at 0.4 (not 0.5)."
    wide = replace(task, within=0.2)
    assert checked(wide, positions={"a": 0.4, "b": -0.5}) == ()


def test_of_many_joints_some_are_reported() -> None:
    positions = dict.fromkeys("abcdefg", 1.0)
    (found,) = checked(Reach(positions=positions), positions=dict.fromkeys("abcdefg", 0.0))
    assert "e is at 0 (not 1) and 2 more." in found.message


def test_what_explodes_is_judged_by_nothing_else() -> None:
    assert [one.code for one in checked(STRAIGHT, (9.0, 9.0, 9.0), is_finite=False)] == ["SPN088"]


@pytest.mark.parametrize(
    ("robot", "entities", "message"),
    [
        (None, ["a"], None),
        ("a", ["a", "b"], None),
        ("c", ["a", "b"], "no robot is spawned as `c`"),
        (None, ["a", "b"], "2 robots are spawned"),
    ],
)
def test_which_robot_is_meant(robot: str | None, entities: list[str], message: str | None) -> None:
    found = list(unclear_behavior_robot(behavior(robot=robot), entities, FILE))
    assert [one.code for one in found] == ([] if message is None else ["SPN080"])
    if message is not None:
        assert message in found[0].message
        assert found[0].hint is not None
        assert "`a`, `b`" in found[0].hint


@pytest.mark.parametrize(("has_plugin", "code"), [(True, "SPN082"), (False, "SPN081")])
def test_no_diff_drive(*, has_plugin: bool, code: str) -> None:
    (found,) = no_diff_drive(behavior(), "why", "Do.", FILE, has_plugin=has_plugin)
    assert (found.code, found.hint) == (code, "Do.")
    assert found.message == "`does it`: the robot cannot be driven: why."


def robot(*joints: Joint, is_static: bool = False) -> Robot:
    links = (Link(name="base"), *(Link(name=joint.child) for joint in joints))
    return Robot(name="r", root="base", links=links, joints=joints, is_static=is_static)


def joint(name: str, kind: JointType = JointType.REVOLUTE, limit: float = 1.0) -> Joint:
    bounds = JointLimit(lower=-limit, upper=limit, effort=1.0, velocity=1.0)
    return Joint(name=name, type=kind, parent="base", child=f"{name}_link", limit=bounds)


def test_joints_that_take_no_commands() -> None:
    follower = replace(joint("b"), mimic=Mimic(joint="a"))
    arm = robot(joint("a"), follower, joint("f", JointType.FIXED))
    positions = {"a": 0.0, "b": 0.0, "f": 0.0, "x": 0.0}
    found = list(unknown_behavior_joint(behavior(), positions, arm, FILE))
    assert [one.code for one in found] == ["SPN083"] * 3
    assert "`b` follows `a`" in found[0].message
    assert "no joint `f` that can move" in found[1].message
    assert found[2].hint == "Joints that take commands: `a`."
    (still,) = unknown_behavior_joint(
        behavior(), {"a": 0.0}, robot(joint("a"), is_static=True), FILE
    )
    assert "no joint `a`" in still.message


def test_what_is_misspelled_is_asked_for() -> None:
    arm = robot(joint("shoulder"), joint("wrist"))
    (found,) = unknown_behavior_joint(behavior(), {"shouder": 0.0}, arm, FILE)
    assert (found.hint or "").startswith("Did you mean `shoulder`? Joints that take commands: ")
    (found,) = unclear_behavior_robot(behavior(robot="rovr"), ["rover", "arm"], FILE)
    assert (found.hint or "").startswith("Did you mean `rover`? Write robot = ")


def test_joints_that_are_only_measured() -> None:
    """With `run = true` nothing is sent: what mimics another joint has a position, too."""
    follower = replace(joint("b"), mimic=Mimic(joint="a"))
    arm = robot(joint("a"), follower, joint("p", JointType.PLANAR))
    positions = {"a": 3.0, "b": 0.5, "p": 0.0, "x": 0.0}
    task = LaunchTask(positions=positions)
    found = list(unknown_behavior_joint(behavior(task), positions, arm, FILE))
    assert ["`p`" in found[0].message, "`x`" in found[1].message, len(found)] == [True, True, 2]
    assert found[0].hint == "Joints that are measured: `a`, `b`."
    (over,) = command_beyond_limit(behavior(task), positions, arm.joints, FILE)
    assert "the joint `a` cannot reach 3, which is beyond its limits -1 and 1." in over.message


def test_commands_beyond_limits() -> None:
    joints = (joint("a", limit=0.5), joint("b", JointType.CONTINUOUS, limit=0.1), joint("c"))
    found = list(command_beyond_limit(behavior(), POSITIONS, joints, FILE))
    assert found == []
    (over,) = command_beyond_limit(behavior(), {"a": -0.6, "b": 9.0}, joints, FILE)
    assert over.code == "SPN084"
    assert "`a` is sent to -0.6, beyond its limits -0.5 and 0.5" in over.message

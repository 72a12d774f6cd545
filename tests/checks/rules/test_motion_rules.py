"""The check over how a robot moved, from facts alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules import runs as rules
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import Joint, JointLimit, JointType

if TYPE_CHECKING:
    from collections.abc import Iterable


def found(diagnostics: Iterable[Diagnostic]) -> list[tuple[str, Severity]]:
    found = list(diagnostics)
    assert all(diagnostic.element == "r" and diagnostic.hint for diagnostic in found)
    return [(diagnostic.code, diagnostic.severity) for diagnostic in found]


@pytest.mark.parametrize(
    ("start", "end", "falls"),
    [
        (0.1, 0.0, False),
        (-0.25, -0.2, False),
        (-2.0, -2.0, False),  # deep in the ground, where it was spawned
        (-2.0, -2.4, False),
        (-2.0, -2.6, True),
        (0.1, -0.4, False),
        (0.1, -44.0, True),
        (50.0, 3.0, False),  # it falls, and onto the ground
    ],
)
def test_a_robot_that_falls(start: float, end: float, *, falls: bool) -> None:
    expected = [("SPN056", Severity.ERROR)] if falls else []
    checked = rules.falls_without_end("r", start, end, has_ground=True, is_falling=False)
    assert found(checked) == expected


@pytest.mark.parametrize(
    ("start", "end", "is_falling", "falls"),
    [
        (0.1, -0.2, False, False),  # on something that is below z = 0
        (0.1, -5.0, False, False),  # it fell, and onto something
        (0.1, -5.0, True, True),
        (50.0, 3.0, True, True),
    ],
)
def test_without_a_ground_plane_falling_is_what_counts(
    start: float, end: float, *, is_falling: bool, falls: bool
) -> None:
    expected = [("SPN056", Severity.ERROR)] if falls else []
    checked = rules.falls_without_end("r", start, end, has_ground=False, is_falling=is_falling)
    assert found(checked) == expected


def test_why_it_falls() -> None:
    (without,) = rules.falls_without_end("r", 1.0, -43.04, has_ground=False, is_falling=True)
    (with_ground,) = rules.falls_without_end("r", 0.0, -44.04, has_ground=True, is_falling=True)
    assert "is 44.0 m lower" in without.message
    assert "44.0 m below" in with_ground.message
    assert "a static model with a <plane>" in (without.hint or "")
    assert "<collision>" in (with_ground.hint or "")


def test_a_robot_that_is_thrown() -> None:
    assert found(rules.thrown_into_the_air("r", 0.49)) == []
    assert found(rules.thrown_into_the_air("r", -3.0)) == []
    assert found(rules.thrown_into_the_air("r", 3.0)) == [("SPN057", Severity.ERROR)]


def test_joints_that_gravity_moves_are_no_mistake() -> None:
    assert found(rules.unactuated_joints_move({}, "r", is_moving=True)) == []
    (one,) = rules.unactuated_joints_move({"elbow": 1.0}, "r", is_moving=False)
    assert found([one]) == [("SPN060", Severity.INFO)]
    assert one.message.endswith("that are not actuated: `elbow`.")


def test_the_joints_that_moved_farthest_are_named() -> None:
    travel = {"a": 0.1, "b": 3.0, "c": 2.0, "d": 0.2, "e": 1.0}
    (one,) = rules.unactuated_joints_move(travel, "r", is_moving=True)
    assert "`b`, `c`, `e` and 2 more (still moving at the end)." in one.message


def test_energy_from_nowhere() -> None:
    """It is measured by how high it could lift the robot: 0.1 m of 10 kg are 9.8 J."""
    assert found(rules.gains_energy("r", 9.7, 10.0, 9.8, 0.0, is_alone=True)) == []
    assert found(rules.gains_energy("r", 9.9, 10.0, 9.8, 0.0, is_alone=True)) == [
        ("SPN061", Severity.ERROR)
    ]
    (one,) = rules.gains_energy("r", 12345.6, 10.0, 9.8, 0.0, is_alone=True)
    assert "1.23e+04 J" in one.message


def test_what_comes_out_of_the_ground_gains_the_energy_for_that() -> None:
    assert found(rules.gains_energy("r", 9.8 * 5.9, 10.0, 9.8, 0.5, is_alone=True)) == []
    assert found(rules.gains_energy("r", 9.8 * 6.1, 10.0, 9.8, 0.5, is_alone=True)) != []


def test_without_gravity_the_measure_is_that_of_the_earth() -> None:
    assert found(rules.gains_energy("r", 9.7, 10.0, 0.0, 0.0, is_alone=True)) == []
    assert found(rules.gains_energy("r", 9.9, 10.0, 0.0, 0.0, is_alone=True)) != []
    # Where things are heavier, it takes more.
    assert found(rules.gains_energy("r", 9.9, 10.0, 24.8, 0.0, is_alone=True)) == []


def joint(kind: JointType, limit: JointLimit | None) -> Joint:
    return Joint(name="j", type=kind, parent="a", child="b", limit=limit)


LIMIT = JointLimit(lower=-1.0, upper=0.5)


@pytest.mark.parametrize(
    ("kind", "position", "beyond"),
    [
        (JointType.REVOLUTE, 0.54, False),
        (JointType.REVOLUTE, 0.56, True),
        (JointType.REVOLUTE, -1.04, False),
        (JointType.REVOLUTE, -1.06, True),
        (JointType.PRISMATIC, 0.505, False),
        (JointType.PRISMATIC, 0.52, True),
        (JointType.PRISMATIC, -1.02, True),
        (JointType.CONTINUOUS, 100.0, False),
    ],
)
def test_a_joint_beyond_its_limit(kind: JointType, position: float, *, beyond: bool) -> None:
    expected = [("SPN062", Severity.WARNING)] if beyond else []
    diagnostics = list(rules.joint_beyond_limit("r", [joint(kind, LIMIT)], {"j": position}))
    assert found(diagnostics) == expected
    assert all(f"`j` is at {position:.3f}" in one.message for one in diagnostics)
    assert all("-1 to 0.5" in one.message for one in diagnostics)


def test_joints_without_limit_or_position() -> None:
    free = joint(JointType.REVOLUTE, None)
    assert found(rules.joint_beyond_limit("r", [free], {"j": 9.0})) == []
    # A static robot has joints, and the engine moves none.
    assert found(rules.joint_beyond_limit("r", [joint(JointType.REVOLUTE, LIMIT)], {})) == []


ERROR, WARNING, INFO = ([("SPN058", severity)] for severity in Severity)


@pytest.mark.parametrize(
    ("settled", "speed", "turning", "has_passive_joints", "expected"),
    [
        (1.0, 0.0, 0.0, False, []),
        (0.0, 0.0, 0.0, True, []),
        (None, 0.5, 0.0, False, ERROR),
        (None, 0.0, 1.0, False, ERROR),
        (None, 0.04, 0.2, False, INFO),  # it creeps: it will stand
        (None, 0.0, 0.0, False, []),  # a wheel spins on, and the robot stands
        (None, 0.5, 0.0, True, WARNING),  # its passive joints pull it over
        (None, 0.009, 0.009, True, []),  # it stands, and its passive joints swing
        (None, 0.009, 0.02, True, INFO),
    ],
)
def test_a_robot_that_keeps_moving(
    settled: float | None,
    speed: float,
    turning: float,
    *,
    has_passive_joints: bool,
    expected: list[tuple[str, Severity]],
) -> None:
    diagnostics = rules.keeps_moving(
        "r", settled, speed, turning=turning, joint_speed=0.0, has_passive_joints=has_passive_joints
    )
    assert found(diagnostics) == expected


def test_what_still_moves_is_reported() -> None:
    (swings,) = rules.keeps_moving(
        "r", None, 0.1, turning=0.0, joint_speed=1.5, has_passive_joints=False
    )
    assert "moves at 0.100 m/s, a joint at 1.50" in swings.message
    assert "turns" not in swings.message
    (turns,) = rules.keeps_moving(
        "r", None, 0.1, turning=0.7, joint_speed=0.0, has_passive_joints=True
    )
    assert "turns at 0.70 rad/s" in turns.message
    assert "joint" not in turns.message
    assert "unactuated joints" in (turns.hint or "")


def test_a_robot_that_tips_over() -> None:
    assert found(rules.tips_over("r", math.radians(14), has_passive_joints=False)) == []
    (falls,) = rules.tips_over("r", math.radians(90), has_passive_joints=False)
    (pulled,) = rules.tips_over("r", math.radians(90), has_passive_joints=True)
    assert found([falls, pulled]) == [("SPN059", Severity.ERROR), ("SPN059", Severity.WARNING)]
    assert "90 degrees" in falls.message
    assert "unactuated joints" in pulled.message
    assert "bolted" in (pulled.hint or "")


def test_a_robot_that_leans() -> None:
    heights = {"wheel": 0.0, "caster": 0.0118, "body": 0.07}
    for tilt in (0.0, 2.9, 15.1, 90.0):
        assert found(rules.leans("r", math.radians(tilt), ["wheel", "caster"], heights)) == []
    (high,) = rules.leans("r", math.radians(4.2), ["caster", "wheel"], heights)
    assert found([high]) == [("SPN067", Severity.WARNING)]
    assert "leans by 4.2 degrees. It rests on `caster`, `wheel`." in high.message
    assert "`caster` is 12 mm above" in (high.hint or "")
    (even,) = rules.leans("r", math.radians(5), [*"abcdef"], dict.fromkeys("abcdef", 0.0))
    assert "`d` and 2 more." in even.message
    assert "at the same height" in (even.hint or "")
    (unread,) = rules.leans("r", math.radians(5), [], {})
    assert "rests" not in unread.message


def test_what_another_robot_pushes_may_gain_energy() -> None:
    (one,) = rules.gains_energy("r", 99.0, 10.0, 9.8, 0.0, is_alone=False)
    assert found([one]) == [("SPN061", Severity.WARNING)]
    assert "another robot" in one.message

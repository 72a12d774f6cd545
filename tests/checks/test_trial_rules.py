"""The judgements over a trial, from facts alone."""

import math
from collections.abc import Iterable

import pytest

from wsgen.checks import trial_rules as rules
from wsgen.diagnostics import Diagnostic, Severity


def found(diagnostics: Iterable[Diagnostic]) -> list[tuple[str, Severity]]:
    return [(diagnostic.code, diagnostic.severity) for diagnostic in diagnostics]


def test_the_mass_is_compared_relatively() -> None:
    assert found(rules.mass_differs_from_description("r", 1000.0, 1000.0005)) == []
    assert found(rules.mass_differs_from_description("r", 1.0, 2.0)) == [("SPN050", Severity.ERROR)]


def test_joints_are_counted() -> None:
    assert found(rules.joints_differ_from_description("r", 2, 2)) == []
    assert found(rules.joints_differ_from_description("r", 2, 1)) == [("SPN051", Severity.ERROR)]


def test_a_simulation_that_explodes() -> None:
    assert found(rules.state_not_finite("r", is_finite=True)) == []
    assert found(rules.state_not_finite("r", is_finite=False)) == [("SPN052", Severity.ERROR)]


def test_the_hint_of_a_sunken_spawn_is_a_height_that_works() -> None:
    (diagnostic,) = rules.born_inside_the_ground("r", 0.25, 0.0)
    assert found([diagnostic]) == [("SPN053", Severity.WARNING)]
    assert "z:=0.255" in (diagnostic.hint or "")
    assert found(rules.born_inside_the_ground("r", 0.004, 0.0)) == []
    assert found(rules.born_inside_the_ground("r", -0.01, 0.0)) == []


def test_a_high_spawn() -> None:
    assert found(rules.spawned_high_above_the_ground("r", 0.5, 0.75)) == []
    (diagnostic,) = rules.spawned_high_above_the_ground("r", 4.75, 5.0)
    assert found([diagnostic]) == [("SPN054", Severity.WARNING)]
    assert "z = 5 m" in diagnostic.message
    assert "z:=0.255" in (diagnostic.hint or "")


def test_a_robot_that_stays_in_the_ground() -> None:
    assert found(rules.stuck_in_the_ground("r", 0.001)) == []
    assert found(rules.stuck_in_the_ground("r", 0.2)) == [("SPN055", Severity.ERROR)]


@pytest.mark.parametrize(
    ("start", "end", "falls"),
    [(0.1, 0.0, False), (-0.25, -0.2, False), (-2.0, -2.0, False), (0.1, -44.0, True)],
)
def test_a_robot_that_falls(start: float, end: float, *, falls: bool) -> None:
    assert bool(found(rules.falls_without_end("r", start, end, has_ground=True))) is falls


def test_why_it_falls() -> None:
    (without,) = rules.falls_without_end("r", 0.0, -44.0, has_ground=False)
    (with_ground,) = rules.falls_without_end("r", 0.0, -44.0, has_ground=True)
    assert "ground_plane" in (without.hint or "")
    assert "<collision>" in (with_ground.hint or "")


def test_a_robot_that_is_thrown() -> None:
    assert found(rules.thrown_into_the_air("r", 0.1)) == []
    assert found(rules.thrown_into_the_air("r", 3.0)) == [("SPN057", Severity.ERROR)]


@pytest.mark.parametrize(
    ("settled", "speed", "joints", "expected"),
    [
        (1.0, 0.0, 0, []),
        (None, 0.05, 0, [Severity.ERROR]),
        (None, 0.05, 2, [Severity.WARNING]),
        (None, 0.5, 2, [Severity.ERROR]),
    ],
)
def test_a_robot_that_keeps_moving(
    settled: float | None, speed: float, joints: int, expected: list[Severity]
) -> None:
    diagnostics = list(rules.keeps_moving("r", settled, speed, joints))
    assert [diagnostic.severity for diagnostic in diagnostics] == expected
    assert all(diagnostic.code == "SPN058" for diagnostic in diagnostics)


def test_a_robot_that_tips_over() -> None:
    assert found(rules.tips_over("r", math.radians(14))) == []
    assert found(rules.tips_over("r", math.radians(90))) == [("SPN059", Severity.ERROR)]


def test_what_still_moves_is_told() -> None:
    (found_,) = rules.keeps_moving("r", None, 0.0, 2, turning=0.0, joint_speed=1.5)
    assert "a joint at 1.50" in found_.message
    assert "turns" not in found_.message

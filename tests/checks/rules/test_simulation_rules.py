"""The check over a simulation, from facts alone."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules import runs as rules
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.world import SpawnHeight

ARGUMENTS = SpawnHeight(
    file=Path("r.launch.py"), line=7, option="-z", holder="the arguments of spawn_entity.py"
)


def found(diagnostics: Iterable[Diagnostic]) -> list[tuple[str, Severity]]:
    return [(diagnostic.code, diagnostic.severity) for diagnostic in diagnostics]


def test_the_mass_is_compared_relatively() -> None:
    assert found(rules.mass_differs("r", 1000.0, 1000.0005)) == []
    assert found(rules.mass_differs("r", 1.0, 2.0)) == [("SPN050", Severity.ERROR)]


def test_joints_are_counted() -> None:
    assert found(rules.joints_differ("r", 2, 2)) == []
    assert found(rules.joints_differ("r", 2, 1)) == [("SPN051", Severity.ERROR)]


def test_a_simulation_that_explodes() -> None:
    assert found(rules.state_not_finite("r", is_finite=True)) == []
    assert found(rules.state_not_finite("r", is_finite=False)) == [("SPN052", Severity.ERROR)]


def test_the_hint_of_a_sunken_spawn_is_a_height_that_works() -> None:
    (diagnostic,) = rules.spawned_in_ground("r", 0.25, 0.0)
    assert found([diagnostic]) == [("SPN053", Severity.WARNING)]
    assert "z = 0.255 m in the <pose>" in (diagnostic.hint or "")
    assert found(rules.spawned_in_ground("r", 0.004, 0.0)) == []
    assert found(rules.spawned_in_ground("r", -0.01, 0.0)) == []


def test_a_high_spawn() -> None:
    assert found(rules.spawned_high("r", 0.5, 0.75)) == []
    (diagnostic,) = rules.spawned_high("r", 4.75, 5.0)
    assert found([diagnostic]) == [("SPN054", Severity.WARNING)]
    assert "z = 5 m" in diagnostic.message
    assert "z = 0.255 m in the <pose>" in (diagnostic.hint or "")


@pytest.mark.parametrize(
    ("height", "advice"),
    [
        (ARGUMENTS, "add '-z', '0.255' to the arguments of spawn_entity.py."),
        (replace(ARGUMENTS, is_given=True), "change -z to '0.255' in the arguments of"),
        (replace(ARGUMENTS, is_given=True, launch_argument="up"), "give up:=0.255, or make"),
        (
            replace(ARGUMENTS, option="z", holder="the parameters of create"),
            "add 'z': '0.255' to the parameters of create.",
        ),
    ],
)
def test_the_advice_is_that_which_fits_the_launch_file(height: SpawnHeight, advice: str) -> None:
    for diagnostic in (
        *rules.spawned_in_ground("r", 0.25, 0.0, height),
        *rules.spawned_high("r", 4.75, 5.0, height),
    ):
        assert (diagnostic.file, diagnostic.line) == (height.file, 7)
        assert advice in (diagnostic.hint or "")


def test_a_robot_that_stays_in_the_ground() -> None:
    error = [("SPN055", Severity.ERROR)]
    assert found(rules.stuck_in_ground("r", 0.001, 0.0)) == []
    assert found(rules.stuck_in_ground("r", 0.2, 0.0)) == error


def test_what_rises_out_of_the_ground_is_not_stuck() -> None:
    error = [("SPN055", Severity.ERROR)]
    assert found(rules.stuck_in_ground("r", 0.2, 0.25)) == []
    assert found(rules.stuck_in_ground("r", 2.0, 0.25)) == error  # too deep
    assert found(rules.stuck_in_ground("r", 0.2, 0.001)) == error  # too slow
    assert found(rules.stuck_in_ground("r", 0.2, -0.25)) == error

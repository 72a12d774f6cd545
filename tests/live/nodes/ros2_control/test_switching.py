"""Which controllers may be active together."""

from __future__ import annotations

import pytest

from wsgen.live.nodes.simulator.ros2_control.switching import (
    ACTIVE,
    BEST_EFFORT,
    INACTIVE,
    STRICT,
    UNCONFIGURED,
    Available,
    Candidate,
    Switch,
    plan_switch,
)

LOADED = {
    "arm": Candidate("arm", INACTIVE, ("j/position",), ("j/position",)),
    "other": Candidate("other", ACTIVE, ("j/position", "k/position"), ()),
    "states": Candidate("states", INACTIVE, (), None),
    "raw": Candidate("raw", UNCONFIGURED),
    "absent": Candidate("absent", INACTIVE, ("z/velocity",), ()),
}
AVAILABLE = Available(
    ("j/position", "k/position"),
    ("j/position",),
    {"j/position": "other", "k/position": "other"},
)


def switch(activate: list[str], deactivate: list[str], strictness: int = STRICT) -> Switch:
    return plan_switch(LOADED, AVAILABLE, activate, deactivate, strictness)


def test_an_interface_has_one_controller() -> None:
    planned = switch(["arm"], [])
    assert planned.is_refused
    assert "'j/position' is already claimed by 'other'" in planned.problems[0]


def test_what_is_deactivated_gives_its_interfaces_back() -> None:
    assert switch(["arm"], ["other"]) == Switch(("arm",), ("other",), (), is_refused=False)


def test_broadcasters_claim_nothing() -> None:
    assert switch(["states"], []).activate == ("states",)


@pytest.mark.parametrize(
    ("activate", "deactivate", "problem"),
    [
        (["none"], [], "no controller with this name"),
        ([], ["none"], "no controller with this name"),
        ([], ["arm"], "not active"),
        (["raw"], [], "not configured"),
        (["other"], [], "already active"),
        (["absent"], [], "no command interface `z/velocity`"),
    ],
)
def test_why_a_switch_is_refused(activate: list[str], deactivate: list[str], problem: str) -> None:
    planned = switch(activate, deactivate)
    assert planned.is_refused
    assert problem in planned.problems[0]


def test_best_effort_does_what_can_be_done() -> None:
    planned = switch(["states", "arm"], [], BEST_EFFORT)
    assert planned.activate == ("states",)
    assert not planned.is_refused
    assert len(planned.problems) == 1


def test_two_of_one_request_cannot_share() -> None:
    loaded = {name: Candidate(name, INACTIVE, ("j/position",)) for name in ("a", "b")}
    planned = plan_switch(loaded, Available(("j/position",), (), {}), ["a", "b"], [], STRICT)
    assert "already claimed by 'a'" in planned.problems[0]

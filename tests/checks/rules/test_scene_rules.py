"""The check over robots in each other, and over several engines, from facts alone."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import pytest

from checks.rules.robot_runs import STANDS
from wsgen.checks.rules import runs as rules
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.engines import name_engines
from wsgen.model.transform import Pose
from wsgen.simulation.engine import HullGap
from wsgen.simulation.scene import Overlapping

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.simulation.scene import RobotRun


def found(diagnostics: Iterable[Diagnostic]) -> list[tuple[str, Severity]]:
    return [(diagnostic.code, diagnostic.severity) for diagnostic in diagnostics]


def overlap(link: str, other: str, depth: float = 0.1, *, entity: str | None = None) -> Overlapping:
    return Overlapping(link=link, other_entity=entity, other_link=other, depth=depth)


def test_overlapping_robots_are_reported_once_with_the_deepest() -> None:
    seen_from_a = [
        overlap("a1", "b1", 0.1, entity="b"),
        overlap("a2", "b2", 0.3, entity="b"),
        overlap("a1", "c1", 0.2, entity="c"),
        overlap("a1", "a2", 0.9),
    ]
    first, second = rules.overlapping_robots("a", seen_from_a)
    assert found([first, second]) == [("SPN063", Severity.ERROR)] * 2
    assert "`a` and `b`" in first.message
    assert "`a/a2` is 0.300 m deep in `b/b2`" in first.message
    assert "`a` and `c`" in second.message
    # The other one, by name, keeps silent.
    assert found(rules.overlapping_robots("b", [overlap("b1", "a1", entity="a")])) == []


def test_what_is_hardly_in_each_other_is_a_warning() -> None:
    (shallow,) = rules.overlapping_robots("a", [overlap("a1", "b1", 0.015, entity="b")])
    assert shallow.severity is Severity.WARNING


def test_the_robot_is_reported_to_be_in_the_static_model() -> None:
    seen_from_robot = [overlap("base", "l", entity="a_wall")]
    (found_in,) = rules.overlapping_robots("robot", seen_from_robot, {"a_wall", "b_wall"})
    assert found_in.element == "robot"
    assert found_in.message.startswith("`robot` overlaps the model `a_wall` at its spawn: ")
    seen_from_wall = [overlap("l", "base", entity="robot"), overlap("l", "l", entity="b_wall")]
    (other,) = rules.overlapping_robots("a_wall", seen_from_wall, {"a_wall", "b_wall"})
    assert "`b_wall`" in other.message


def test_the_widest_gaps_under_a_hull_are_reported() -> None:
    gaps = [HullGap("arm", "post", 0.006), HullGap("fork", "post", 0.1)]
    first, second = rules.rests_on_hull("r", gaps)
    assert found([first, second]) == [("SPN066", Severity.WARNING)] * 2
    assert "`fork` touches `post` 100 mm from" in first.message
    assert "`arm` touches `post` 6 mm from" in second.message


def test_robots_apart() -> None:
    assert found(rules.overlapping_robots("a", [])) == []
    assert found(rules.overlapping_robots("a", [overlap("x", "y")])) == []


def test_links_that_may_collide_and_start_in_each_other() -> None:
    (one,) = rules.overlapping_links("r", [overlap("x", "y", 0.25)], ["x", "y"])
    assert found([one]) == [("SPN064", Severity.WARNING)]
    assert "`x` in `y` (0.250 m)." in one.message


@pytest.mark.parametrize("collide", [[], ["x"], ["y", "z"]])
def test_links_that_may_not_collide(collide: list[str]) -> None:
    assert found(rules.overlapping_links("r", [overlap("x", "y")], collide)) == []


def test_links_of_another_robot_are_another_matter() -> None:
    others = [overlap("x", "y", entity="other")]
    assert found(rules.overlapping_links("r", others, ["x", "y"])) == []


def test_the_deepest_pairs_are_named() -> None:
    many = [overlap("x", str(depth), depth / 10) for depth in (1, 4, 2, 5, 3)]
    (one,) = rules.overlapping_links("r", many, ["x", *"12345"])
    assert "`x` in `5` (0.500 m), `x` in `4` (0.400 m), `x` in `3` (0.300 m) and 2 more." in (
        one.message
    )


def disagreement(**runs: RobotRun) -> str:
    """What is said of runs in these engines."""
    (one,) = rules.engines_disagree(runs)
    assert found([one]) == [("SPN065", Severity.WARNING)]
    return one.message


def test_engines_that_agree() -> None:
    assert found(rules.engines_disagree({"bullet": STANDS})) == []
    near = replace(
        STANDS,
        mass=STANDS.mass * (1 + 1e-7),
        rest_pose=Pose((0.003, 0.0, 0.253), (0.01, 0.0, 0.01)),
        joint_positions={"j": 0.05},
        settled_after=2.0,
    )
    assert found(rules.engines_disagree({"bullet": STANDS, "mujoco": near, "dart": STANDS})) == []


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        ({"mass": 2.5}, "weighs 2.5 kg instead of 1 kg"),
        ({"movable_joints": 3}, "has 3 movable joints instead of 0"),
        ({"settled_after": None}, "does not come to rest"),
        (
            {"rest_pose": Pose((0.0, 0.03, 0.29))},
            "rests 40 mm higher (z = 0.290 m instead of 0.250 m) and 30 mm to the side",
        ),
        (
            {"rest_pose": Pose((0.0, 0.001, 0.238))},
            "rests 12 mm lower (z = 0.238 m instead of 0.250 m)",
        ),
        ({"rest_pose": Pose((1.5, 0.0, 0.25))}, "rests 1.50 m to the side"),
        (
            {"rest_pose": Pose((0.0, 0.0, 0.25), (0.1, 0.0, 0.0)), "tilt": 0.1},
            "leans by 5.7 instead of 0.0 degrees",
        ),
        (
            {"rest_pose": Pose((0.0, 0.0, 0.25), (0.0, 0.0, 0.1))},
            "is turned by 5.7 degrees",
        ),
        (
            {"joint_positions": {"j": -0.5, "k": 0.3}},
            "has the joint `j` at -0.50 instead of 0.00 rad or m",
        ),
    ],
)
def test_two_engines_that_disagree(measured: dict[str, object], words: str) -> None:
    first = replace(STANDS, joint_positions={"j": 0.0, "k": 0.0})
    second = replace(STANDS, **{"joint_positions": first.joint_positions, **measured})  # type: ignore[arg-type]
    said = disagreement(bullet=first, dart=second)
    assert said == f"PyBullet and DART disagree: in DART it {words}."


LOWER = replace(STANDS, rest_pose=Pose((0.0, 0.0, 0.238)))
MOVES = replace(STANDS, settled_after=None)


@pytest.mark.parametrize(
    ("odd", "others"),
    [
        ("bullet", "MuJoCo and DART agree, PyBullet differs: in PyBullet it"),
        ("mujoco", "PyBullet and DART agree, MuJoCo differs: in MuJoCo it"),
        ("dart", "PyBullet and MuJoCo agree, DART differs: in DART it"),
    ],
)
def test_of_three_engines_the_one_that_differs_is_named(odd: str, others: str) -> None:
    runs = {**dict.fromkeys(("bullet", "mujoco", "dart"), STANDS), odd: LOWER}
    said = disagreement(**runs)
    assert said == f"{others} rests 12 mm lower (z = 0.238 m instead of 0.250 m)."
    runs = {**dict.fromkeys(("bullet", "mujoco", "dart"), MOVES), odd: STANDS}
    assert disagreement(**runs) == f"{others} comes to rest."


def rests_at(z: float) -> RobotRun:
    return replace(STANDS, rest_pose=Pose((0.0, 0.0, z)))


def test_three_engines_that_differ() -> None:
    assert disagreement(bullet=STANDS, mujoco=rests_at(0.15), dart=rests_at(0.1)) == (
        "PyBullet, MuJoCo and DART disagree: compared with PyBullet, in MuJoCo it rests 100 mm "
        "lower (z = 0.150 m instead of 0.250 m); in DART it rests 150 mm lower "
        "(z = 0.100 m instead of 0.250 m)."
    )


def test_engines_that_differ_are_compared_with_one_in_which_the_robot_rests() -> None:
    assert disagreement(bullet=MOVES, mujoco=STANDS, dart=rests_at(0.1)) == (
        "PyBullet, MuJoCo and DART disagree: compared with MuJoCo, in DART it rests 150 mm lower "
        "(z = 0.100 m instead of 0.250 m); in PyBullet it does not come to rest."
    )


def test_two_of_three_engines_that_nearly_agree() -> None:
    runs = {"bullet": STANDS, "mujoco": rests_at(0.24), "dart": rests_at(0.1)}
    assert disagreement(**runs) == (
        "PyBullet and MuJoCo nearly agree, DART differs: in DART it rests 150 mm lower "
        "(z = 0.100 m instead of 0.250 m)."
    )
    assert disagreement(**{**runs, "bullet": MOVES, "dart": STANDS}) == (
        "MuJoCo and DART nearly agree, PyBullet differs: in PyBullet it does not come to rest."
    )


def test_an_engine_between_two_that_disagree() -> None:
    assert disagreement(bullet=STANDS, mujoco=rests_at(0.242), dart=rests_at(0.246)) == (
        "PyBullet and MuJoCo disagree; DART is between them: in MuJoCo it rests 8 mm lower "
        "(z = 0.242 m instead of 0.250 m)."
    )


def test_a_run_that_explodes_or_is_cut_short_does_not_decide() -> None:
    for broken in (replace(LOWER, is_finite=False), replace(LOWER, is_cut_short=True)):
        assert found(rules.engines_disagree({"bullet": STANDS, "dart": broken})) == []
        said = disagreement(bullet=STANDS, mujoco=LOWER, dart=broken)
        assert said.startswith("PyBullet and MuJoCo disagree: in MuJoCo it rests 12 mm lower")


def test_poses_of_what_moves_are_not_compared() -> None:
    elsewhere = replace(MOVES, rest_pose=Pose((9.0, 9.0, 9.0)), joint_positions={"j": 9.0})
    assert found(rules.engines_disagree({"bullet": MOVES, "dart": elsewhere})) == []


def test_all_differences_are_reported_together() -> None:
    other = replace(STANDS, mass=2.0, movable_joints=1, rest_pose=Pose((0.0, 0.0, 1.25)))
    said = disagreement(bullet=STANDS, dart=other)
    assert [word in said for word in ("weighs", "joints", "1.00 m higher")] == [True] * 3


@pytest.mark.parametrize(
    ("run", "has_passive_joints", "words"),
    [
        (LOWER, False, "differences are normal"),
        (LOWER, True, "unactuated joints"),
        (MOVES, False, "--seconds 10"),
        (replace(LOWER, penetration=0.1), True, "Spawn it above the ground"),
    ],
)
def test_why_engines_may_disagree(run: RobotRun, words: str, *, has_passive_joints: bool) -> None:
    runs = {"bullet": STANDS, "dart": run}
    (one,) = rules.engines_disagree(runs, has_passive_joints=has_passive_joints)
    assert words in str(one.hint)
    (one,) = rules.engines_disagree(runs, has_passive_joints=has_passive_joints, is_on_hull=True)
    assert "rests-on-hull" in str(one.hint)


RUNS = [STANDS, rests_at(0.246), rests_at(0.23), rests_at(0.1), MOVES, replace(STANDS, mass=2.0)]


@pytest.mark.parametrize("runs", list(product(RUNS, repeat=3)))
def test_whatever_three_engines_say_the_verdict_is_about_those_that_differ(
    runs: tuple[RobotRun, ...],
) -> None:
    engines = ("bullet", "mujoco", "dart")
    reported = list(rules.engines_disagree(dict(zip(engines, runs, strict=True))))
    alone = [one for one in runs if runs.count(one) == 1]
    if not alone:
        assert reported == []
        return
    for one in reported:
        verdict, _, details = one.message.partition(": ")
        assert all(name in verdict for name in ("PyBullet", "MuJoCo", "DART"))
        if len(alone) == 1:  # the others are the same
            odd = name_engines([engines[runs.index(alone[0])]])
            assert verdict.endswith(f" agree, {odd} differs")
            assert details.startswith(f"in {odd} it ")

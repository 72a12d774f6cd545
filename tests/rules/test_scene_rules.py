"""The check over robots in each other, and over two engines, from facts alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from rules.robot_runs import STANDS
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.transform import Pose
from wsgen.rules import runs as rules
from wsgen.simulation.engine import HullGap
from wsgen.simulation.scene import Overlapping

if TYPE_CHECKING:
    from collections.abc import Iterable


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


def test_engines_that_agree() -> None:
    assert found(rules.engines_disagree(STANDS, STANDS)) == []
    near = replace(
        STANDS,
        mass=STANDS.mass * (1 + 1e-7),
        rest_pose=Pose((0.003, 0.0, 0.253), (0.01, 0.0, 0.01)),
        joint_positions={"j": 0.05},
        settled_after=2.0,
    )
    assert found(rules.engines_disagree(STANDS, near)) == []


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        ({"mass": 2.5}, "mass 1 and 2.5 kg"),
        ({"movable_joints": 3}, "0 and 3 joints"),
        ({"settled_after": None}, "it comes to rest only in PyBullet"),
        ({"rest_pose": Pose((0.0, 0.03, 0.29))}, "it rests 50 mm and 0.0 degrees apart"),
        (
            {"rest_pose": Pose((0.0, 0.0, 0.25), (0.1, 0.0, 0.0))},
            "it rests 0 mm and 5.7 degrees apart",
        ),
        (
            {"joint_positions": {"j": -0.5, "k": 0.3}},
            "the joint `j` rests 0.50 rad or m apart",
        ),
    ],
)
def test_engines_that_disagree(measured: dict[str, object], words: str) -> None:
    first = replace(STANDS, joint_positions={"j": 0.0, "k": 0.0})
    second = replace(STANDS, **{"joint_positions": first.joint_positions, **measured})  # type: ignore[arg-type]
    (one,) = rules.engines_disagree(first, second)
    assert found([one]) == [("SPN065", Severity.WARNING)]
    assert one.message == f"PyBullet and DART disagree: {words}."


def test_who_comes_to_rest_is_reported() -> None:
    (one,) = rules.engines_disagree(replace(STANDS, settled_after=None), STANDS)
    assert "only in DART" in one.message


def test_poses_of_what_moves_are_not_compared() -> None:
    moving = replace(STANDS, settled_after=None)
    elsewhere = replace(moving, rest_pose=Pose((9.0, 9.0, 9.0)), joint_positions={"j": 9.0})
    assert found(rules.engines_disagree(moving, elsewhere)) == []


def test_all_differences_are_reported_together() -> None:
    other = replace(STANDS, mass=2.0, movable_joints=1, rest_pose=Pose((0.0, 0.0, 1.25)))
    (one,) = rules.engines_disagree(STANDS, other)
    assert one.message.count(";") == 2

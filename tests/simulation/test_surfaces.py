"""Trees with one friction in every link."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

from simulation.robots import BAR, CYLINDER, PLATE, body, joint, lattice, shape, single, tree
from wsgen.model.robot import JointType, Link, Sphere
from wsgen.model.transform import IDENTITY
from wsgen.simulation import contact_shapes
from wsgen.simulation.contact_shapes import (
    MOST_STANDING,
    inner_apart,
    inner_collisions,
    one_friction_a_link,
)

if TYPE_CHECKING:
    import pytest


ROUGH, SMOOTH = shape(PLATE, mu=0.9), shape(Sphere(radius=0.1), mu=0.0)


def test_links_of_one_friction_stay_as_they_are() -> None:
    two_shapes = replace(body(PLATE), collisions=(ROUGH, shape(CYLINDER, mu=0.9)))
    robot = tree(
        two_shapes,
        (joint("base", "bar", JointType.CONTINUOUS), BAR),
        (joint("bar", "frame", JointType.FIXED), Link(name="frame")),
    )
    assert one_friction_a_link(robot) == (robot, {"base": "base", "bar": "bar", "frame": "frame"})


def test_other_frictions_go_into_links_without_mass() -> None:
    more = shape(CYLINDER, mu=0.9)
    chassis = replace(body(PLATE), collisions=(ROUGH, SMOOTH, more, shape(PLATE, mu=0.5)))
    made, owner = one_friction_a_link(single(replace(chassis, self_collide=True)))
    assert [link.collisions for link in made.links] == [
        (ROUGH, more),
        (SMOOTH,),
        (shape(PLATE, mu=0.5),),
    ]
    assert made.mass == 1.0
    assert all(link.self_collide for link in made.links)
    assert {owner[link.name] for link in made.links} == {"base"}
    assert [(one.parent, one.type, one.pose_in_parent) for one in made.joints] == [
        ("base", JointType.FIXED, IDENTITY)
    ] * 2
    assert {one.child for one in made.joints} == {link.name for link in made.links[1:]}


def test_their_names_are_not_those_of_other_links() -> None:
    chassis = replace(body(PLATE), collisions=(ROUGH, SMOOTH))
    taken = replace(BAR, name="base surface 1")
    robot = tree(chassis, (joint("base", taken.name, JointType.CONTINUOUS), taken))
    made, owner = one_friction_a_link(robot)
    names = [link.name for link in made.links]
    assert len(set(names)) == 3
    assert owner[taken.name] == taken.name
    assert sorted(owner[name] for name in names) == ["base", "base", taken.name]


def test_other_links_keep_their_place() -> None:
    chassis = replace(body(PLATE), collisions=(ROUGH, SMOOTH))
    robot = tree(chassis, (joint("base", "bar", JointType.CONTINUOUS), BAR))
    made, _ = one_friction_a_link(robot)
    assert [link.name for link in made.links] == ["base", "base surface 1", "bar"]
    assert made.joints[0] == robot.joints[0]


FLAT = list(product(range(5), range(5), [0]))


def test_a_few_collisions_may_all_touch_the_ground() -> None:
    robot = lattice(*FLAT[:MOST_STANDING])
    assert inner_collisions(robot.links[0]) == set()
    assert inner_apart(robot, {"base": "base"}) == (robot, {"base": "base"}, ())


def test_of_many_the_inner_ones_are_apart() -> None:
    robot = lattice(*FLAT)
    made, owner, names = inner_apart(robot, {"base": "base"})
    assert [len(link.collisions) for link in made.links] == [4, 21]
    assert names == (made.links[1].name,)
    assert owner == {"base": "base", names[0]: "base"}
    assert made.mass == robot.mass
    assert [(one.type, one.parent, one.child) for one in made.joints] == [
        (JointType.FIXED, "base", names[0])
    ]


def test_every_friction_keeps_its_own_hull() -> None:
    rough, smooth = lattice(*FLAT, mu=0.9), lattice(*FLAT, edge=0.05, mu=0.2)
    both = (*rough.links[0].collisions, *smooth.links[0].collisions)
    assert len(inner_collisions(replace(rough.links[0], collisions=both))) == 2 * 21


def test_what_the_ground_does_not_touch_stays_as_it_is() -> None:
    robot = replace(lattice(*FLAT), is_static=True)
    assert inner_apart(robot, {"base": "base"}) == (robot, {"base": "base"}, ())


def test_no_tree_becomes_too_large_by_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_shapes, "MOST_LINKS", 1)
    robot = lattice(*FLAT)
    assert inner_apart(robot, {"base": "base"}) == (robot, {"base": "base"}, ())

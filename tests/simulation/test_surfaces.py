"""Trees with one friction in every link."""

from __future__ import annotations

from dataclasses import replace

from simulation.robots import BAR, CYLINDER, PLATE, body, joint, shape, single, tree
from wsgen.model.pose import IDENTITY
from wsgen.model.robot import JointType, Link, Sphere
from wsgen.simulation.surfaces import one_friction_a_link

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

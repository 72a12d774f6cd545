"""The trees of a robot with loose parts."""

from __future__ import annotations

import math

import pytest

from wsgen.model.kinematics import split_trees
from wsgen.model.robot import Inertial, Joint, JointType, Link, Robot
from wsgen.model.transform import IDENTITY, Pose

MASS = Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))


def joint(parent: str, child: str, pose: Pose, kind: JointType = JointType.CONTINUOUS) -> Joint:
    return Joint(
        name=f"{parent}_{child}", type=kind, parent=parent, child=child, pose_in_parent=pose
    )


def links(names: str) -> tuple[Link, ...]:
    return tuple(Link(name=name, inertial=MASS) for name in names)


def test_one_tree_is_the_robot_itself() -> None:
    robot = Robot(
        name="r", root="a", links=links("ab"), joints=(joint("a", "b", Pose((1.0, 0.0, 0.0))),)
    )
    assert split_trees(robot) == [(robot, IDENTITY)]


def test_loose_parts_with_their_places() -> None:
    quarter = Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    robot = Robot(
        name="r",
        root="a",
        links=links("abcde"),
        joints=(joint("c", "d", quarter), joint("a", "b", quarter)),
        loose=(
            joint("d", "e", quarter, JointType.PLANAR),
            joint("b", "c", quarter, JointType.FLOATING),
        ),
    )
    trees = split_trees(robot)
    assert [tree.root for tree, _ in trees] == ["a", "e", "c"]
    assert [[link.name for link in tree.links] for tree, _ in trees] == [
        ["a", "b"],
        ["e"],
        ["c", "d"],
    ]
    assert [[one.name for one in tree.joints] for tree, _ in trees] == [["a_b"], [], ["c_d"]]
    assert all(tree.loose == () for tree, _ in trees)
    assert sum(tree.mass for tree, _ in trees) == robot.mass
    # Four steps of one meter, each a quarter turn to the left of the one before.
    assert trees[0][1] == IDENTITY
    assert trees[2][1].xyz == pytest.approx((1.0, 1.0, 0.0))
    assert abs(trees[2][1].rpy[2]) == pytest.approx(math.pi)
    assert trees[1][1].xyz == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_only_the_tree_of_the_world_is_fixed_to_it() -> None:
    robot = Robot(
        name="r",
        root="world",
        links=(Link(name="world"), *links("ab")),
        joints=(joint("world", "a", IDENTITY),),
        loose=(joint("world", "b", Pose((0.0, 0.0, 1.0)), JointType.FLOATING),),
        fixed_to_world=True,
    )
    (world, _), (loose, place) = split_trees(robot)
    assert (world.fixed_to_world, loose.fixed_to_world) == (True, False)
    assert (loose.root, place.xyz) == ("b", (0.0, 0.0, 1.0))

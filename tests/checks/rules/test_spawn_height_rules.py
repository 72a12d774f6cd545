"""How high robots are spawned, from the robot and its pose alone."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules.entities import check_spawn_height, lowest_point
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Ellipsoid,
    Geometry,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
)
from wsgen.model.transform import Pose
from wsgen.model.world import SpawnHeight

HEIGHT = SpawnHeight(
    file=Path("a.launch.py"), line=7, option="-z", holder="the arguments of create", is_given=True
)
BOUNDS = ((-0.1, -0.2, -0.3), (0.1, 0.2, 0.4))


def robot(geometry: Geometry, **pose: tuple[float, float, float]) -> Robot:
    wheel = Link(
        name="wheel", collisions=(Collision(geometry=geometry, pose_in_link=Pose(**pose)),)
    )
    joint = Joint(
        name="j",
        type=JointType.REVOLUTE,
        parent="base",
        child="wheel",
        pose_in_parent=Pose(xyz=(0.0, 0.0, -1.0)),
        limit=JointLimit(lower=-1.0, upper=1.0),
    )
    return Robot(name="r", root="base", links=(Link(name="base"), wheel), joints=(joint,))


def check(one: Robot, z: float, *, is_bare: bool = True) -> list[str]:
    found = list(
        check_spawn_height(one, Pose(xyz=(0.0, 0.0, z)), HEIGHT, entity="r", is_bare=is_bare)
    )
    assert all((each.file, each.line, each.element) == (HEIGHT.file, 7, "r") for each in found)
    return [each.name for each in found]


@pytest.mark.parametrize(
    ("geometry", "rpy", "depth"),
    [
        (Sphere(radius=0.1), (0.0, 0.0, 0.0), 0.1),
        (Cylinder(radius=0.1, length=0.6), (0.0, 0.0, 0.0), 0.3),
        (Cylinder(radius=0.1, length=0.6), (math.pi / 2, 0.0, 0.0), 0.1),
        (Capsule(radius=0.1, length=0.6), (0.0, 0.0, 0.0), 0.4),
        (Box(size=(0.2, 0.4, 0.6)), (0.0, 0.0, 0.0), 0.3),
        (Box(size=(0.2, 0.4, 0.6)), (math.pi / 2, 0.0, 0.0), 0.2),
        (Mesh(uri="a", bounds=BOUNDS, scale=(2.0, 2.0, 2.0)), (0.0, 0.0, 0.0), 0.6),
        (Mesh(uri="a", bounds=BOUNDS), (math.pi, 0.0, 0.0), 0.4),
        (Mesh(uri="a", bounds=BOUNDS), (math.pi / 2, 0.0, 0.0), 0.2),
    ],
)
def test_the_lowest_point(
    geometry: Geometry, rpy: tuple[float, float, float], depth: float
) -> None:
    found = lowest_point(robot(geometry, rpy=rpy), Pose(xyz=(0.0, 0.0, 1.0)))
    assert found == pytest.approx(-depth)


@pytest.mark.parametrize(
    "geometry", [Mesh(uri="a"), Ellipsoid(radii=(0.1, 0.1, 0.1)), Mesh(uri="a", bounds=BOUNDS)]
)
def test_a_lowest_point_that_is_not_known(geometry: Geometry) -> None:
    assert lowest_point(robot(geometry, rpy=(0.3, 0.0, 0.0)), Pose()) is None


def test_robots_in_the_ground_and_above_it() -> None:
    ball = robot(Sphere(radius=0.1))
    assert check(ball, 1.0) == ["spawned-in-ground"]
    assert check(ball, 1.1) == []
    assert check(ball, 2.0) == []
    assert check(ball, 2.2) == ["spawned-high"]
    assert check(ball, 2.2, is_bare=False) == []


def test_robots_that_stay_where_they_are() -> None:
    ball = robot(Sphere(radius=0.1))
    assert check(replace(ball, fixed_to_world=True), 0.0) == []
    assert check(replace(ball, is_static=True), 0.0) == []
    assert check(replace(ball, links=(Link(name="base"), Link(name="wheel"))), 0.0) == []
    bent = replace(ball.joints[0], limit=JointLimit(lower=0.5, upper=1.0))
    assert check(replace(ball, joints=(bent,)), 0.0) == []
    assert not list(check_spawn_height(ball, Pose(), None, entity="r", is_bare=True))

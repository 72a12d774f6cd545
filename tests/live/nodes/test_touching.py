"""Contact sensors: which collisions they are for, and what touches them."""

from __future__ import annotations

import pytest

from live.nodes.sensor_texts import SOLID, block, world_of
from wsgen.live.nodes.simulator.sensors.touching import (
    GROUND,
    collision_names,
    first_collisions,
    touched,
)
from wsgen.model.robot import Box, Collision, Link, Robot
from wsgen.model.transform import Pose
from wsgen.simulation.scene import SpawnedRobot

CUBE = Collision(geometry=Box(size=(0.2, 0.2, 0.2)))
NAMED = Collision(geometry=Box(size=(0.2, 0.2, 0.2)), name="bumper")


def test_collisions_of_urdf_are_called_as_sdformat_calls_them() -> None:
    link = Link(name="base", collisions=(CUBE, CUBE, NAMED))
    assert collision_names(link, is_urdf=True) == [
        "base_collision",
        "base_collision_1",
        "base_fixed_joint_lump__bumper_collision_2",
    ]
    assert collision_names(Link(name="b", collisions=(NAMED,)), is_urdf=False) == ["bumper"]


def test_what_stands_on_the_ground_against_a_wall_touches_both() -> None:
    robot = Robot(
        name="r", root="base", links=(Link(name="base", inertial=SOLID, collisions=(CUBE,)),)
    )
    cube = SpawnedRobot(entity="cube", robot=robot, pose_in_world=Pose((0.0, 0.0, 0.1)))
    wall = block("wall", (0.2, 2.0, 2.0), Pose((0.2, 0.0, 0.0)))
    names = {**first_collisions({"wall": (wall.robot, False)}), ("wall", "link"): "brick"}
    with world_of(cube, wall) as engine:
        engine.advance(200)
        resting = touched(engine.contacts("cube"), "base", "base_collision", "cube", names)
        engine.push("cube", "base", (30.0, 0.0, 0.0))
        engine.advance(200)
        pushed = touched(engine.contacts("cube"), "base", "base_collision", "cube", names)
        assert touched(engine.contacts("cube"), "other", "x", "cube", names) == []
    (ground,) = [one for one in resting if one.other == GROUND]
    assert ground.own == "cube::base::base_collision"
    up = sum(point.force * point.normal[2] for point in ground.points)
    assert up == pytest.approx(9.8, rel=0.1)
    (brick,) = [one for one in pushed if one.other == "wall::link::brick"]
    aside = sum(point.force * point.normal[0] for point in brick.points)
    assert -33.0 < aside < -19.0  # friction on the ground takes up to 9.8 N of 30 N

"""Sensors for tests: elements as they are read from a robot, and robots in an engine."""

from __future__ import annotations

from contextlib import closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.devices import Element, copied
from wsgen.model.robot import Box, Collision, Inertial, Link, Robot
from wsgen.model.transform import IDENTITY, Pose
from wsgen.model.world import World
from wsgen.simulation.bullet import BulletEngine
from wsgen.simulation.engine import Loaded
from wsgen.simulation.scene import SpawnedRobot
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.simulation.engine import Engine

SOLID = Inertial(mass=1.0, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1))


def element(text: str) -> Element:
    """An element of XML."""
    root = parse(text)
    assert not isinstance(root, Malformed), root
    return copied(root)


def block(name: str, size: tuple[float, float, float], pose: Pose = IDENTITY) -> SpawnedRobot:
    """A static box in the world."""
    link = Link(name="link", collisions=(Collision(geometry=Box(size=size)),))
    robot = replace(Robot(name=name, root="link", links=(link,)), is_static=True)
    return SpawnedRobot(entity=name, robot=robot, pose_in_world=pose, is_static_model=True)


@contextmanager
def world_of(*robots: SpawnedRobot, ground: bool = True) -> Iterator[Engine]:
    """PyBullet with these robots in it."""
    world = World(name="w", has_ground_plane=ground)
    with closing(BulletEngine(world)) as engine:
        for robot in robots:
            answer = engine.spawn(robot)
            assert isinstance(answer, Loaded), answer
        yield engine

"""A car with steered front wheels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from simulation.robots import body, joint, tree
from wsgen.model.robot import Box, Cylinder, JointType
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from wsgen.model.robot import Joint, Link

BASE, TRACK, RADIUS = 0.5, 0.4, 0.1  # m
TURN, AXLE = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
WHEEL = Cylinder(radius=RADIUS, length=0.04)


def wheel(parent: str, name: str, at: Pose) -> tuple[Joint, Link]:
    turned = Pose(rpy=(math.pi / 2, 0.0, 0.0))
    turns = joint(parent, name, JointType.CONTINUOUS, at, axis_in_joint=AXLE)
    return turns, body(WHEEL, name=name, at=turned, mass=0.5)


def corner(front: bool, left: bool) -> Pose:
    return Pose(((BASE if front else -BASE) / 2, (TRACK if left else -TRACK) / 2, 0.0))


def knuckle(name: str, left: bool) -> tuple[Joint, Link]:
    steers = joint("base", name, JointType.CONTINUOUS, corner(True, left), axis_in_joint=TURN)
    return steers, body(None, name=name, mass=0.3, moment=0.003)


CAR = tree(
    body(Box(size=(0.6, 0.2, 0.05)), mass=8.0),
    knuckle("left_steer", left=True),
    knuckle("right_steer", left=False),
    wheel("left_steer", "front_left", Pose()),
    wheel("right_steer", "front_right", Pose()),
    wheel("base", "rear_left", corner(front=False, left=True)),
    wheel("base", "rear_right", corner(front=False, left=False)),
)

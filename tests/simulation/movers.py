"""Robots that can do something: one on two wheels, an arm of two joints."""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

from simulation.robots import GROUND, body, joint, shape, tree
from wsgen.model.behavior import Behavior, BehaviorRun, DiffDrive, Drive, Reach, WheelPair
from wsgen.model.robot import Box, Cylinder, Inertial, JointLimit, JointType, Link, Mimic, Sphere
from wsgen.model.transform import Pose
from wsgen.simulation.scene import BehaviorMeasurement, Scene, SpawnedRobot
from wsgen.simulation.simulate import run_behaviors, run_scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    from simulation.robots import NewEngine
    from wsgen.model.robot import Joint, Robot


RADIUS = 0.1  # m, of the wheels
SEPARATION = 0.4  # m
THIN = 0.01  # m; DART lets wheels touch the ground at their inner edges
ON_ITS_SIDE = Pose(rpy=(math.pi / 2, 0.0, 0.0))
AT = Pose((1.0, -2.0, RADIUS + 0.005), (0.0, 0.0, 0.7))  # behaviors are seen from the robot
PAIR = WheelPair(left="left", right="right", separation=SEPARATION, radius=RADIUS)
DRIVE = DiffDrive(simulator="gz", pairs=(PAIR,))


def two_wheeled(
    limit: JointLimit | None = None, *, casters: Sequence[float] = (-0.17,), mu: float = 0.0
) -> Robot:
    """A box of 5 kg on two wheels and casters before the axle or behind it, m."""
    base = body(Box(size=(0.4, 0.3, 0.1)), mass=5.0)
    balls = (shape(Sphere(radius=0.05), mu=mu, at=Pose((x, 0.0, -0.05))) for x in casters)
    solid = base.inertial
    assert solid is not None
    base = replace(
        base,
        collisions=(*base.collisions, *balls),
        inertial=replace(solid, pose_in_link=Pose((-0.05, 0.0, 0.0))),
    )
    return tree(base, _wheel("left", limit), _wheel("right", limit))


def _wheel(side: str, limit: JointLimit | None) -> tuple[Joint, Link]:
    y = SEPARATION / 2 if side == "left" else -SEPARATION / 2
    rim = shape(Cylinder(radius=RADIUS, length=THIN), at=ON_ITS_SIDE)
    inertia = (0.00125, 0.0, 0.0, 0.00125, 0.0, 0.0025)
    link = Link(
        name=side,
        inertial=Inertial(mass=0.5, pose_in_link=ON_ITS_SIDE, inertia=inertia),
        collisions=(rim,),
    )
    axle = joint("base", side, JointType.CONTINUOUS, Pose((0.0, y, 0.0)), axis_in_joint=(0, 1, 0))
    return replace(axle, limit=limit), link


def arm(effort: float = 20.0, velocity: float = 1.0, *, mimics: bool = False) -> Robot:
    """Two bars that lie out from the world, one behind the other, 14.7 N m about the first."""
    limit = JointLimit(lower=-1.5, upper=1.5, effort=effort, velocity=velocity)
    first = body(Box(size=(0.5, 0.05, 0.05)), name="j1", mass=2.0, at=Pose((0.25, 0.0, 0.0)))
    second = body(Box(size=(0.4, 0.05, 0.05)), name="j2", mass=1.0, at=Pose((0.2, 0.0, 0.0)))
    lower, upper = (
        joint(parent, child, JointType.REVOLUTE, at, axis_in_joint=(0, 1, 0), limit=limit)
        for parent, child, at in (
            ("world", "j1", Pose((0.0, 0.0, 1.0))),
            ("j1", "j2", Pose((0.5, 0.0, 0.0))),
        )
    )
    if mimics:
        upper = replace(upper, mimic=Mimic(joint="j1", multiplier=-2.0, offset=0.1))
    return tree(Link(name="world"), (lower, first), (upper, second), fixed_to_world=True)


def drive(seconds: float = 2.0, using: DiffDrive = DRIVE, **twist: float) -> BehaviorRun:
    behavior = Behavior(name=f"d{twist}", task=Drive(**twist), seconds=seconds)
    return BehaviorRun(entity="e", behavior=behavior, drive=using)


def reach(seconds: float = 3.0, **positions: float) -> BehaviorRun:
    behavior = Behavior(name=f"r{positions}", task=Reach(positions=positions), seconds=seconds)
    return BehaviorRun(entity="e", behavior=behavior)


def simulated(
    new_engine: NewEngine, robot: Robot, *behavior_runs: BehaviorRun, at: Pose = AT
) -> tuple[BehaviorMeasurement, ...]:
    """What is measured of these behaviors of the robot, which has stood before."""
    spawned = SpawnedRobot(entity="e", robot=robot, pose_in_world=at)
    scene = Scene(world=GROUND, robots=(spawned,), seconds=0.5, behavior_runs=behavior_runs)
    with closing(new_engine(GROUND)) as engine:
        robot_runs, refused = run_scene(engine, scene, lambda _: None)
        assert refused == {}
        (robot_run,) = run_behaviors(engine, scene, robot_runs, lambda _: None)
    return robot_run.behaviors

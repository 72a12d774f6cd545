"""Friction that has a direction, by <fdir1>: of the rollers of mecanum wheels."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from simulation.gazebo_physics import DEBIAN, GazeboPhysics, is_installed
from simulation.robots import GROUND, body, joint, single, spawned, tree
from wsgen.model.robot import Box, JointType, Robot, Sphere, Surface
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from wsgen.model.transform import Vector
    from wsgen.model.world import World

RADIUS = 0.1  # m, of the wheels
AHEAD, ASIDE = 0.2, 0.15  # m, from the middle of the robot to its wheels
BASE = Box(size=(0.4, 0.2, 0.05))
DOWN_X = replace(GROUND, gravity=(2.0, 0.0, -9.8))
TURNED = math.radians(30.0)
# Wheel -> where it is, and the direction in which its rollers do not roll, as seen from the robot.
WHEELS = {
    "front left": ((AHEAD, ASIDE, 0.0), (1.0, -1.0, 0.0)),
    "front right": ((AHEAD, -ASIDE, 0.0), (1.0, 1.0, 0.0)),
    "back left": ((-AHEAD, ASIDE, 0.0), (1.0, 1.0, 0.0)),
    "back right": ((-AHEAD, -ASIDE, 0.0), (1.0, -1.0, 0.0)),
}
# How a wheel turns, per speed ahead, to the left, and to the left on the spot.
SIGNS = {
    "front left": (1, -1, -1),
    "front right": (1, 1, 1),
    "back left": (1, 1, -1),
    "back right": (1, -1, 1),
}

mujoco = pytest.importorskip("wsgen.simulation.mujoco")


def slab(surface: Surface, at: Pose = IDENTITY) -> Robot:
    made = body(Box(size=(0.3, 0.3, 0.1)), at=at)
    (collision,) = made.collisions
    return single(replace(made, collisions=(replace(collision, surface=surface),)))


def after(robot: Robot, pose: Pose, world: World = DOWN_X, *, steps: int = 500) -> Vector:
    """How far it has gone."""
    with spawned(mujoco.MujocoEngine, robot, pose, world=world) as engine:
        engine.advance(steps)
        moved = engine.state("e").xyz
    return (moved[0] - pose.xyz[0], moved[1] - pose.xyz[1], moved[2] - pose.xyz[2])


def mecanum(*, is_fixed: bool = True) -> Robot:
    """Four wheels; without `is_fixed`, the directions of their friction turn with them."""
    joints = []
    for name, (place, direction) in WHEELS.items():
        wheel = body(Sphere(radius=RADIUS), name=name, mass=0.5)
        (collision,) = wheel.collisions
        surface = Surface(mu1=1.0, mu2=0.0, fdir1=direction, fdir1_in="base" if is_fixed else None)
        wheel = replace(wheel, collisions=(replace(collision, surface=surface),))
        axle = joint("base", name, JointType.CONTINUOUS, Pose(place), axis_in_joint=(0.0, 1.0, 0.0))
        joints.append((axle, wheel))
    return tree(body(BASE, mass=5.0), *joints)


def drive(robot: Robot, ahead: float, left: float, turn: float, seconds: float) -> Pose:
    around = turn * (AHEAD + ASIDE)
    motors = {
        name: Motor(speed=(ahead * x + left * y + around * z) / RADIUS, effort=20.0)
        for name, (x, y, z) in SIGNS.items()
    }
    start = Pose((0.0, 0.0, RADIUS))
    with spawned(mujoco.MujocoEngine, robot, start, world=GROUND) as engine:
        engine.advance(200)
        engine.drive("e", motors)
        engine.advance(round(seconds / engine.step_seconds))
        return engine.link_poses("e")["base"]


@pytest.mark.slow
def test_what_has_no_friction_across_a_direction_slides_across_it() -> None:
    """Along it, friction holds: of 2 m/s² the part across is left, 2 / √2."""
    surface = Surface(mu1=1.0, mu2=0.0, fdir1=(1.0, 1.0, 0.0))
    x, y, _ = after(slab(surface), Pose((0.0, 0.0, 0.05)), steps=1000)
    across = 0.5 * 2.0 / math.sqrt(2.0)
    assert (x, y) == pytest.approx((across / math.sqrt(2), -across / math.sqrt(2)), rel=0.02)


@pytest.mark.slow
def test_the_direction_is_that_of_the_collision() -> None:
    """Which is turned in its link, and the link in the world."""
    surface = Surface(mu1=1.0, mu2=0.0, fdir1=(1.0, 0.0, 0.0))
    at, pose = Pose(rpy=(0.0, 0.0, TURNED)), Pose((0.0, 0.0, 0.05), (0.0, 0.0, TURNED))
    x, y, _ = after(slab(surface, at), pose, steps=1000)
    across = 0.5 * 2.0 * math.sin(2 * TURNED)
    along = (across * math.sin(2 * TURNED), -across * math.cos(2 * TURNED))
    assert (x, y) == pytest.approx(along, rel=0.02, abs=0.002)


@pytest.mark.slow
@pytest.mark.parametrize("turned", [0.0, TURNED])
def test_without_a_direction_the_first_is_y_of_the_world(turned: float) -> None:
    """Gravity is along x."""
    pose = Pose((0.0, 0.0, 0.05), (0.0, 0.0, turned))
    along_x, _, _ = after(slab(Surface(mu1=1.0, mu2=0.0)), pose, steps=1000)
    held, _, _ = after(slab(Surface(mu1=0.0, mu2=1.0)), pose, steps=1000)
    assert along_x == pytest.approx(0.5 * 2.0, rel=0.02)
    assert held == pytest.approx(0.0, abs=0.002)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ahead", "left", "turn", "seconds"),
    [
        (0.3, 0.0, 0.0, 1.5),
        (0.0, 0.3, 0.0, 3.0),
        (0.2, -0.2, 0.0, 1.5),  # two wheels stand, and the others begin at once
        (0.0, 0.0, 0.5, 1.5),
    ],
)
def test_mecanum_wheels_carry_the_robot_where_they_roll(
    ahead: float, left: float, turn: float, seconds: float
) -> None:
    pose = drive(mecanum(), ahead, left, turn, seconds)
    expected = (ahead * seconds, left * seconds)
    assert pose.xyz[:2] == pytest.approx(expected, rel=0.05, abs=0.01)
    assert pose.rpy[2] == pytest.approx(turn * seconds, rel=0.05, abs=0.01)


@pytest.mark.slow
def test_mecanum_wheels_with_directions_that_turn_do_not() -> None:
    """As in Gazebo, where the link that a direction is expressed in is lumped into another one."""
    _, y, _ = drive(mecanum(is_fixed=False), 0.0, 0.3, 0.0, seconds=3.0).xyz
    assert abs(y - 0.9) > 0.2


ORACLE = """\
<sdf version="1.9" xmlns:ignition="http://ignitionrobotics.org/schema"><world name="w">
<gravity>2 0 -9.8</gravity>
<physics name="fast" type="dart"><max_step_size>0.001</max_step_size></physics>
<model name="ground"><static>true</static><link name="link"><collision name="plane"><geometry>
<plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model>
{models}
</world></sdf>
"""
SLAB = """\
<model name="m{number}"><pose>0 {place} 0.05 0 0 {yaw!r}</pose><link name="base">
<inertial><mass>1</mass><inertia><ixx>0.0083</ixx><iyy>0.0083</iyy><izz>0.015</izz></inertia>
</inertial><collision name="c"><pose>0 0 0 0 0 {turned!r}</pose><geometry><box><size>0.3 0.3 0.1
</size></box></geometry><surface><friction><ode><mu>1</mu><mu2>{mu2}</mu2><fdir1{where}>
{direction}</fdir1></ode></friction></surface></collision></link></model>
"""
IN_BASE = ' ignition:expressed_in="base"'
SLABS = [
    # The second coefficient, the direction, the frame, how the link and the collision are turned.
    (0.0, (1.0, 1.0, 0.0), "", 0.0, 0.0),
    (0.0, (1.0, 0.0, 0.0), "", TURNED, TURNED),
    (0.0, (1.0, 0.0, 0.0), IN_BASE, TURNED, TURNED),
    (0.0, (1.0, 0.0, 0.0), ' ignition:expressed_in="lumped"', TURNED, TURNED),
    (0.1, (0.0, 1.0, 0.0), "", 0.0, 0.0),
    (0.1, (0.0, 2.0, 1.0), "", 0.0, 0.0),
]


@pytest.mark.slow
@pytest.mark.oracle
def test_gazebo_takes_directions_the_same(tmp_path_factory: pytest.TempPathFactory) -> None:
    if not is_installed():
        pytest.skip(f"Gazebo's physics (Debian: {DEBIAN}) are missing")
    texts = [
        SLAB.format(
            number=number,
            place=5 * number,
            mu2=mu2,
            direction=" ".join(map(str, direction)),
            where=where,
            yaw=yaw,
            turned=turned,
        )
        for number, (mu2, direction, where, yaw, turned) in enumerate(SLABS)
    ]
    world = ORACLE.format(models="".join(texts))
    theirs = GazeboPhysics(tmp_path_factory).run(world, steps=1000)
    for number, (mu2, direction, where, yaw, turned) in enumerate(SLABS):
        link = where.partition('"')[2].strip('"') or None
        surface = Surface(mu1=1.0, mu2=mu2, fdir1=direction, fdir1_in=link)
        pose = Pose((0.0, 0.0, 0.05), (0.0, 0.0, yaw))
        ours = after(slab(surface, Pose(rpy=(0.0, 0.0, turned))), pose, steps=1000)
        x, y, _ = theirs[f"m{number}::base"].xyz
        assert ours[:2] == pytest.approx((x, y - 5 * number), rel=0.03, abs=0.004), SLABS[number]

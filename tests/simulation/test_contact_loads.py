"""PyBullet spreads a robot's weight over what it stands on as DART does, Gazebo's engine.

A rigid body on more than three points rests in many ways; which one decides whether wheels grip.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import pytest

from simulation.conftest import CLASSES
from simulation.movers import ON_ITS_SIDE, drive, simulated
from simulation.robots import GROUND, G, body, joint, run_of, shape, single, spawned, tree
from wsgen.model.behavior import DiffDrive, WheelPair
from wsgen.model.robot import Box, Cylinder, Inertial, JointType, Link, Robot, Sphere
from wsgen.model.transform import Pose
from wsgen.simulation.bullet_contacts import contact_masses, spring_of
from wsgen.simulation.run import missing_engines
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from simulation.robots import NewEngine
    from wsgen.model.robot import Joint

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        bool(missing_engines(["bullet", "dart"])), reason="PyBullet or dartpy is not installed"
    ),
]

AS_MUCH = 0.25  # of the weight: PyBullet has up to three contacts of a wheel, DART always two
SAME_HEIGHT = 1e-4  # m
SAME_TILT = math.radians(0.1)


class Rover(NamedTuple):
    """A box on wheels and casters; lengths in sizes, so that all are alike."""

    mass: float  # kg, of the box; a wheel has a twentieth of it
    size: float  # m, the half of the box's length
    width: float  # of wheels
    casters: tuple[float, ...]  # before the middle
    mu: float = 1.0  # of casters
    axles: tuple[float, ...] = (0.0,)

    @property
    def radius(self) -> float:
        return 0.2 * self.size

    @property
    def robot(self) -> Robot:
        size, radius = self.size, self.radius
        box = body(Box(size=(2 * size, size, 0.3 * size)), mass=self.mass)
        balls = (
            shape(Sphere(radius=radius), mu=self.mu, at=Pose((x * size, 0.0, -0.3 * size)))
            for x in self.casters
        )
        solid = box.inertial
        assert solid is not None
        base = replace(
            box,
            collisions=(*box.collisions, *balls),
            inertial=replace(solid, pose_in_link=Pose((-0.02 * size, 0.0, 0.0))),
        )
        wheels = [self._wheel(side, x) for x in self.axles for side in ("left", "right")]
        return tree(base, *wheels)

    def _wheel(self, side: str, x: float) -> tuple[Joint, Link]:
        mass, radius = self.mass / 20, self.radius
        rim = Cylinder(radius=radius, length=self.width * self.size)
        across, along = mass * radius**2 / 4, mass * radius**2 / 2
        link = Link(
            name=f"{side} {x}",
            inertial=Inertial(
                mass=mass, pose_in_link=ON_ITS_SIDE, inertia=(across, 0.0, 0.0, across, 0.0, along)
            ),
            collisions=(shape(rim, at=ON_ITS_SIDE),),
        )
        y = 0.55 * self.size if side == "left" else -0.55 * self.size
        at = Pose((x * self.size, y, -0.3 * self.size))
        axle = joint("base", link.name, JointType.CONTINUOUS, at, axis_in_joint=(0.0, 1.0, 0.0))
        return axle, link

    @property
    def start(self) -> Pose:
        return Pose((0.0, 0.0, 0.5 * self.size + 0.002))

    @property
    def using(self) -> DiffDrive:
        pairs = (
            WheelPair(
                left=f"left {x}",
                right=f"right {x}",
                separation=1.1 * self.size,
                radius=self.radius,
            )
            for x in self.axles
        )
        return DiffDrive(simulator="gz", pairs=tuple(pairs))


ROVERS = {
    "small": Rover(0.5, 0.06, 0.01, (-0.8,), mu=0.1),
    "small, two casters": Rover(0.7, 0.08, 0.05, (0.8, -0.8)),
    "thin wheels": Rover(5.0, 0.2, 0.005, (-0.8, 0.8)),
    "wide wheels": Rover(5.0, 0.2, 0.2, (-0.8, 0.8), mu=0.2),
    "of a man's size": Rover(35.0, 0.7, 0.0015, (0.8, -0.8)),
    "of a man's size, wide wheels": Rover(35.0, 0.7, 0.09, (0.8, -0.8)),
    "heavy": Rover(500.0, 1.0, 0.01, (-0.8, 0.8)),
    "four wheels": Rover(35.0, 0.5, 0.1, (), axles=(0.4, -0.4)),
    "heavy, four wheels": Rover(500.0, 1.0, 0.01, (), axles=(0.4, -0.4)),
}
LIKE_OTHERS = ("small", "thin wheels", "of a man's size", "heavy, four wheels")


def engine(name: str) -> NewEngine:
    made: NewEngine = getattr(importlib.import_module(f"wsgen.simulation.{name}"), CLASSES[name])
    return made


def on_wheels(name: str, rover: Rover) -> float:
    """Which share of its weight is on the wheels of a rover that stands."""
    weight = G * sum(link.inertial.mass for link in rover.robot.links if link.inertial)
    with spawned(engine(name), rover.robot, rover.start, world=GROUND) as world:
        world.advance(1000)
        forces = []
        for _ in range(20):
            world.advance(1)
            forces += [one.force for one in world.contacts("e") if one.link != "base"]
    return sum(forces) / 20 / weight


@pytest.mark.parametrize("name", ROVERS)
def test_wheels_carry_what_they_carry_in_dart(name: str) -> None:
    rover = ROVERS[name]
    assert on_wheels("bullet", rover) == pytest.approx(on_wheels("dart", rover), abs=AS_MUCH)


@pytest.mark.parametrize("name", ROVERS)
def test_rovers_stand_as_high_and_as_level_as_in_dart(name: str) -> None:
    rover = ROVERS[name]
    ours, theirs = (
        run_of(engine(one), rover.robot, rover.start.xyz[2], seconds=1.0)
        for one in ("bullet", "dart")
    )
    assert ours.rest_pose.xyz[2] == pytest.approx(theirs.rest_pose.xyz[2], abs=SAME_HEIGHT)
    assert abs(ours.tilt - theirs.tilt) < SAME_TILT


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough if name in LIKE_OTHERS else [])
        for name in ROVERS
    ],
)
def test_rovers_go_where_they_go_in_dart(name: str) -> None:
    """Casters with the friction of tires brake them, but not for ever."""
    rover = ROVERS[name]
    tasks = (drive(4.0, rover.using, linear=0.5), drive(4.0, rover.using, angular=1.0))
    (ahead, turned), (_, as_far) = (
        simulated(engine(one), rover.robot, *tasks, at=rover.start) for one in ("bullet", "dart")
    )
    x, y, yaw = ahead.moved
    assert x == pytest.approx(2.0, rel=0.05)
    assert abs(y) < 0.05
    assert abs(yaw) < 0.05
    assert turned.moved[2] == pytest.approx(as_far.moved[2], rel=0.1)


@pytest.mark.parametrize("heading", [0.0, math.pi / 4])
@pytest.mark.parametrize("direction", [0.0, math.pi / 4])
def test_friction_acts_along_each_of_two_directions_as_in_dart(
    heading: float, direction: float
) -> None:
    """What would slide by Coulomb's law stands, if the slope is down between the two."""
    steep = math.radians(35)
    along, down = G * math.sin(steep), -G * math.cos(steep)
    gravity = (along * math.cos(direction), along * math.sin(direction), down)
    box = single(body(Box(size=(0.4, 0.4, 0.1)), mu=0.6))
    at = Pose((0.0, 0.0, 0.05), (0.0, 0.0, heading))
    speeds = []
    for one in ("bullet", "dart"):
        with spawned(engine(one), box, at, world=replace(GROUND, gravity=gravity)) as world:
            world.advance(500)
            speeds.append(world.state("e").speed)
    assert speeds[0] == pytest.approx(speeds[1], rel=0.02, abs=0.01)
    assert (speeds[0] < 0.01) is (direction > 0.0)


def test_what_is_thrown_into_a_rover_or_under_it_is_not_soft() -> None:
    """A light thing without joints has no springs, and bears what is heavy."""
    brick = single(body(Box(size=(0.1, 0.1, 0.1)), mass=0.01))
    rover = Rover(35.0, 0.5, 0.1, (), axles=(0.4, -0.4))
    under = SpawnedRobot(entity="o", robot=brick, pose_in_world=Pose((0.0, 0.0, 0.05)))
    # It lies with its belly on the brick, wheels in the air.
    with spawned(
        engine("bullet"), rover.robot, Pose((0.0, 0.0, 0.4)), under, world=GROUND
    ) as world:
        world.advance(1000)
        assert world.state("o").xyz[2] == pytest.approx(0.05, abs=0.001)


def test_contacts_are_not_set_anew_where_an_obstacle_is_moved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []

    def noted(mass: float, share: float, step_seconds: float) -> tuple[float, float]:
        asked.append(share)
        return spring_of(mass, share, step_seconds)

    monkeypatch.setattr("wsgen.simulation.bullet_body.spring_of", noted)
    rover, obstacle = ROVERS["four wheels"], single(body(Box(size=(0.1, 0.1, 0.1))))
    other = SpawnedRobot(entity="o", robot=obstacle, pose_in_world=Pose((0.0, 9.0, 0.05)))
    with spawned(engine("bullet"), rover.robot, rover.start, other, world=GROUND) as world:
        world.advance(1000)
        assert asked
        before = len(asked)
        for number in range(10):
            world.place("o", Pose((0.0, 9.0 + number / 100, 0.05)))
            world.advance(1)
        assert len(asked) == before
        again = Pose((0.0, 0.0, 0.5 * rover.size - 0.02))  # 2 cm in the ground
        world.place("e", again)
        world.advance(1)
        assert len(asked) > before


def test_what_resists_a_push_from_below() -> None:
    """Less at a longer lever, more with more mass, and more at wheels: DART touches them twice."""
    rover = Rover(10.0, 0.5, 0.01, (0.8,))
    masses = contact_masses(rover.robot)
    assert masses["left 0.0"] == pytest.approx(masses["right 0.0"])
    longer = contact_masses(Rover(10.0, 0.5, 0.01, (1.2,)).robot)
    assert longer["base"] < masses["base"] < masses["left 0.0"]
    heavier = contact_masses(Rover(100.0, 0.5, 0.01, (0.8,)).robot)
    assert heavier["base"] == pytest.approx(10 * masses["base"])
    assert contact_masses(single(body(Box(size=(1.0, 1.0, 1.0))))) == {}


def test_large_steps_do_not_let_it_sink() -> None:
    """At rest the springs bear the weight of what resists, however long the steps are."""
    for step in (0.0005, 0.001, 0.004, 0.01):
        stiffness, damping = spring_of(3.0, 0.08, step)
        assert 3.0 * G / stiffness <= 1.001e-4
        assert step * stiffness / (step * stiffness + damping) == pytest.approx(0.08)
